// modules/tempolux-images.cpp -- reads textures and environment maps. lib/image/images_by_module.cpp opens this module
// when a scene has images.
//
// A separate shared object, because most scenes have no image, and loading OpenEXR, libpng and libjpeg takes five
// million instructions.
#include <array>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/image/any_io.h"
#include "lib/image/encoded_image.h"
#include "lib/image/images_module.h"

namespace {

using tempolux::PixelsRequest;

void decode(const PixelsRequest& request) {
  const tempolux::EncodedImage image{request.place, {request.bytes, request.bytes + request.size}, 0, 0, {}};
  const tempolux::CodedPixels pixels = tempolux::decode_image(image, request.max_pixels);
  void* to = request.allocate(request.user, pixels.width, pixels.height, pixels.channels, pixels.bits);
  if (!to) throw std::bad_alloc();
  std::memcpy(to, pixels.bytes.data(), pixels.bytes.size());
}

std::array<const std::vector<float>*, 3> colour(const tempolux::Image& image, const char* path) {
  try {
    return image.rgb("");
  } catch (const tempolux::InputError& e) { throw tempolux::InputError(std::string(path) + ": " + e.what()); }
}

void load(const PixelsRequest& request) {
  const tempolux::Image image = tempolux::load_image(request.path, request.max_pixels);
  const auto planes = colour(image, request.path);
  auto* to = static_cast<float*>(request.allocate(request.user, image.width, image.height, 3, 32));
  if (!to) throw std::bad_alloc();
  for (std::size_t i = 0; i < image.pixel_count(); ++i)
    for (const std::vector<float>* plane : planes) *to++ = (*plane)[i];
}

}  // namespace

extern "C" __attribute__((visibility("default"))) std::int32_t tempolux_read_pixels(PixelsRequest* request) {
  using namespace tempolux;
  if (request->abi != kPixelsAbi) {
    request->say(request->user, "tempolux-images.so is of another version than the tool; install both together");
    return pixels_bad_input;
  }
  try {
    if (request->path) load(*request);
    else decode(*request);
    return pixels_ok;
  } catch (const std::bad_alloc&) { return pixels_no_resource; } catch (const ResourceError& e) {
    request->say(request->user, e.what());
    return pixels_no_resource;
  } catch (const std::exception& e) {
    request->say(request->user, e.what());
    return pixels_bad_input;
  }
}
