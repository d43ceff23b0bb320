// modules/decode_avif.cpp -- decodes AVIF images with libavif.
#include <avif/avif.h>

#include <algorithm>
#include <memory>

#include "modules/decode.h"

namespace tempolux {

std::string decode_avif(std::span<const std::uint32_t> settings, std::span<const unsigned char> packed,
                        std::span<unsigned char> unpacked) {
  constexpr std::uint32_t most = 65536;  // largest width and height of an AV1 frame: 16 bits
  ImageRequest request;
  if (std::string wrong = request.read("AVIF", most, 4, settings, unpacked.size()); !wrong.empty()) return wrong;
  const auto [width, height, channels] = request;
  const std::unique_ptr<avifDecoder, decltype(&avifDecoderDestroy)> decoder(avifDecoderCreate(), avifDecoderDestroy);
  if (!decoder) return "needs more memory than it may take for data of this size";
  decoder->maxThreads = 1;  // the guard lets no thread start
  decoder->ignoreExif = decoder->ignoreXMP = AVIF_TRUE;
  // Cells of a grid may reach beyond the picture, but not far.
  const std::uint64_t pixels = std::max<std::uint64_t>(4 * width * height, 1u << 16);
  decoder->imageSizeLimit = std::uint32_t(std::min<std::uint64_t>(pixels, AVIF_DEFAULT_IMAGE_SIZE_LIMIT));
  decoder->imageDimensionLimit = most;
  // Files of older encoders lack this description of bit depths, which the pixels' own data repeat.
  decoder->strictFlags = AVIF_STRICT_ENABLED & ~avifStrictFlags(AVIF_STRICT_PIXI_REQUIRED);
  if (avifDecoderSetIOMemory(decoder.get(), packed.data(), packed.size()) != AVIF_RESULT_OK)
    return "cannot read it from memory";
  const auto trouble = [](const char* what, avifResult result) {
    return std::string(what) + " (" + avifResultToString(result) + "): it is damaged or cut short";
  };
  if (const avifResult result = avifDecoderParse(decoder.get()); result != AVIF_RESULT_OK)
    return trouble("finds no AVIF image in it", result);
  if (decoder->imageCount != 1) return "finds an animated AVIF: a texture must be one picture";
  const avifImage& image = *decoder->image;
  if (image.width != width || image.height != height)
    return "finds an image of another size than its header says: it is damaged";
  const bool is_turned = (image.transformFlags & AVIF_TRANSFORM_IROT) != 0 && image.irot.angle != 0;
  if (is_turned || (image.transformFlags & (AVIF_TRANSFORM_CLAP | AVIF_TRANSFORM_IMIR)) != 0)
    return "finds an image that is turned, mirrored or cropped when it is shown";
  if (const avifResult result = avifDecoderNextImage(decoder.get()); result != AVIF_RESULT_OK)
    return trouble("cannot decode it", result);
  if (image.width != width || image.height != height)
    return "finds an image of another size than its header says: it is damaged";
  avifRGBImage rgb;
  avifRGBImageSetDefaults(&rgb, &image);  // R, G, B and alpha, which is not multiplied into the colour
  rgb.depth = 8;
  rgb.pixels = unpacked.data();
  rgb.rowBytes = std::uint32_t(width * channels);
  if (const avifResult result = avifImageYUVToRGB(&image, &rgb); result != AVIF_RESULT_OK)
    return trouble("cannot convert it to red, green and blue", result);
  return "";
}

}  // namespace tempolux
