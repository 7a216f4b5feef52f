#include <dlfcn.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

// frame/io/zlib_calls.cpp against zlib itself, whose streams are reached by inflate() and deflate().

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Smooth enough to be compressed.
Bytes ramp(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * i / 5000);
  return bytes;
}

Bytes noise(std::size_t size) {
  std::mt19937 random(7);
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

/// Compressed into as many bytes as zlib promises to suffice.
Bytes compressed(const Bytes& bytes, int level) {
  Bytes made(compressBound(bytes.size()));
  uLongf size = made.size();
  EXPECT_EQ(compress2(made.data(), &size, bytes.data(), bytes.size(), level), Z_OK);
  made.resize(size);
  return made;
}

int expand(const Bytes& bytes, Bytes& to) {
  uLongf size = to.size();
  const int status = uncompress(to.data(), &size, bytes.data(), bytes.size());
  if (status == Z_OK) to.resize(size);
  return status;
}

Bytes inflated_by_zlib(Bytes bytes, std::size_t size) {
  Bytes made(size);
  z_stream stream{};
  EXPECT_EQ(inflateInit(&stream), Z_OK);
  stream.next_in = bytes.data();
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = made.data();
  stream.avail_out = static_cast<uInt>(size);
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  made.resize(stream.total_out);
  inflateEnd(&stream);
  return made;
}

Bytes deflated_by_zlib(Bytes bytes, int level) {
  Bytes made(compressBound(bytes.size()));
  z_stream stream{};
  EXPECT_EQ(deflateInit(&stream, level), Z_OK);
  stream.next_in = bytes.data();
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = made.data();
  stream.avail_out = static_cast<uInt>(made.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  made.resize(stream.total_out);
  deflateEnd(&stream);
  return made;
}

TEST(ZlibCalls, AreThoseThatOpenExrFinds) {
  const auto file_of = [](const void* symbol) {
    Dl_info info{};
    EXPECT_NE(dladdr(symbol, &info), 0);
    return info.dli_fbase;
  };
  // A symbol that this executable defines; what a shared library asks for is looked up in the same order.
  static const int here = 0;
  for (const char* name : {"compress", "compress2", "uncompress"}) {
    EXPECT_EQ(file_of(dlsym(RTLD_DEFAULT, name)), file_of(&here)) << name;
  }
}

TEST(ZlibCalls, ZlibExpandsWhatTheyCompress) {
  for (const int level : {-1, 0, 1, 4, 9, 40}) {
    for (const std::size_t size : {0, 1, 17, 200'000}) {
      const Bytes bytes = ramp(size);
      EXPECT_EQ(inflated_by_zlib(compressed(bytes, level), size + 1), bytes) << level << " " << size;
    }
  }
  EXPECT_LT(compressed(ramp(200'000), 4).size(), 100'000u);
}

TEST(ZlibCalls, WhatCannotBeCompressedFitsIntoZlibsBound) {
  for (const std::size_t size : {1, 100, 65'536, 1'000'003}) {
    const Bytes bytes = noise(size);
    Bytes back(size);
    EXPECT_EQ(expand(compressed(bytes, 4), back), Z_OK) << size;
    EXPECT_EQ(back, bytes) << size;
  }
}

TEST(ZlibCalls, TooLittleRoomIsAnError) {
  const Bytes bytes = noise(5000);
  Bytes small(4000);
  uLongf size = small.size();
  EXPECT_EQ(compress2(small.data(), &size, bytes.data(), bytes.size(), 4), Z_BUF_ERROR);
  EXPECT_EQ(expand(compressed(bytes, 4), small), Z_BUF_ERROR);
}

TEST(ZlibCalls, DamageIsAnError) {
  Bytes bytes = compressed(ramp(20'000), 4);
  Bytes room(20'000);
  Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2));
  EXPECT_EQ(expand(cut, room), Z_DATA_ERROR);
  std::ranges::fill(bytes, std::uint8_t{255});
  EXPECT_EQ(expand(bytes, room), Z_DATA_ERROR);
  EXPECT_EQ(expand({}, room), Z_DATA_ERROR);
}

TEST(ZlibCalls, AtOpenExrsLevelChunksAreAsLargeAsZlibs) {
  Bytes bytes(200'000);
  std::mt19937 random(7);
  std::normal_distribution<double> difference(128.0, 6.0);  // of neighbours, as OpenEXR's predictor leaves it
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(difference(random));
  EXPECT_LT(static_cast<double>(compressed(bytes, 4).size()), 1.02 * deflated_by_zlib(bytes, 4).size());
}

TEST(ZlibCalls, LevelsMayAlternate) {
  const Bytes bytes = ramp(50'000);
  const Bytes first = compressed(bytes, 1);
  const Bytes best = compressed(bytes, 9);
  EXPECT_LE(best.size(), first.size());
  EXPECT_EQ(compressed(bytes, 1), first);
}

}  // namespace
