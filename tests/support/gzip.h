// Text packed as gzip packs it, by zlib: for tests that read packed files.
#pragma once

#include <doctest/doctest.h>
#include <zlib.h>

#include <string>

namespace dmvv::tests {

inline std::string gzip(std::string text) {
  constexpr int window_with_gzip_header = 16 + MAX_WBITS;
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, window_with_gzip_header, 9, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string result(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(text.data());
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

}  // namespace dmvv::tests
