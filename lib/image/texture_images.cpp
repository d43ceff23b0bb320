#include "lib/image/texture_images.h"

#include <new>

#include "formats/error.h"
#include "lib/image/images_by_module.h"
#include "lib/image/specular_glossiness.h"

namespace tempolux {
namespace {

CodedPixels pixels_of(const std::vector<EncodedImage>& images, std::size_t image, std::uint64_t max_pixels) {
  if (!images[image].made_from) return decode_by_module(images[image], max_pixels);
  const SpecularGlossiness& from = *images[image].made_from;
  CodedPixels diffuse, specular;
  if (from.diffuse != from.kWhite) diffuse = decode_by_module(images[from.diffuse], max_pixels);
  if (from.specular != from.kWhite) specular = decode_by_module(images[from.specular], max_pixels);
  return from.make(diffuse, specular);
}

}  // namespace

TextureImages::TextureImages(std::vector<EncodedImage> images, const TextureLimits& limits)
    : images_(std::move(images)),
      limits_(limits),
      entries_(std::make_unique<Entry[]>(kTextureTransfers * images_.size())) {}

const TexturePyramid& TextureImages::decode(std::size_t image, TextureTransfer transfer) const {
  Entry& entry = entries_[kTextureTransfers * image + std::size_t(transfer)];
  const std::lock_guard lock(entry.decoding);
  if (entry.pyramid) return *entry.pyramid;
  const EncodedImage& source = images_[image];
  std::unique_ptr<TexturePyramid> pyramid;
  try {
    pyramid = std::make_unique<TexturePyramid>(pixels_of(images_, image, limits_.max_pixels), transfer);
  } catch (const std::bad_alloc&) {
    throw ResourceError(source.place + ": not enough memory to decode it; use smaller images");
  }
  if (bytes_.fetch_add(pyramid->byte_count()) + pyramid->byte_count() > limits_.max_bytes)
    throw InputError(source.place + ": textures take more than " + std::to_string(limits_.max_bytes) +
                     " bytes decoded; use smaller images, or allow more with --max-memory");
  ++decoded_;
  entry.pyramid = std::move(pyramid);
  entry.ready.store(entry.pyramid.get(), std::memory_order_release);
  return *entry.pyramid;
}

}  // namespace tempolux
