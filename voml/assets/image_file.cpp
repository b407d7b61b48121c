// PNG by libpng; all else by the module, which is loaded when it is first needed.
#include "voml/assets/image_file.h"

#include <dlfcn.h>

#include "voml/assets/image_codec.h"
#include "voml/assets/png_file.h"

namespace dmvv {
namespace {

/// The module stands where the program's run path says (set by the build, and by the installed package).
Result<const ImageCodec*> load() {
  void* const module = dlopen(image_codec_file, RTLD_LAZY | RTLD_LOCAL);
  const auto entry = module ? reinterpret_cast<const ImageCodec* (*)()>(dlsym(module, image_codec_entry)) : nullptr;
  if (entry) return entry();
  const char* const why = dlerror();
  return fail(Fault::environment,
              std::string("pictures cannot be read or written: the module '") + image_codec_file + "' is not there",
              {why ? why : "its entry is missing", "it is installed in dmvv's folder beside the libraries"});
}

/// Stays loaded to the end of the process.
const Result<const ImageCodec*>& codec() {
  static const Result<const ImageCodec*> loaded = load();
  return loaded;
}

}  // namespace

Result<ImageInfo> inspect_image(std::string_view bytes, const std::string& name) {
  if (is_png(bytes)) return inspect_png(bytes);
  return codec().and_then([&](const ImageCodec* c) { return c->inspect(bytes, name); });
}

Result<Image8> decode_image(std::string_view bytes, const std::string& name, std::uint64_t max_samples) {
  if (is_png(bytes)) return decode_png(bytes, max_samples);
  return codec().and_then([&](const ImageCodec* c) { return c->decode(bytes, name, max_samples); });
}

Result<void> write_image(const std::string& path, const ImageToWrite& image) {
  if (path.ends_with(".png") || path.ends_with(".PNG")) return write_png(path, image);
  return codec().and_then([&](const ImageCodec* c) { return c->write(path, image); });
}

}  // namespace dmvv
