#include "authoring/gunzip.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace dmvv::authoring {
namespace {

/// Frees what zlib holds.
struct Inflater {
  z_stream stream{};
  Inflater() { good = inflateInit2(&stream, 16 + MAX_WBITS) == Z_OK; }  // 16: with the header and sum of gzip
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream); }
  bool good;
};

tl::unexpected<Error> damaged(std::size_t offset, std::string_view how) {
  return fail(Fault::input, fmt::format("the compressed data {} at byte {}", how, offset), {"fetch the file again"});
}

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

Result<std::string> gunzip(std::string_view bytes, std::size_t max_bytes) {
  Inflater inflater;
  if (!inflater.good) return fail(Fault::environment, "there is no memory to unpack the file");
  z_stream& stream = inflater.stream;
  std::string result;
  std::vector<char> block(1u << 18);
  std::size_t read = 0;
  while (true) {
    if (stream.avail_in == 0) {
      const std::size_t piece = std::min<std::size_t>(bytes.size() - read, std::numeric_limits<uInt>::max());
      // zlib does not write there; its interface is older than const.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + read));
      stream.avail_in = static_cast<uInt>(piece);
      read += piece;
    }
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    const int state = inflate(&stream, Z_NO_FLUSH);
    const std::size_t made = block.size() - stream.avail_out;
    const std::size_t at = read - stream.avail_in;
    if (result.size() + made > max_bytes) {
      return fail(Fault::input, fmt::format("the compressed data hold more than {} bytes", max_bytes),
                  {"if it is to be so large, unpack it first: gunzip"});
    }
    result.append(block.data(), made);
    if (state == Z_STREAM_END) {
      if (at == bytes.size()) return result;
      if (inflateReset(&stream) != Z_OK) return damaged(at, "cannot be read");
    } else if (state == Z_BUF_ERROR || (state == Z_OK && made == 0 && at == bytes.size())) {
      return damaged(at, "ends too soon");
    } else if (state != Z_OK) {
      return damaged(at, "is damaged");
    }
  }
}

}  // namespace dmvv::authoring
