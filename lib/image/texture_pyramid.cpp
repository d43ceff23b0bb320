#include "lib/image/texture_pyramid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lib/core/check.h"

namespace tempolux {
namespace {

/// The two texels around a coordinate, and the weight of the second.
struct Pair {
  int a, b;
  float share;
};

/// Wraps a coordinate to [0, 1].
float wrapped(float u, TextureWrap wrap) {
  if (!std::isfinite(u)) return 0;
  if (wrap == TextureWrap::repeat) return u - std::floor(u);
  if (wrap == TextureWrap::clamp) return std::clamp(u, 0.0f, 1.0f);
  const float t = u - 2 * std::floor(u * 0.5f);
  return t > 1 ? 2 - t : t;
}

Pair pair_at(float u, int size, TextureWrap wrap) {
  const float x = wrapped(u, wrap) * float(size) - 0.5f;
  const int a = int(std::floor(x));
  Pair pair{a, a + 1, x - float(a)};
  if (wrap == TextureWrap::repeat) {
    if (pair.a < 0) pair.a = size - 1;
    if (pair.b >= size) pair.b = 0;
  }
  pair.a = std::clamp(pair.a, 0, size - 1);
  pair.b = std::clamp(pair.b, 0, size - 1);
  return pair;
}

Rgba mix(const Rgba& a, const Rgba& b, float share) {
  Rgba result;
  for (std::size_t c = 0; c < 4; ++c) result[c] = a[c] + (b[c] - a[c]) * share;
  return result;
}

}  // namespace

TexturePyramid::TexturePyramid(CodedPixels pixels, TextureTransfer transfer)
    : channels_(pixels.channels),
      bits_(pixels.bits),
      cutout_(transfer == TextureTransfer::srgb_cutout && pixels.channels % 2 == 0),
      colour_(&TexelCodes::of(pixels.bits, transfer != TextureTransfer::linear)),
      alpha_(&TexelCodes::of(pixels.bits, false)) {
  TEMPOLUX_CHECK(pixels.width > 0 && pixels.height > 0);
  levels_.push_back({pixels.width, pixels.height, std::move(pixels.bytes)});
  std::vector<float> exact;
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const TexelLevel& last = levels_.back();
    levels_.push_back(reduce_texels(last, std::max(1, last.width / 2), std::max(1, last.height / 2),
                                    {channels_, bits_, cutout_, colour_, alpha_}, exact));
  }
}

std::uint64_t TexturePyramid::byte_count() const {
  std::uint64_t bytes = 0;
  for (const TexelLevel& level : levels_) bytes += level.codes.size();
  return bytes;
}

Rgba TexturePyramid::texel(const TexelLevel& level, int x, int y) const {
  const auto channels = std::size_t(channels_);
  const std::size_t at = (std::size_t(y) * std::size_t(level.width) + std::size_t(x)) * channels;
  Rgba value;
  for (std::size_t c = 0; c < 3; ++c) value[c] = colour_->value[code_of(level, bits_, at + (channels < 3 ? 0 : c))];
  value[3] = channels % 2 == 0 ? alpha_->value[code_of(level, bits_, at + channels - 1)] : 1.0f;
  return value;
}

Rgba TexturePyramid::texel(int level, int x, int y) const { return texel(levels_[std::size_t(level)], x, y); }

Rgba TexturePyramid::bilinear(const TexelLevel& level, Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) const {
  const Pair x = pair_at(uv.x, level.width, wrap_u), y = pair_at(uv.y, level.height, wrap_v);
  return mix(mix(texel(level, x.a, y.a), texel(level, x.b, y.a), x.share),
             mix(texel(level, x.a, y.b), texel(level, x.b, y.b), x.share), y.share);
}

Rgba TexturePyramid::read(Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v, bool nearest, float level) const {
  if (!(level > 0)) {
    const TexelLevel& image = levels_[0];
    if (!nearest) return bilinear(image, uv, wrap_u, wrap_v);
    const auto at = [](float u, int size) { return std::clamp(int(u * float(size)), 0, size - 1); };
    return texel(image, at(wrapped(uv.x, wrap_u), image.width), at(wrapped(uv.y, wrap_v), image.height));
  }
  const float deepest = float(levels_.size() - 1);
  if (level >= deepest) return bilinear(levels_.back(), uv, wrap_u, wrap_v);
  const auto finer = std::size_t(level);
  return mix(bilinear(levels_[finer], uv, wrap_u, wrap_v), bilinear(levels_[finer + 1], uv, wrap_u, wrap_v),
             level - float(finer));
}

bool TexturePyramid::any_colour(Vec2 lower, Vec2 upper, TextureWrap wrap_u, TextureWrap wrap_v) const {
  constexpr int kWindow = 8;  // texels on a side that are tested
  const Vec2 size{upper.x - lower.x, upper.y - lower.y};
  if (!std::isfinite(lower.x + lower.y + upper.x + upper.y)) return true;
  // Tests the finest level at which the window is small, and one more texel on each side, which a read may mix in.
  std::size_t l = 0;
  while (l + 1 < levels_.size() &&
         (size.x * float(levels_[l].width) > float(kWindow) || size.y * float(levels_[l].height) > float(kWindow)))
    ++l;
  const TexelLevel& level = levels_[l];
  const auto steps = [&](float extent, int texels) { return int(std::min(extent * float(texels), float(texels))) + 4; };
  const int nx = steps(size.x, level.width), ny = steps(size.y, level.height);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec2 at{lower.x + (float(i) - 1) / float(level.width), lower.y + (float(j) - 1) / float(level.height)};
      const Pair x = pair_at(at.x, level.width, wrap_u), y = pair_at(at.y, level.height, wrap_v);
      for (const int tx : {x.a, x.b})
        for (const int ty : {y.a, y.b}) {
          const Rgba value = texel(level, tx, ty);
          if (value[0] > 0 || value[1] > 0 || value[2] > 0) return true;
        }
    }
  return false;
}

}  // namespace tempolux
