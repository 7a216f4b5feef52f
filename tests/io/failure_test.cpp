#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstring>
#include <random>

#include "frame/error.h"
#include "frame/io/additive_layers.h"
#include "frame/io/atomic_file.h"
#include "frame/io/exr.h"
#include "tests/error_of.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

const std::vector<TestChannel> kColour = {{"R"}, {"G"}, {"B"}};

class BadFile : public ::testing::Test {
 protected:
  std::string read_error() {
    return error_of(ExitStatus::bad_input, [&] { read_exr(path_, 1, AovSet().set()); });
  }
  void expect_truncated_everywhere() {
    const std::string whole = read_bytes(path_);
    std::vector<std::size_t> sizes = {0, 1, 3, 4, 7, 8, 20, 60, 150, whole.size() - 1, whole.size() - 2};
    for (std::size_t eighth = 1; eighth < 8; ++eighth) sizes.push_back(whole.size() * eighth / 8);
    for (const std::size_t size : sizes) {
      write_bytes(path_, whole.substr(0, size));
      EXPECT_TRUE(read_error().starts_with(path_ + ": "))
          << size << " of " << whole.size() << ": " << read_error();
      EXPECT_NE(problem(), "") << size << " of " << whole.size();
    }
    write_bytes(path_, whole);
    EXPECT_EQ(read_error(), "no error");
    EXPECT_EQ(problem(), "");
  }
  /// What describe_exr finds wrong.
  std::string problem() {
    std::string told;
    const std::string error = error_of(ExitStatus::bad_input, [&] { told = describe_exr(path_).problem; });
    return error == "no error" ? told : error;
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.path("image.exr");
};

TEST_F(BadFile, Missing) {
  EXPECT_EQ(read_error(), path_ + ": no such file");
  EXPECT_EQ(error_of(ExitStatus::bad_input, [&] { describe_exr(path_); }), path_ + ": no such file");
  EXPECT_EQ(error_of(ExitStatus::bad_input, [] { describe_exr("in.*.exr"); }),
            "in.*.exr: no such file; the frame number is written as ####");
  EXPECT_EQ(error_of(ExitStatus::bad_input, [&] { read_attribute(path_, "x"); }), path_ + ": no such file");
}

TEST_F(BadFile, AFolder) {
  std::filesystem::create_directory(path_);
  EXPECT_EQ(read_error(), path_ + ": not a file, expected an EXR file");
}

TEST_F(BadFile, AFifoDoesNotHang) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  EXPECT_EQ(read_error(), path_ + ": not a file, expected an EXR file");
  EXPECT_EQ(error_of(ExitStatus::bad_input, [&] { find_additive_sets(path_, {}); }),
            path_ + ": not a file, expected an EXR file");
}

TEST_F(BadFile, NotAnExr) {
  for (const char* text : {"", "v", "P6 1 1 255 abc", "\x89PNG\r\n"}) {
    write_bytes(path_, text);
    EXPECT_EQ(read_error(), path_ + ": not an EXR file");
  }
}

TEST_F(BadFile, NoColour) {
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), {{"Z", Imf::FLOAT}})});
  EXPECT_NE(read_error().find(path_ + ": no colour"), std::string::npos);
}

TEST_F(BadFile, SubsampledLayersThatAreTaken) {
  const AovSet albedo = AovSet().set(static_cast<std::size_t>(Aov::albedo));
  const std::vector<TestChannel> sparse{
      {"albedo.R", Imf::HALF, 2}, {"albedo.G", Imf::HALF, 2}, {"albedo.B", Imf::HALF, 2}};
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), joined({kColour, sparse}))});
  EXPECT_EQ(describe_exr(path_, {}, albedo).problem,
            path_ +
                ": albedo of albedo.R,albedo.G,albedo.B has fewer samples than pixels, expected one in "
                "each; --layers albedo=none leaves it out");
  EXPECT_THROW(read_exr(path_, 1, albedo), Error);
  EXPECT_NO_THROW(read_exr(path_, 1, {})) << "where it is passed on";
  EXPECT_EQ(describe_exr(path_, {.layers = {{Aov::albedo, "none"}}}, albedo).problem, "");
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), {{"R", Imf::HALF, 2}, {"G"}, {"B"}})});
  EXPECT_TRUE(read_error().starts_with(path_ + ": beauty of R,G,B has fewer samples")) << read_error();
}

TEST_F(BadFile, TruncatedScanlines) {
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    write_test_file(path_, {scanline_part(window(0, 0, 20, 50), kColour, compression)});
    expect_truncated_everywhere();
  }
}

TEST_F(BadFile, TruncatedTiles) {
  write_test_file(path_, {tiled_part(window(0, 0, 50, 40), kColour, 16, 16)});
  expect_truncated_everywhere();
  write_test_file(path_, {tiled_part(window(0, 0, 50, 40), kColour, 16, 16, Imf::MIPMAP_LEVELS)});
  expect_truncated_everywhere();
  write_test_file(path_, {tiled_part(window(0, 0, 50, 40), kColour, 16, 16, Imf::RIPMAP_LEVELS)});
  expect_truncated_everywhere();
}

TEST_F(BadFile, TruncatedInAPartThatIsOnlyPassedOn) {
  write_test_file(path_, {scanline_part(window(0, 0, 20, 50), kColour),
                          scanline_part(window(0, 0, 20, 50), {{"raw.id", Imf::UINT}}),
                          tiled_part(window(0, 0, 20, 50), {{"raw.x"}}, 16, 16)});
  expect_truncated_everywhere();
}

TEST_F(BadFile, AnInterruptedWriteHasNoOffsets) {
  // OpenEXR fills the offset table in when it closes a file; a writer that was killed leaves zeros there.
  write_test_file(path_, {scanline_part(window(0, 0, 20, 48), kColour)});
  std::string bytes = read_bytes(path_);
  // The table follows the header: name, type, size and value of each attribute, and an empty name.
  std::size_t table = 8;
  while (bytes.at(table) != '\0') {
    for (int i = 0; i < 2; ++i) table = bytes.find('\0', table) + 1;
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + table, sizeof(size));
    table += sizeof(size) + size;
  }
  ++table;
  bytes.replace(table + 16, 8, 8, '\0');
  write_bytes(path_, bytes);
  EXPECT_TRUE(read_error().starts_with(path_ + ": truncated, corrupt or unsupported EXR: ")) << read_error();
  EXPECT_NE(read_error().find("not written to its end"), std::string::npos) << read_error();
}

TEST_F(BadFile, SizesThatLieTakeNoMemory) {
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), kColour)});
  const std::string whole = read_bytes(path_);
  const std::string huge("\0\0\0\x70", 4);
  const std::string small("\x8\0\0\0", 4);
  const std::string of_string("string\0", 7);
  const std::vector<std::string> lies = {
      of_string + huge,
      std::string("stringvector\0", 13) + small + huge + "abcd",
      std::string("preview\0", 8) + small + std::string("\0\x70\0\0\0\x70\0\0", 8),
      // Read as one byte, whatever its size says: what is behind it is the next attribute.
      std::string("compression\0", 12) + small + std::string("\0x\0", 3) + of_string + huge,
      // The list ends behind where it says, or before.
      std::string("chlist\0", 7) + small + std::string("A\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0x\0", 21) +
          of_string + huge,
      std::string("chlist\0", 7) + small + std::string("\0x\0", 3) + of_string + huge,
  };
  for (const std::string& lie : lies) {
    SCOPED_TRACE(lie);
    write_bytes(path_, whole.substr(0, 8) + std::string("owner\0", 6) + lie + whole.substr(8));
    rusage before{};
    rusage after{};
    getrusage(RUSAGE_SELF, &before);
    EXPECT_TRUE(read_error().starts_with(path_ + ": truncated, corrupt or unsupported EXR: "))
        << read_error();
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss, before.ru_maxrss + (64 << 10));  // in KiB
  }
}

TEST_F(BadFile, WhatTheSystemLacksSaysNothingOfTheFile) {
  write_test_file(path_, {scanline_part(window(0, 0, 8, 8), kColour)});
  ASSERT_TRUE(has_all_chunks(path_));
  rlimit usual{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &usual), 0);
  const rlimit none{.rlim_cur = 0, .rlim_max = usual.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string of_chunks = error_of(ExitStatus::resource, [&] { has_all_chunks(path_); });
  const std::string of_pixels = error_of(ExitStatus::resource, [&] { read_exr(path_, 1, {}); });
  const std::vector<std::string> paths{path_};
  const std::string of_layers = error_of(ExitStatus::resource, [&] { find_additive_sets(paths, {}); });
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &usual), 0);
  EXPECT_EQ(of_chunks, path_ + ": cannot be read: Too many open files");
  EXPECT_EQ(of_pixels, of_chunks);
  EXPECT_EQ(of_layers, of_chunks);
}

TEST_F(BadFile, CorruptPixels) {
  write_test_file(path_, {scanline_part(window(0, 0, 64, 64), kColour)});
  std::string bytes = read_bytes(path_);
  bytes.replace(bytes.size() - 900, 400, 400, '\x55');
  write_bytes(path_, bytes);
  EXPECT_TRUE(read_error().starts_with(path_ + ": truncated, corrupt or unsupported EXR: ")) << read_error();
}

/// Overwrites the data window in the file's header.
void claim_window(const std::string& path, int min_x, int min_y, int max_x, int max_y) {
  std::string bytes = read_bytes(path);
  const std::string key = std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
  const std::size_t at = bytes.find(key);
  ASSERT_NE(at, std::string::npos);
  const int values[] = {min_x, min_y, max_x, max_y};
  std::memcpy(&bytes[at + key.size()], values, sizeof values);
  write_bytes(path, bytes);
}

TEST_F(BadFile, AbsurdWindows) {
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), kColour)});
  const std::string whole = read_bytes(path_);
  const auto error_of_window = [&](int min_x, int min_y, int max_x, int max_y) {
    write_bytes(path_, whole);
    claim_window(path_, min_x, min_y, max_x, max_y);
    return read_error();
  };
  EXPECT_NE(error_of_window(0, 0, 65536, 3).find("65536"), std::string::npos);
  EXPECT_NE(error_of_window(0, 0, 3, 1 << 29).find("65536"), std::string::npos);
  // Within the limit, but the file is too short to hold it: no memory may be taken for its 16 Gpixels.
  EXPECT_TRUE(error_of_window(0, 0, 65535, 65535).starts_with(path_ + ": "));
  EXPECT_TRUE(error_of_window(5, 5, 4, 4).starts_with(path_ + ": "));
  EXPECT_TRUE(
      error_of_window(-2147483647 - 1, -2147483647 - 1, 2147483647, 2147483647).starts_with(path_ + ": "));
}

TEST_F(BadFile, AnyDamagedByteIsAnErrorOrAnImage) {
  write_test_file(path_, {scanline_part(window(0, 0, 9, 20), {{"R"}, {"G"}, {"B"}, {"raw.id", Imf::UINT}}),
                          tiled_part(window(0, 0, 9, 9), {{"albedo.R"}, {"albedo.G"}, {"albedo.B"}}, 4, 4)});
  const std::string whole = read_bytes(path_);
  std::mt19937 random(7);
  int errors = 0;
  for (int i = 0; i < 400; ++i) {
    std::string bytes = whole;
    for (int damage = 0; damage < 2; ++damage) bytes[random() % bytes.size()] = static_cast<char>(random());
    write_bytes(path_, bytes);
    try {
      read_exr(path_, 1, AovSet().set());
      describe_exr(path_);
    } catch (const Error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(path_)) << error.what();
      ++errors;
    }
  }
  EXPECT_GT(errors, 100);
}

class FailedWrite : public ::testing::Test {
 protected:
  FailedWrite() : frame_(1, 64, 64) {
    Image& beauty = frame_.add(Aov::beauty);
    for (int i = 0; i < 64 * 64 * 4; ++i) beauty.data()[i] = test_value("noise", i, 0);
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.path("image.exr");
  Frame frame_;
};

/// No file of this process may grow beyond some size while it lives, as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }

 private:
  rlimit before_{};
};

TEST_F(FailedWrite, AFullDiskLeavesTheOldFile) {
  write_bytes(path_, "old");
  for (const rlim_t size : {0, 100, 400, 5000, 12000}) {
    std::string error;
    {
      const FullDisk disk(size);
      error = error_of(ExitStatus::resource, [&] { write_exr(path_, frame_, {}); });
    }
    EXPECT_EQ(error, path_ + ": cannot write it: File too large") << size;
    EXPECT_EQ(read_bytes(path_), "old");
    EXPECT_EQ(folder_.file_count(), 1u);
  }
}

TEST_F(FailedWrite, AFullDiskWhilePassingOn) {
  const std::string source = folder_.path("source.exr");
  write_test_file(source, {scanline_part(window(0, 0, 64, 64), {{"R"}, {"G"}, {"B"}, {"raw.id", Imf::UINT}}),
                           scanline_part(window(0, 0, 64, 64), {{"raw.other", Imf::UINT}})});
  const LoadedFrame loaded = read_exr(source, 1, {});
  for (const rlim_t size : {500, 20000, 35000}) {
    std::string error;
    {
      const FullDisk disk(size);
      error =
          error_of(ExitStatus::resource, [&] { write_denoised_exr(path_, loaded.frame, {}, loaded, {}); });
    }
    EXPECT_EQ(error, path_ + ": cannot write it: File too large") << size;
    EXPECT_EQ(folder_.file_count(), 1u) << "the source alone";
  }
}

TEST_F(FailedWrite, AFileWhereAFolderShouldBe) {
  write_bytes(folder_.path("file"), "x");
  const std::string path = folder_.path("file/image.exr");
  EXPECT_EQ(error_of(ExitStatus::resource, [&] { write_exr(path, frame_, {}); }),
            path + ": cannot make its folder: Not a directory");
}

TEST_F(FailedWrite, AFolderWhereTheFileShouldBe) {
  std::filesystem::create_directory(path_);
  EXPECT_EQ(error_of(ExitStatus::resource, [&] { write_exr(path_, frame_, {}); }),
            path_ + ": cannot write it: Is a directory");
  EXPECT_EQ(folder_.file_count(), 0u);
}

TEST_F(FailedWrite, AFailureWhileReadingTheSourceNamesTheSource) {
  const std::string source = folder_.path("source.exr");
  write_test_file(source,
                  {scanline_part(window(0, 0, 64, 64), {{"R"}, {"G"}, {"B"}, {"raw.id", Imf::UINT}})});
  const LoadedFrame loaded = read_exr(source, 1, {});
  const auto time = std::filesystem::last_write_time(source);
  std::string bytes = read_bytes(source);
  std::fill(bytes.end() - 9000, bytes.end(), '\x55');
  write_bytes(source, bytes);
  std::filesystem::last_write_time(source, time);
  const std::string error =
      error_of(ExitStatus::bad_input, [&] { write_denoised_exr(path_, loaded.frame, {}, loaded, {}); });
  EXPECT_TRUE(error.starts_with(source + ": ")) << error;
  EXPECT_EQ(folder_.file_count(), 1u);
}

TEST(AtomicFile, AppearsWhenCommitted) {
  const TemporaryFolder folder;
  const std::string path = folder.path("a/b/file");
  {
    AtomicFile file(path);
    file.write("0123456789", 10);
    file.seek(2);
    file.write("xy", 2);
    EXPECT_EQ(file.position(), 4u);
    EXPECT_FALSE(std::filesystem::exists(path));
    file.commit();
    EXPECT_EQ(read_bytes(path), "01xy456789");
  }
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, KeepsTheModeOfTheFileThatItReplaces) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  using std::filesystem::perms;
  std::ofstream(path) << 'x';
  for (const perms mode :
       {perms::owner_read | perms::owner_write | perms::group_read, perms::owner_read | perms::owner_write}) {
    std::filesystem::permissions(path, mode);
    AtomicFile file(path);
    file.write("y", 1);
    file.commit();
    EXPECT_EQ(std::filesystem::status(path).permissions(), mode);
  }
}

TEST(AtomicFile, IsRemovedUnlessCommitted) {
  const TemporaryFolder folder;
  { AtomicFile(folder.path("file")).write("x", 1); }
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(AtomicFile, AFailureThatWasSwallowedIsRemembered) {
  const TemporaryFolder folder;
  AtomicFile file(folder.path("file"));
  const std::string bytes(100000, 'x');
  {
    const FullDisk disk(10);
    EXPECT_THROW(file.write(bytes.data(), bytes.size()), Error);
  }
  EXPECT_THROW(file.seek(0), Error);
  EXPECT_THROW(file.commit(), Error);
  EXPECT_FALSE(std::filesystem::exists(folder.path("file")));
}

TEST(AtomicFile, TwoWritersOfOneFileDoNotMeet) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  AtomicFile first(path);
  AtomicFile second(path);
  first.write("first", 5);
  second.write("second", 6);
  second.commit();
  EXPECT_EQ(read_bytes(path), "second");
  first.commit();
  EXPECT_EQ(read_bytes(path), "first");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, AKilledWriterLeavesTheOldFile) {
  const TemporaryFolder folder;
  const std::string path = folder.path("shot.0001.exr");
  write_bytes(path, "old");
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    AtomicFile file(path);
    file.write("new", 3);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(read_bytes(path), "old");
}

}  // namespace
}  // namespace becalm::io
