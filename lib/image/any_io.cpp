#include "lib/image/any_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

#include "formats/error.h"
#include "lib/core/child_process.h"
#include "lib/core/module_folders.h"
#include "lib/image/byte_file.h"
#include "lib/image/exr_io.h"
#include "lib/image/hdr_io.h"
#include "lib/image/image_pipe.h"
#include "lib/image/png_io.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr std::uint64_t kLibraries = 2ull << 30;  ///< address space of OpenImageIO with its 261 libraries, and a margin

/// "exr", "hdr", "png", or OpenImageIO's name of a format that the child process may open; "" for any other format.
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

/// The output of the child process: channels of a pixel together.
struct Interleaved {
  std::vector<float> samples;
  int width = 0, height = 0, channels = 0, bits = 0;
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
      if (!std::isfinite(sample)) throw InputError(path + ": " + pixel_name(i, image.width) + ": not a finite number");
      values[i] = linear ? sample : srgb_to_linear(sample);
    }
  }
  return image;
}

std::vector<unsigned char> request_for(const std::string& path, const std::string& format, std::uint64_t max_pixels) {
  ImagePipeAsk ask;
  std::ranges::copy(format, ask.format.begin());
  ask.max_pixels = max_pixels;
  ask.max_channels = 4;
  std::vector<unsigned char> request(sizeof ask + path.size());
  std::memcpy(request.data(), &ask, sizeof ask);
  std::memcpy(request.data() + sizeof ask, path.data(), path.size());
  return request;
}

/// Parses the child's output. Every number is checked, since the child has read an untrusted file.
std::optional<Interleaved> parse(const std::vector<unsigned char>& printed, std::uint64_t max_pixels) {
  ImagePipeHead head;
  if (printed.size() < sizeof head) return {};
  std::memcpy(&head, printed.data(), sizeof head);
  if (head.magic != ImagePipeHead{}.magic || head.width < 1 || head.height < 1 || head.channels < 1 ||
      head.channels > 4)
    return {};
  const std::uint64_t pixels = std::uint64_t(head.width) * std::uint64_t(head.height);
  const std::uint64_t bytes = pixels * std::uint64_t(head.channels) * sizeof(float);
  if (pixels > max_pixels || printed.size() - sizeof head != bytes) return {};
  Interleaved image{std::vector<float>(bytes / sizeof(float)), head.width, head.height, head.channels, head.bits};
  std::memcpy(image.samples.data(), printed.data() + sizeof head, bytes);
  return image;
}

Image load_by_child(const std::string& path, const std::string& format, std::uint64_t max_pixels) {
  const std::string program = installed_file("tempolux-oiio", path + ": reading " + format,
                                             "build with -DTEMPOLUX_OIIO=ON, or convert the file to EXR or PNG");
  // Memory for the pixels as floats of up to four channels, and as much again for decoding.
  const std::uint64_t most = max_pixels * 4 * sizeof(float);
  ChildLimits limits;
  limits.memory_bytes = memory_that_fits(kLibraries + 2 * most);
  limits.output_bytes = memory_that_fits(most) + sizeof(ImagePipeHead);
  const ChildResult result = run_child(program, {}, request_for(path, format, max_pixels), limits);
  if (!result.trouble.empty()) throw InputError(path + ": " + format + ": " + one_line(result.trouble));
  const std::optional<Interleaved> pixels = parse(result.output, max_pixels);
  if (!pixels) throw InputError(path + ": " + format + ": tempolux-oiio gave no whole image; is it of this version?");
  return to_image(path, format, *pixels);
}

}  // namespace

Image load_image(const std::string& path, std::uint64_t max_pixels) {
  const std::string format = format_of(ByteFile(path));
  if (format == "exr") return load_exr(path, {max_pixels, false});
  if (format == "hdr") return load_hdr(path, max_pixels);
  if (format == "png") return load_png(path, max_pixels);
  if (format.empty())
    throw InputError(
        path + ": byte 0: not an image we read (OpenEXR, PNG, Radiance HDR, JPEG, TIFF); convert it to EXR or PNG");
  return load_by_child(path, format, max_pixels);
}

}  // namespace tempolux
