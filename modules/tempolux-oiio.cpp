// tempolux-oiio -- reads JPEG and TIFF through OpenImageIO; opened by lib/image/any_io.cpp at
// need.
//
// A shared object of its own because linking Debian's OpenImageIO costs 0.4 s and 130 MB at every start.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>

#include "lib/image/module.h"

namespace {

using tempolux::ImageModuleRequest;

std::int32_t fail(ImageModuleRequest& request, std::int32_t result, const std::string& text) {
  const std::size_t size = std::min(text.size(), sizeof request.message - 1);
  std::memcpy(request.message, text.data(), size);
  request.message[size] = 0;
  return result;
}

std::int32_t read(ImageModuleRequest& request) {
  using namespace tempolux;
  const auto bad = [&](const std::string& text) { return fail(request, image_module_bad_input, text); };
  const std::string format = request.format;
  if (format != "jpeg" && format != "tiff")
    return bad("format " + format + " is not one this module opens");

  // Limits before any file is touched. No plugin folders, no threads of its own.
  const std::uint64_t megabytes = request.max_pixels * request.max_channels * sizeof(float) / (1 << 20) + 1;
  OIIO::attribute("limits:imagesize_MB", int(std::min<std::uint64_t>(megabytes, 1 << 20)));
  OIIO::attribute("limits:channels", int(request.max_channels));
  OIIO::attribute("threads", 1);
  const std::unique_ptr<OIIO::ImageInput> input =
      OIIO::ImageInput::create(format, false, nullptr, nullptr, "");
  if (!input) return bad(OIIO::geterror());
  OIIO::ImageSpec spec;
  if (!input->open(request.path, spec)) return bad(input->geterror());
  if (spec.width < 1 || spec.height < 1 || spec.depth != 1 || spec.nchannels < 1 ||
      std::uint64_t(spec.width) * std::uint64_t(spec.height) > request.max_pixels ||
      std::uint32_t(spec.nchannels) > request.max_channels)
    return bad("size out of range: " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
               ", " + std::to_string(spec.nchannels) + " channels");

  const int bits = spec.format.is_floating_point() ? 32 : int(spec.format.size()) * 8;
  if (bits > 16 && !spec.format.is_floating_point()) return bad("integer samples of more than 16 bits");
  float* pixels = request.allocate(request.user, spec.width, spec.height, spec.nchannels, bits);
  if (!pixels) return fail(request, image_module_no_memory, "not enough memory for its pixels");
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels))
    return bad(input->geterror());
  input->close();
  return image_module_ok;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) std::int32_t tempolux_image_module(
    ImageModuleRequest* request) {
  using namespace tempolux;
  if (request->abi != kImageModuleAbi)
    return fail(*request, image_module_bad_input,
                "the module tempolux-oiio.so is of another version; install both together");
  try {
    return read(*request);
  } catch (const std::bad_alloc&) {
    return fail(*request, image_module_no_memory, "not enough memory");
  } catch (const std::exception& e) {
    return fail(*request, image_module_bad_input, e.what());
  }
}
