// lib/image/texture_images.h -- the images of a scene's textures; each is decoded at its first use.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "lib/image/encoded_image.h"
#include "lib/image/texture_pyramid.h"

namespace tempolux {

/// Limits of images; larger images are errors.
struct TextureLimits {
  int max_side = 16384;                   ///< px on a side
  std::uint64_t max_pixels = 1ull << 28;  ///< of one image
  std::uint64_t max_bytes = 4ull << 30;   ///< of all decoded pyramids together
};

/// The images of a scene. Images that are not used are never decoded. Thread-safe.
class TextureImages {
 public:
  explicit TextureImages(std::vector<EncodedImage> images, const TextureLimits& limits = {});

  std::size_t size() const { return images_.size(); }
  const EncodedImage& encoded(std::size_t image) const { return images_[image]; }
  /// The image as a texture; the first call decodes the image. Throws InputError that names the image if it is damaged
  /// or the limit of bytes is exceeded; ResourceError without memory.
  const TexturePyramid& pyramid(std::size_t image, TextureTransfer transfer) const {
    const Entry& entry = entries_[kTextureTransfers * image + std::size_t(transfer)];
    const TexturePyramid* ready = entry.ready.load(std::memory_order_acquire);
    return ready ? *ready : decode(image, transfer);
  }
  /// Number of decoded images, and their bytes. An image that is read with two transfers counts twice.
  std::size_t decoded_count() const { return decoded_; }
  std::uint64_t decoded_bytes() const { return bytes_; }

 private:
  struct Entry {
    std::atomic<const TexturePyramid*> ready{nullptr};
    std::mutex decoding;
    std::unique_ptr<TexturePyramid> pyramid;
  };
  const TexturePyramid& decode(std::size_t image, TextureTransfer transfer) const;

  std::vector<EncodedImage> images_;
  TextureLimits limits_;
  std::unique_ptr<Entry[]> entries_;  ///< kTextureTransfers entries for each image
  mutable std::atomic<std::size_t> decoded_{0};
  mutable std::atomic<std::uint64_t> bytes_{0};
};

}  // namespace tempolux
