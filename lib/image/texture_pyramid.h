// lib/image/texture_pyramid.h -- an image as a texture: levels of halved size, read anywhere on the plane.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/core/vec.h"
#include "lib/image/encoded_image.h"
#include "lib/image/reduce_texels.h"
#include "lib/image/texture_wrap.h"

namespace tempolux {

/// What the codes of an image mean. srgb_cutout: sRGB colours of which alpha shows a part (alpha modes MASK and BLEND):
/// what it hides has no share in the means of coarser levels, or leaves would turn the colour of what is between them.
enum class TextureTransfer : std::uint8_t { linear, srgb, srgb_cutout };
inline constexpr std::size_t kTextureTransfers = 3;

/// Linear R, G, B and alpha, each in [0, 1].
using Rgba = std::array<float, 4>;

/// Level 0 is the image, reduced by a box filter where it is larger than max_side; every further level is half as wide
/// and high (rounded down, at least 1), each texel the mean of the linear light over the area it covers (of a cutout,
/// weighted by alpha; the plain mean where all is hidden). Texels keep
/// the code of the image (sRGB or linear, 8 or 16 bits; rounded to nearest, but never to 0 what is above it: a texel
/// is 0 only if all it covers is 0). Alpha is linear always. (0, 0) is the top left corner, (1, 1) the lower right.
class TexturePyramid {
 public:
  TexturePyramid(CodedPixels pixels, TextureTransfer transfer, int max_side);

  int level_count() const { return int(levels_.size()); }
  int width(int level = 0) const { return levels_[std::size_t(level)].width; }
  int height(int level = 0) const { return levels_[std::size_t(level)].height; }
  std::uint64_t byte_count() const;

  /// One texel; x and y must lie inside.
  Rgba texel(int level, int x, int y) const;
  /// Bilinear in the two levels around `level` (log2 of texels of the image per texel wanted; below 0: the image
  /// itself), and linear between them. Coordinates that are not finite read (0, 0).
  Rgba read(Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v, bool nearest, float level) const;
  /// Does any texel that a bilinear read of the image between these coordinates can touch have a colour above 0? May
  /// say yes for the sake of a neighbour; never no wrongly. lower <= upper, before wrapping.
  bool any_colour(Vec2 lower, Vec2 upper, TextureWrap wrap_u, TextureWrap wrap_v) const;

 private:
  TexelLevel smaller(const TexelLevel& from, int width, int height) const;
  Rgba bilinear(const TexelLevel& level, Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) const;
  Rgba texel(const TexelLevel& level, int x, int y) const;

  int channels_ = 0, bits_ = 8;
  bool cutout_ = false;  ///< means of colours are weighted by alpha
  const TexelCodes* colour_ = nullptr;
  const TexelCodes* alpha_ = nullptr;
  std::vector<TexelLevel> levels_;
};

}  // namespace tempolux
