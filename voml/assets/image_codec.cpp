// The module dmvv_image_codec: the only user of OpenImageIO.
#include "voml/assets/image_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>

namespace dmvv {
namespace {

struct Signature {
  std::string_view bytes;
  const char* format;  ///< OpenImageIO's name of it
};
constexpr Signature signatures[] = {{"\xff\xd8\xff", "jpeg"},
                                    {{"II*\0", 4}, "tiff"},
                                    {{"MM\0*", 4}, "tiff"},
                                    {"\x76\x2f\x31\x01", "openexr"},
                                    {"BM", "bmp"}};

/// What the content says, as endings lie; else the file's name decides.
std::string format_of(std::string_view bytes, const std::string& name) {
  for (const Signature& signature : signatures) {
    if (bytes.starts_with(signature.bytes)) return signature.format;
  }
  return name;
}

tl::unexpected<Error> unreadable(std::string_view why) {
  return fail(Fault::input, std::string(OIIO::Strutil::strip(OIIO::string_view(why.data(), why.size()))));
}

/// `memory` reads from `bytes`, which must outlive the result.
Result<std::unique_ptr<OIIO::ImageInput>> open(OIIO::Filesystem::IOProxy& memory, std::string_view bytes,
                                               const std::string& name) {
  const std::string format = format_of(bytes, name);
  OIIO::ImageSpec wishes;
  wishes["oiio:UnassociatedAlpha"] = 1;  // colours are shown as given, not multiplied by their alpha
  auto input = OIIO::ImageInput::create(format);
  OIIO::ImageSpec spec;
  if (input && input->set_ioproxy(&memory) && input->open(name, spec, wishes)) return input;
  return unreadable(input ? input->geterror() : OIIO::geterror());
}

OIIO::Filesystem::IOMemReader reader(std::string_view bytes) { return {const_cast<char*>(bytes.data()), bytes.size()}; }

/// Runs `read` and turns what is thrown (memory, a decoder's fault) into an error.
template <class T, class Read>
Result<T> guarded(const Read& read) {
  try {
    return read();
  } catch (const std::exception& error) {
    return unreadable(error.what());
  }
}

Result<ImageInfo> inspect(std::string_view bytes, const std::string& name) {
  return guarded<ImageInfo>([&]() -> Result<ImageInfo> {
    auto memory = reader(bytes);
    const auto input = open(memory, bytes, name);
    if (!input) return tl::unexpected(input.error());
    const OIIO::ImageSpec& spec = (*input)->spec();
    if (spec.width < 1 || spec.height < 1 || spec.depth < 1 || spec.nchannels < 1) return unreadable("it has no pixel");
    return ImageInfo{static_cast<std::uint64_t>(spec.width),
                     static_cast<std::uint64_t>(spec.height),
                     static_cast<std::uint64_t>(spec.depth),
                     spec.channelnames,
                     spec.format.c_str(),
                     (*input)->format_name()};
  });
}

Result<Image8> decode(std::string_view bytes, const std::string& name, std::uint64_t max_samples) {
  return guarded<Image8>([&]() -> Result<Image8> {
    auto memory = reader(bytes);
    const auto input = open(memory, bytes, name);
    if (!input) return tl::unexpected(input.error());
    const OIIO::ImageSpec& spec = (*input)->spec();
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1) {
      return unreadable("it is not one picture of width times height");
    }
    Image8 image{static_cast<std::uint64_t>(spec.width),
                 static_cast<std::uint64_t>(spec.height),
                 static_cast<std::uint32_t>(std::min(spec.nchannels, 4)),
                 {}};
    const std::uint64_t pixels = image.width * image.height;
    if (pixels > max_samples / image.channels) {
      return unreadable(fmt::format("it has {} x {} pixels, more than is allowed", image.width, image.height));
    }
    image.samples.resize(pixels * image.channels);
    if (!(*input)->read_image(0, 0, 0, static_cast<int>(image.channels), OIIO::TypeUInt8, image.samples.data())) {
      return unreadable((*input)->geterror());
    }
    return image;
  });
}

OIIO::TypeDesc type_of(SampleType type) {
  constexpr OIIO::TypeDesc::BASETYPE types[] = {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16, OIIO::TypeDesc::UINT32,
                                                OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT};
  return types[static_cast<std::size_t>(type)];
}

Result<void> write(const std::string& path, const ImageToWrite& image) {
  const auto failed = [&](const std::string& why) {
    return fail(Fault::environment, fmt::format("cannot write '{}'", path), {why});
  };
  try {
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height),
                         static_cast<int>(image.channels.size()), type_of(image.stored));
    spec.channelnames = image.channels;
    spec.attribute("DateTime", "1970:01:01 00:00:00");  // the TIFF and EXR writers fill in the present else
    if (image.straight_alpha) spec.attribute("oiio:UnassociatedAlpha", 1);
    if (!image.compression.empty()) spec.attribute("compression", image.compression);
    const auto output = OIIO::ImageOutput::create(path);
    if (!output) return failed(OIIO::geterror());
    if (!output->open(path, spec) || !output->write_image(type_of(image.given), image.samples)) {
      const std::string why = output->geterror();
      output->close();
      return failed(why);
    }
    if (!output->close()) return failed(output->geterror());
    return {};
  } catch (const std::exception& error) {
    return failed(error.what());
  }
}

}  // namespace
}  // namespace dmvv

extern "C" const dmvv::ImageCodec* dmvv_image_codec() {
  static constexpr dmvv::ImageCodec codec{dmvv::inspect, dmvv::decode, dmvv::write};
  return &codec;
}
