// The three calls of zlib by which OpenEXR 3.1 compresses and expands chunks (ZIP, ZIPS, PXR24 and DWA),
// defined by libdeflate, as OpenEXR 3.2 and later use it: chunks are compressed in 0.4 of zlib's time and
// expanded in three quarters. Shared libraries look symbols up in the executable first, so that these
// definitions go before zlib's (ELF symbol interposition; frame/io/CMakeLists.txt makes the linker take this
// file).
#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <memory>

namespace {

constexpr int kUsualLevel = 6;  // of zlib
constexpr int kLevelOfOpenExr = 4;
/// Of libdeflate, instead: files are as large as by zlib's 4 (within 0.5 %), in 0.4 of its time.
constexpr int kFasterLevel = 1;

int used_level(int level) {
  if (level == kLevelOfOpenExr) return kFasterLevel;
  return level < 0 ? kUsualLevel : std::min(level, Z_BEST_COMPRESSION);
}

struct FreeCompressor {
  void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
};
struct FreeDecompressor {
  void operator()(libdeflate_decompressor* decompressor) const { libdeflate_free_decompressor(decompressor); }
};

/// The calling thread's compressor of this level; null without memory.
libdeflate_compressor* compressor_of(int level) {
  thread_local std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor;
  thread_local int level_of_compressor = -1;
  if (!compressor || level != level_of_compressor) {
    compressor.reset(libdeflate_alloc_compressor(level));
    level_of_compressor = level;
  }
  return compressor.get();
}

/// zlib's own deflate. Data that cannot be compressed fits into compressBound bytes by zlib, but not always
/// by libdeflate, whose stored blocks are shorter.
int deflate_by_zlib(Bytef* to, uLongf* to_size, const Bytef* from, uLong from_size, int level) {
  z_stream stream{};
  if (const int status = deflateInit(&stream, level); status != Z_OK) return status;
  stream.next_in = const_cast<Bytef*>(from);
  stream.avail_in = static_cast<uInt>(from_size);
  stream.next_out = to;
  stream.avail_out = static_cast<uInt>(*to_size);
  const int status = deflate(&stream, Z_FINISH);
  *to_size = stream.total_out;
  deflateEnd(&stream);
  return status == Z_STREAM_END ? Z_OK : Z_BUF_ERROR;
}

}  // namespace

extern "C" {

int compress2(Bytef* to, uLongf* to_size, const Bytef* from, uLong from_size, int level) {
  libdeflate_compressor* compressor = compressor_of(used_level(level));
  if (compressor == nullptr) return Z_MEM_ERROR;
  const std::size_t size = libdeflate_zlib_compress(compressor, from, from_size, to, *to_size);
  if (size == 0) return deflate_by_zlib(to, to_size, from, from_size, used_level(level));
  *to_size = size;
  return Z_OK;
}

int compress(Bytef* to, uLongf* to_size, const Bytef* from, uLong from_size) {
  return compress2(to, to_size, from, from_size, kUsualLevel);
}

int uncompress(Bytef* to, uLongf* to_size, const Bytef* from, uLong from_size) {
  thread_local const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(
      libdeflate_alloc_decompressor());
  if (!decompressor) return Z_MEM_ERROR;
  std::size_t size = 0;
  switch (libdeflate_zlib_decompress(decompressor.get(), from, from_size, to, *to_size, &size)) {
    case LIBDEFLATE_SUCCESS:
      *to_size = size;
      return Z_OK;
    case LIBDEFLATE_INSUFFICIENT_SPACE:
      return Z_BUF_ERROR;
    default:
      return Z_DATA_ERROR;
  }
}

}  // extern "C"
