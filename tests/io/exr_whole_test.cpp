#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "frame/io/exr_channels.h"
#include "tests/error_of.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

class ExrWhole : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  const std::string path_ = folder_.path("image.exr");
};

TEST_F(ExrWhole, ADamagedChunkIsFoundWhereverItIs) {
  constexpr int lines = 600;  // several stripes
  const std::vector<TestChannel> colour = {{"R"}, {"G"}, {"B"}};
  Imf::Header reversed = scanline_part(window(3, -7, 16, lines), colour);
  reversed.lineOrder() = Imf::DECREASING_Y;
  for (const Imf::Header& header : {scanline_part(window(3, -7, 16, lines), colour), reversed,
                                    tiled_part(window(3, -7, 16, lines), colour, 8, 40)}) {
    write_test_file(path_, {header});
    require_whole_exr(path_);
    const std::string whole = read_bytes(path_);
    for (std::size_t eighth = 1; eighth < 8; ++eighth) {
      std::string bytes = whole;
      bytes.replace(whole.size() * eighth / 8, 8, 8, '\x55');
      write_bytes(path_, bytes);
      const std::string error = error_of(ExitStatus::bad_input, [&] { require_whole_exr(path_); });
      EXPECT_TRUE(error.starts_with(path_ + ": truncated, corrupt or unsupported EXR: "))
          << eighth << ": " << error;
    }
  }
}

/// Memory of this process that the system would still give, beyond what it has.
class LittleMemory {
 public:
  explicit LittleMemory(rlim_t bytes) {
    ::getrlimit(RLIMIT_AS, &before_);
    rlimit limit = before_;
    limit.rlim_cur = address_space() + bytes;
    ::setrlimit(RLIMIT_AS, &limit);
  }
  LittleMemory(const LittleMemory&) = delete;
  LittleMemory& operator=(const LittleMemory&) = delete;
  ~LittleMemory() { ::setrlimit(RLIMIT_AS, &before_); }

 private:
  static rlim_t address_space() {
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  }
  rlimit before_{};
};

TEST_F(ExrWhole, CheckingAFileTakesLittleMemory) {
  write_test_file(path_, {scanline_part(window(0, 0, 4096, 4096), {{"Y"}}, Imf::NO_COMPRESSION)});
  require_whole_exr(path_);
  const LittleMemory memory(16 << 20);  // all of its pixels as floats take 64 MiB
  EXPECT_EQ(error_of(ExitStatus::resource, [&] { require_whole_exr(path_); }), "no error");
}

}  // namespace
}  // namespace becalm::io
