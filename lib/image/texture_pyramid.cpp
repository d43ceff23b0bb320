#include "lib/image/texture_pyramid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lib/core/check.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

std::vector<float> make_table(std::size_t codes, bool srgb) {
  std::vector<float> table(codes);
  for (std::size_t i = 0; i < codes; ++i) {
    const float value = float(double(i) / double(codes - 1));
    table[i] = srgb ? srgb_to_linear(value) : value;
  }
  return table;
}

const std::vector<float>& table_of(int bits, bool srgb) {
  static const std::vector<float> linear8 = make_table(256, false), srgb8 = make_table(256, true);
  if (bits == 8) return srgb ? srgb8 : linear8;
  static const std::vector<float> linear16 = make_table(65536, false), srgb16 = make_table(65536, true);
  return srgb ? srgb16 : linear16;
}

/// The code whose value is nearest, but not 0 for a value above 0.
std::uint32_t nearest_code(const std::vector<float>& table, float value) {
  if (!(value > 0)) return 0;
  const auto above = std::lower_bound(table.begin() + 1, table.end() - 1, value);
  const auto code = std::uint32_t(above - table.begin());
  return code > 1 && value - table[code - 1] < table[code] - value ? code - 1 : code;
}

/// The part of `from` samples that sample `to_index` of `to` covers, and its first sample's share.
struct Span {
  int first, last;       ///< inclusive
  float first_share, last_share;
  Span(int to_index, int to, int from) {
    const double scale = double(from) / to, begin = to_index * scale, end = std::min(double(from), begin + scale);
    first = std::min(int(begin), from - 1);
    last = std::clamp(int(std::ceil(end)) - 1, first, from - 1);
    first_share = float(std::min(end, double(first + 1)) - begin);
    last_share = last > first ? float(end - last) : first_share;
  }
  float share(int i) const { return i == first ? first_share : i == last ? last_share : 1.0f; }
};

/// Texels left and right of a coordinate, and the right one's share.
struct Pair {
  int a, b;
  float share;
};

/// A coordinate brought to [0, 1].
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

TexturePyramid::TexturePyramid(CodedPixels pixels, TextureTransfer transfer, int max_side)
    : channels_(pixels.channels),
      bits_(pixels.bits),
      cutout_(transfer == TextureTransfer::srgb_cutout && pixels.channels % 2 == 0),
      colour_(&table_of(pixels.bits, transfer != TextureTransfer::linear)),
      alpha_(&table_of(pixels.bits, false)) {
  TEMPOLUX_CHECK(pixels.width > 0 && pixels.height > 0 && max_side > 0);
  levels_.push_back({pixels.width, pixels.height, std::move(pixels.bytes)});
  if (const int side = std::max(pixels.width, pixels.height); side > max_side) {
    const double scale = double(max_side) / side;
    levels_[0] = reduced(levels_[0], std::max(1, int(std::lround(pixels.width * scale))),
                         std::max(1, int(std::lround(pixels.height * scale))));
  }
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& last = levels_.back();
    levels_.push_back(reduced(last, std::max(1, last.width / 2), std::max(1, last.height / 2)));
  }
}

std::uint64_t TexturePyramid::byte_count() const {
  std::uint64_t bytes = 0;
  for (const Level& level : levels_) bytes += level.codes.size();
  return bytes;
}

std::uint32_t TexturePyramid::code(const Level& level, std::size_t sample) const {
  if (bits_ == 8) return level.codes[sample];
  std::uint16_t value;
  std::memcpy(&value, &level.codes[2 * sample], sizeof value);
  return value;
}

TexturePyramid::Level TexturePyramid::reduced(const Level& from, int width, int height) const {
  const auto channels = std::size_t(channels_);
  Level to{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * channels *
                                                    std::size_t(bits_ / 8))};
  const bool has_alpha = channels_ % 2 == 0;
  // A row of the result, not yet narrowed; and the same with colours times alpha, for cutouts.
  std::vector<float> row(std::size_t(from.width) * channels), shown(cutout_ ? row.size() : 0);
  for (int y = 0; y < height; ++y) {
    const Span tall(y, height, from.height);
    std::fill(row.begin(), row.end(), 0.0f);
    std::fill(shown.begin(), shown.end(), 0.0f);
    float rows = 0;
    for (int j = tall.first; j <= tall.last; ++j) {
      const float share = tall.share(j);
      rows += share;
      for (std::size_t i = 0; i < row.size(); ++i) {
        const auto& table = has_alpha && i % channels == channels - 1 ? *alpha_ : *colour_;
        const float value = table[code(from, std::size_t(j) * row.size() + i)];
        row[i] += share * value;
        if (!cutout_) continue;
        const std::size_t alpha = std::size_t(j) * row.size() + i / channels * channels + channels - 1;
        shown[i] += share * value * (*alpha_)[code(from, alpha)];
      }
    }
    for (int x = 0; x < width; ++x) {
      const Span wide(x, width, from.width);
      const auto sum_of = [&](const std::vector<float>& values, std::size_t c) {
        float sum = 0;
        for (int i = wide.first; i <= wide.last; ++i) sum += wide.share(i) * values[std::size_t(i) * channels + c];
        return sum;
      };
      float columns = 0;
      for (int i = wide.first; i <= wide.last; ++i) columns += wide.share(i);
      const float covered = cutout_ ? sum_of(row, channels - 1) : 0;
      for (std::size_t c = 0; c < channels; ++c) {
        const bool is_alpha = has_alpha && c == channels - 1;
        const float value = covered > 0 && !is_alpha ? sum_of(shown, c) / covered : sum_of(row, c) / (rows * columns);
        const std::uint32_t result = nearest_code(is_alpha ? *alpha_ : *colour_, value);
        const std::size_t at = (std::size_t(y) * std::size_t(width) + std::size_t(x)) * channels + c;
        if (bits_ == 8) {
          to.codes[at] = std::uint8_t(result);
        } else {
          const auto narrow = std::uint16_t(result);
          std::memcpy(&to.codes[2 * at], &narrow, sizeof narrow);
        }
      }
    }
  }
  return to;
}

Rgba TexturePyramid::texel(const Level& level, int x, int y) const {
  const auto channels = std::size_t(channels_);
  const std::size_t at = (std::size_t(y) * std::size_t(level.width) + std::size_t(x)) * channels;
  Rgba value;
  for (std::size_t c = 0; c < 3; ++c) value[c] = (*colour_)[code(level, at + (channels < 3 ? 0 : c))];
  value[3] = channels % 2 == 0 ? (*alpha_)[code(level, at + channels - 1)] : 1.0f;
  return value;
}

Rgba TexturePyramid::texel(int level, int x, int y) const { return texel(levels_[std::size_t(level)], x, y); }

Rgba TexturePyramid::bilinear(const Level& level, Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) const {
  const Pair x = pair_at(uv.x, level.width, wrap_u), y = pair_at(uv.y, level.height, wrap_v);
  return mix(mix(texel(level, x.a, y.a), texel(level, x.b, y.a), x.share),
             mix(texel(level, x.a, y.b), texel(level, x.b, y.b), x.share), y.share);
}

Rgba TexturePyramid::read(Vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v, bool nearest, float level) const {
  if (!(level > 0)) {
    const Level& image = levels_[0];
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
  constexpr int kWindow = 8;  // texels on a side to look at
  const Vec2 size{upper.x - lower.x, upper.y - lower.y};
  if (!std::isfinite(lower.x + lower.y + upper.x + upper.y)) return true;
  // The finest level at which the window is small; one texel more on each side for what a read mixes in.
  std::size_t l = 0;
  while (l + 1 < levels_.size() && (size.x * float(levels_[l].width) > float(kWindow) ||
                                    size.y * float(levels_[l].height) > float(kWindow)))
    ++l;
  const Level& level = levels_[l];
  const auto steps = [&](float extent, int texels) {
    return int(std::min(extent * float(texels), float(texels))) + 4;
  };
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
