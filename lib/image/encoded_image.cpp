#include "lib/image/encoded_image.h"

#include <array>
#include <string_view>

#include "formats/error.h"
#include "lib/image/avif_header.h"

namespace tempolux {
namespace {

using Bytes = std::span<const unsigned char>;
using namespace std::string_view_literals;

bool starts_with(Bytes bytes, std::string_view head, std::size_t at = 0) {
  return bytes.size() >= at + head.size() &&
         std::string_view(reinterpret_cast<const char*>(bytes.data()) + at, head.size()) == head;
}

std::uint32_t big_endian(Bytes bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + std::size_t(i)];
  return value;
}

/// Size in the first chunk, IHDR (PNG specification 11.2.2).
bool png_size(Bytes bytes, ImageHeader& header) {
  if (bytes.size() < 33 || !starts_with(bytes, "IHDR", 12)) return false;
  header.width = int(big_endian(bytes, 16, 4) & 0x7fffffffu);
  header.height = int(big_endian(bytes, 20, 4) & 0x7fffffffu);
  return true;
}

/// Size in the first start-of-frame segment (ITU-T T.81, B.2.2): markers FFC0 .. FFCF except DHT, JPG and DAC.
bool jpeg_size(Bytes bytes, ImageHeader& header) {
  for (std::size_t at = 2; at + 4 <= bytes.size();) {
    if (bytes[at] != 0xff) return false;
    const unsigned marker = bytes[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8)) {  // markers without a length
      at += 2;
      continue;
    }
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
      if (at + 9 > bytes.size()) return false;
      header.height = int(big_endian(bytes, at + 5, 2));
      header.width = int(big_endian(bytes, at + 7, 2));
      header.four_inks = at + 9 < bytes.size() && bytes[at + 9] == 4;
      return true;
    }
    if (marker == 0xd9 || marker == 0xda) return false;  // end of the image, or pixels before any frame
    at += 2 + big_endian(bytes, at + 2, 2);
  }
  return false;
}

std::uint32_t little_endian(Bytes bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = count - 1; i >= 0; --i) value = value << 8 | bytes[at + std::size_t(i)];
  return value;
}

/// Size in the first chunk of the RIFF container, which is a lossy frame (RFC 6386, 9.1), a lossless frame or the
/// description of a canvas (Google's "WebP Container Specification" and "WebP Lossless Bitstream").
bool webp_size(Bytes bytes, ImageHeader& header) {
  if (bytes.size() < 30) return false;
  if (starts_with(bytes, "VP8 "sv, 12)) {
    if (!starts_with(bytes, "\x9d\x01\x2a"sv, 23)) return false;
    header.width = int(little_endian(bytes, 26, 2) & 0x3fffu);
    header.height = int(little_endian(bytes, 28, 2) & 0x3fffu);
    return true;
  }
  if (starts_with(bytes, "VP8L"sv, 12)) {
    if (bytes[20] != 0x2f) return false;
    const std::uint32_t bits = little_endian(bytes, 21, 4);
    header.width = int(bits & 0x3fffu) + 1;
    header.height = int(bits >> 14 & 0x3fffu) + 1;
    header.has_alpha = (bits >> 28 & 1u) != 0;
    return true;
  }
  if (!starts_with(bytes, "VP8X"sv, 12)) return false;
  header.width = int(little_endian(bytes, 24, 3)) + 1;
  header.height = int(little_endian(bytes, 27, 3)) + 1;
  header.has_alpha = (bytes[20] & 0x10u) != 0;
  return true;
}

constexpr std::array kNames{"PNG", "JPEG", "WebP", "AVIF"};  // of ImageHeader::Format

struct OtherFormat {
  std::string_view head;
  const char* name;
};
constexpr std::array kOtherFormats{OtherFormat{"\xabKTX"sv, "KTX"},
                                   OtherFormat{"DDS ", "DDS"},
                                   OtherFormat{"GIF8", "GIF"},
                                   OtherFormat{"BM", "BMP"},
                                   OtherFormat{"II*\0"sv, "TIFF"},
                                   OtherFormat{"MM\0*"sv, "TIFF"},
                                   OtherFormat{"\x76\x2f\x31\x01"sv, "OpenEXR"},
                                   OtherFormat{"#?R", "Radiance HDR"}};

}  // namespace

ImageHeader read_image_header(Bytes bytes, const std::string& place) {
  const auto fail = [&](const std::string& what) { throw InputError(place + ": " + what); };
  ImageHeader header;
  bool found = false;
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n"sv)) {
    header.format = ImageHeader::Format::png;
    found = png_size(bytes, header);
  } else if (starts_with(bytes, "\xff\xd8\xff"sv)) {
    header.format = ImageHeader::Format::jpeg;
    found = jpeg_size(bytes, header);
  } else if (starts_with(bytes, "RIFF"sv) && starts_with(bytes, "WEBP"sv, 8)) {
    header.format = ImageHeader::Format::webp;
    found = webp_size(bytes, header);
  } else if (has_brand_of_avif(bytes)) {
    header.format = ImageHeader::Format::avif;
    if (const std::optional<AvifHeader> avif = read_avif_header(bytes)) {
      if (avif->is_transformed)
        fail("the AVIF is turned, mirrored or cropped when it is shown; save it as it is shown");
      header.width = avif->width;
      header.height = avif->height;
      found = true;
    }
  } else {
    for (const OtherFormat& other : kOtherFormats)
      if (starts_with(bytes, other.head))
        fail(std::string("is ") + other.name + "; textures must be PNG, JPEG, WebP or AVIF: convert it");
    if (is_media_file(bytes))
      fail("is HEIC, MP4 or a damaged AVIF; textures must be PNG, JPEG, WebP or AVIF: convert it");
    fail("is neither PNG nor JPEG nor WebP nor AVIF; textures must be one of them");
  }
  const std::string name = kNames[std::size_t(header.format)];
  if (!found) fail("no size in its header; the " + name + " is damaged or cut short");
  if (header.width < 1 || header.height < 1) fail("the " + name + " has no pixels");
  return header;
}

}  // namespace tempolux
