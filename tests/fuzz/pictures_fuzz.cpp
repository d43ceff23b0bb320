// tests/fuzz/pictures_fuzz.cpp -- pictures by their first bytes: PNG, JPEG, WebP, AVIF (as textures are decoded),
// Radiance, and EXR, whose header is walked before OpenEXR sees the file, then its pixels.
#include <algorithm>

#include "lib/image/avif_header.h"
#include "lib/image/encoded_image.h"
#include "lib/image/exr_io.h"
#include "lib/image/hdr_io.h"
#include "lib/image/png_io.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t kMaxPixels = 1u << 20;
  const std::string path = fuzz::file_of(data, size, ".picture");
  const auto begins = [&](std::initializer_list<std::uint8_t> bytes) {
    return size >= bytes.size() && std::equal(bytes.begin(), bytes.end(), data);
  };
  const auto decode = [&] {
    const ImageHeader header = read_image_header({data, size}, path);
    decode_image({path, {data, data + size}, header.width, header.height, ""}, kMaxPixels);
  };
  if (begins({0x89})) {
    fuzz::expect_read_or_refused(path, [&] { load_png(path, kMaxPixels); });
    fuzz::expect_read_or_refused(path, decode);
  } else if (begins({0xff, 0xd8})) {
    fuzz::expect_read_or_refused(path, decode);
  } else if (begins({'R', 'I', 'F', 'F'}) || is_media_file({data, size})) {
    fuzz::expect_read_or_refused(path, decode);
  } else if (begins({'#', '?'})) {
    fuzz::expect_read_or_refused(path, [&] { load_hdr(path, kMaxPixels); });
  } else {
    fuzz::expect_read_or_refused(path, [&] { load_exr(path, {.max_pixels = kMaxPixels, .allow_nan = true}); });
  }
  return 0;
}
