// lib/image/texture_pyramid.h -- an image as a texture with levels of halved size.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/core/vec.h"
#include "lib/image/encoded_image.h"
#include "lib/image/reduce_texels.h"
#include "lib/image/texture_wrap.h"

namespace tempolux {

/// Meaning of an image's codes. srgb_cutout: sRGB colours of a material whose alpha hides parts (alpha modes MASK and
/// BLEND). Hidden texels do not count in the means of coarser levels, else the colour between leaves would tint the
/// leaves.
enum class TextureTransfer : std::uint8_t { linear, srgb, srgb_cutout };
inline constexpr std::size_t kTextureTransfers = 3;

/// Linear R, G, B and alpha, each in [0, 1].
using Rgba = std::array<float, 4>;

/// Level 0 is the image. Every further level is half as wide and high (rounded down, at least 1) and is made by
/// reduce_texels(). Texels are stored as codes of the image's kind: sRGB or linear, 8 or 16 bits; alpha is linear.
/// Texture coordinates are (0, 0) at the top left corner and (1, 1) at the bottom right corner.
class TexturePyramid {
 public:
  TexturePyramid(CodedPixels pixels, TextureTransfer transfer);

  int level_count() const { return int(levels_.size()); }
  int width(int level = 0) const { return levels_[std::size_t(level)].width; }
  int height(int level = 0) const { return levels_[std::size_t(level)].height; }
  std::uint64_t byte_count() const;  ///< memory of all levels

  /// One texel; x and y must lie inside.
  Rgba texel(int level, int x, int y) const;
  /// Reads bilinearly in the two levels around `level` and interpolates linearly between them; 0 or less reads the
  /// image, with `nearest` its closest texel. Coordinates that are not finite read (0, 0).
  Rgba read(Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v, bool nearest, float level) const;
  /// False only if all texels are black that a bilinear read of the image between these coordinates can reach. May be
  /// true because of a neighbouring texel. lower <= upper; coordinates are not yet wrapped.
  bool any_colour(Vec2 lower, Vec2 upper, TextureWrap wrap_u, TextureWrap wrap_v) const;

 private:
  Rgba bilinear(const TexelLevel& level, Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) const;
  Rgba texel(const TexelLevel& level, int x, int y) const;

  int channels_ = 0, bits_ = 8;
  bool cutout_ = false;  ///< means of colours are weighted by alpha
  const TexelCodes* colour_ = nullptr;
  const TexelCodes* alpha_ = nullptr;
  std::vector<TexelLevel> levels_;
};

}  // namespace tempolux
