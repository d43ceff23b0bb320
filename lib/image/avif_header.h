// lib/image/avif_header.h -- the size of an AVIF in memory, from the boxes of its container.
#pragma once

#include <optional>
#include <span>

namespace tempolux {

/// True if the bytes begin with the box of an ISO media file (ISO/IEC 14496-12), as AVIF, HEIC and MP4 do.
bool is_media_file(std::span<const unsigned char> bytes);
/// True if that box names a brand of AVIF: avif, or avis of animations.
bool has_brand_of_avif(std::span<const unsigned char> bytes);

struct AvifHeader {
  int width = 0, height = 0;  ///< px, as coded
  /// The file asks viewers to turn, mirror or crop the image.
  bool is_transformed = false;
};

/// The properties of the primary image (ISO/IEC 23008-12: pitm, ipma, ipco), without decoding or allocating. The time
/// is linear in the number of bytes, whatever lengths they state. nullopt: the size is not there.
std::optional<AvifHeader> read_avif_header(std::span<const unsigned char> bytes);

}  // namespace tempolux
