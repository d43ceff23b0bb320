#include "lib/image/images_by_module.h"

#include <new>

#include "formats/error.h"
#include "lib/image/images_module.h"
#include "lib/image/open_module.h"

namespace tempolux {
namespace {

/// Receives the module's pixels: `resize(width, height, channels, bits)` returns where they go.
template <class Resize>
class Answer {
 public:
  explicit Answer(Resize resize) : resize_(resize) {}

  void ask(PixelsRequest request, const std::string& place) {
    auto* entry = reinterpret_cast<PixelsEntry*>(
        module_symbol("tempolux-images.so", kPixelsSymbol, place + ": reading an image",
                      "install all of tempolux together, or copy its folder of modules with the tools"));
    request.abi = kPixelsAbi;
    request.user = this;
    request.allocate = [](void* user, std::int32_t width, std::int32_t height, std::int32_t channels,
                          std::int32_t bits) -> void* {
      try {
        return static_cast<Answer*>(user)->resize_(width, height, channels, bits);
      } catch (const std::bad_alloc&) { return nullptr; }
    };
    request.say = [](void* user, const char* message) { static_cast<Answer*>(user)->message_ = message; };
    const std::int32_t result = entry(&request);
    if (result == pixels_ok) return;
    if (result != pixels_no_resource) throw InputError(message_);
    if (message_.empty()) throw std::bad_alloc();
    throw ResourceError(message_);
  }

 private:
  Resize resize_;
  std::string message_;
};

}  // namespace

CodedPixels decode_by_module(const EncodedImage& image, std::uint64_t max_pixels) {
  CodedPixels pixels;
  Answer answer([&](int width, int height, int channels, int bits) -> void* {
    pixels.width = width, pixels.height = height, pixels.channels = channels, pixels.bits = bits;
    pixels.bytes.resize(std::size_t(width) * std::size_t(height) * std::size_t(channels) * std::size_t(bits / 8));
    return pixels.bytes.data();
  });
  PixelsRequest request{};
  request.bytes = image.bytes.data();
  request.size = image.bytes.size();
  request.place = image.place.c_str();
  request.max_pixels = max_pixels;
  answer.ask(request, image.place);
  return pixels;
}

LinearPixels load_by_module(const std::string& path, std::uint64_t max_pixels) {
  LinearPixels image;
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  Answer answer([&](int width, int height, int, int) -> void* {
    image.width = width, image.height = height;
    image.pixels.resize(std::size_t(width) * std::size_t(height));
    return image.pixels.data();
  });
  PixelsRequest request{};
  request.path = path.c_str();
  request.max_pixels = max_pixels;
  answer.ask(request, path);
  return image;
}

}  // namespace tempolux
