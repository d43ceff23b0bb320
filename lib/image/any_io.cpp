#include "lib/image/any_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <string_view>

#include "formats/error.h"
#include "lib/image/byte_file.h"
#include "lib/image/exr_io.h"
#include "lib/image/hdr_io.h"
#include "lib/image/module.h"
#include "lib/image/png_io.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr const char* kModuleFile = "tempolux-oiio.so";

/// "exr", "hdr", "png", or OpenImageIO's name of a format the module may open; "" for everything else.
std::string format_of(const ByteFile& file) {
  std::array<char, 11> start{};
  file.read_at(0, start.data(), std::size_t(std::min<std::uint64_t>(start.size(), file.size())));
  const std::string_view head(start.data(), start.size());
  using namespace std::string_view_literals;
  if (head.starts_with("\x76\x2f\x31\x01"sv)) return "exr";
  if (head.starts_with("\x89PNG\r\n\x1a\n"sv)) return "png";
  if (head.starts_with("#?RADIANCE"sv) || head.starts_with("#?RGBE"sv)) return "hdr";
  if (head.starts_with("\xff\xd8\xff"sv)) return "jpeg";
  if (head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv)) return "tiff";
  return "";
}

ImageModuleEntry* find_module(const std::string& path, const std::string& format,
                              const std::vector<std::string>& folders) {
  return reinterpret_cast<ImageModuleEntry*>(
      module_symbol(kModuleFile, kImageModuleSymbol, folders, path + ": reading " + format,
                    "build with -DTEMPOLUX_OIIO=ON, or convert the file to EXR or PNG"));
}

/// What the module fills.
struct Interleaved {
  std::vector<float> samples;
  int width = 0, height = 0, channels = 0, bits = 0;

  static float* allocate(void* user, std::int32_t width, std::int32_t height, std::int32_t channels,
                         std::int32_t bits) {
    auto& self = *static_cast<Interleaved*>(user);
    self.width = width;
    self.height = height;
    self.channels = channels;
    self.bits = bits;
    try {
      self.samples.resize(std::size_t(width) * std::size_t(height) * std::size_t(channels));
    } catch (const std::bad_alloc&) {
      return nullptr;
    }
    return self.samples.data();
  }
};

Image to_image(const std::string& path, const std::string& format, const Interleaved& from) {
  if (from.channels != 1 && from.channels != 3)
    throw InputError(path + ": " + format + ": " + std::to_string(from.channels) +
                     " channels; 1 (grey) or 3 (RGB) are read: convert it to EXR or PNG");
  const bool linear = from.bits == 32;
  Image image;
  image.width = from.width;
  image.height = from.height;
  image.text["tempolux:source"] =
      format + ", " + std::to_string(from.bits) + " bits, " + (linear ? "linear" : "sRGB to linear");
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float>& values = image.add(std::string(1, "RGB"[c])).values;
    const std::size_t offset = from.channels == 1 ? 0 : c;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float sample = from.samples[i * std::size_t(from.channels) + offset];
      if (!std::isfinite(sample))
        throw InputError(path + ": pixel (" + std::to_string(i % std::size_t(image.width)) + ", " +
                         std::to_string(i / std::size_t(image.width)) + "): not a finite number");
      values[i] = linear ? sample : srgb_to_linear(sample);
    }
  }
  return image;
}

Image load_by_module(const std::string& path, const std::string& format, const ImageReadOptions& options) {
  ImageModuleEntry* entry = find_module(path, format, options.module_folders);
  Interleaved pixels;
  ImageModuleRequest request{};
  request.abi = kImageModuleAbi;
  request.path = path.c_str();
  request.format = format.c_str();
  request.max_pixels = options.max_pixels;
  request.max_channels = 4;
  request.allocate = Interleaved::allocate;
  request.user = &pixels;
  const std::int32_t result = entry(&request);
  const std::string message = path + ": " + format + ": " + one_line(request.message);
  if (result == image_module_no_memory) throw ResourceError(message);
  if (result != image_module_ok) throw InputError(message);
  return to_image(path, format, pixels);
}

}  // namespace

Image load_image(const std::string& path, const ImageReadOptions& options) {
  const std::string format = format_of(ByteFile(path));
  if (format == "exr") return load_exr(path, {options.max_pixels, false});
  if (format == "hdr") return load_hdr(path, options.max_pixels);
  if (format == "png") return load_png(path, options.max_pixels);
  if (format.empty())
    throw InputError(
        path +
        ": byte 0: not an image we read (OpenEXR, PNG, Radiance HDR, JPEG, TIFF); convert it to EXR or PNG");
  return load_by_module(path, format, options);
}

}  // namespace tempolux
