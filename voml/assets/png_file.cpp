// libpng reports errors by longjmp: between setjmp and it stands nothing that has a destructor. It would print what it
// has to say; here it is kept.
#include "voml/assets/png_file.h"

#include <png.h>

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace dmvv {
namespace {

// Measured on rendered pictures of 1280x720: level 2 takes 0.4 of level 6's time for files 20 to 45 % larger.
constexpr int compression_level = 2;

struct Complaint {
  char text[128] = "";
};

void keep_complaint(png_structp png, png_const_charp text) {
  std::snprintf(static_cast<Complaint*>(png_get_error_ptr(png))->text, sizeof Complaint::text, "%s", text);
  png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

// ---- reading ----

struct Reader {
  std::string_view rest;
  Complaint complaint;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit Reader(std::string_view bytes) : rest(bytes) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &complaint, keep_complaint, ignore_warning);
    if (png != nullptr) info = png_create_info_struct(png);
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  tl::unexpected<Error> failed() const {
    return fail(Fault::input,
                std::strcmp(complaint.text, "read past the end") == 0 ? "the PNG file ends too early" : complaint.text);
  }
};

void take_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& reader = *static_cast<Reader*>(png_get_io_ptr(png));
  if (count > reader.rest.size()) png_error(png, "read past the end");
  std::memcpy(to, reader.rest.data(), count);
  reader.rest.remove_prefix(count);
}

bool read_header(Reader& reader) {
  if (reader.info == nullptr) return false;
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_read_fn(reader.png, &reader, take_bytes);
  png_set_user_limits(reader.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // what is too large, the caller says
  png_read_info(reader.png, reader.info);
  return true;
}

/// Palettes, few bits and transparent colours become 8 bits a channel. False: the complaint says why.
bool convert_to_8_bits(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_expand(reader.png);
  png_set_scale_16(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_rows(Reader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows);
  png_read_end(reader.png, nullptr);
  return true;
}

std::vector<std::string> channel_names(std::size_t count) {
  static const std::vector<std::string> names[] = {{}, {"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
  return names[count];
}

// ---- writing ----

struct Writer {
  Complaint complaint;
  std::FILE* file;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit Writer(const std::string& path) : file(std::fopen(path.c_str(), "wb")) {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &complaint, keep_complaint, ignore_warning);
    if (png != nullptr) info = png_create_info_struct(png);
  }
  ~Writer() {
    png_destroy_write_struct(&png, &info);
    if (file != nullptr) std::fclose(file);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
};

bool write_rows(Writer& writer, const ImageToWrite& image, png_bytepp rows) {
  constexpr int colours[] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                             PNG_COLOR_TYPE_RGB_ALPHA};
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_init_io(writer.png, writer.file);
  png_set_user_limits(writer.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               image.stored == SampleType::u16 ? 16 : 8, colours[image.channels.size()], PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(writer.png, compression_level);
  // Pictures of scenes are flat areas with sharp edges: without filters they take a third of the time and less room.
  if (image.stored == SampleType::u8) png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_write_info(writer.png, writer.info);
  if (image.stored == SampleType::u16 && std::endian::native == std::endian::little) png_set_swap(writer.png);
  png_write_image(writer.png, rows);
  png_write_end(writer.png, writer.info);
  return true;
}

std::vector<png_bytep> row_pointers(void* first, std::size_t row_bytes, std::size_t rows) {
  std::vector<png_bytep> pointers(rows);
  for (std::size_t y = 0; y < rows; ++y) pointers[y] = static_cast<png_bytep>(first) + y * row_bytes;
  return pointers;
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }

Result<ImageInfo> inspect_png(std::string_view bytes) {
  Reader reader(bytes);
  if (!read_header(reader)) return reader.failed();
  return ImageInfo{.width = png_get_image_width(reader.png, reader.info),
                   .height = png_get_image_height(reader.png, reader.info),
                   .channels = channel_names(png_get_channels(reader.png, reader.info)),
                   .sample_type = png_get_bit_depth(reader.png, reader.info) == 16 ? "uint16" : "uint8",
                   .format = "png"};
}

Result<Image8> decode_png(std::string_view bytes, std::uint64_t max_samples) {
  Reader reader(bytes);
  if (!read_header(reader) || !convert_to_8_bits(reader)) return reader.failed();
  Image8 image{png_get_image_width(reader.png, reader.info),
               png_get_image_height(reader.png, reader.info),
               png_get_channels(reader.png, reader.info),
               {}};
  const std::size_t row_bytes = image.width * image.channels;
  if (image.height > max_samples / row_bytes) return fail(Fault::input, "it has more pixels than are allowed");
  // A deflate stream has at least a thousandth of the bytes it stands for: a header that lies is found out here.
  if (row_bytes * image.height / 2000 > bytes.size()) return fail(Fault::input, "the PNG file ends too early");
  image.samples.resize(row_bytes * image.height);
  auto rows = row_pointers(image.samples.data(), row_bytes, image.height);
  if (!read_rows(reader, rows.data())) return reader.failed();
  return image;
}

Result<void> write_png(const std::string& path, const ImageToWrite& image) {
  const auto failed = [&](std::string why) {
    return fail(Fault::environment, "cannot write '" + path + "'", {std::move(why)});
  };
  Writer writer(path);
  if (writer.file == nullptr) return failed(std::strerror(errno));
  if (writer.info == nullptr) return failed("not enough memory");
  const std::size_t bytes_per_sample = image.stored == SampleType::u16 ? 2 : 1;
  const std::size_t row_bytes = image.width * image.channels.size() * bytes_per_sample;
  auto rows = row_pointers(const_cast<void*>(image.samples), row_bytes, image.height);
  if (!write_rows(writer, image, rows.data())) return failed(writer.complaint.text);
  std::FILE* const file = std::exchange(writer.file, nullptr);
  if (std::fclose(file) != 0) return failed(std::strerror(errno));
  return {};
}

}  // namespace dmvv
