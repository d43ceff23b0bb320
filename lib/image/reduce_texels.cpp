#include "lib/image/reduce_texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lib/image/srgb.h"

namespace tempolux {
namespace {

/// The texels along one side, of `from`, that texel `to_index` of `to` covers, and which share of each.
struct Span {
  int first, last;  ///< inclusive
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

void put(TexelLevel& to, int bits, std::size_t sample, std::uint32_t code) {
  if (bits == 8) {
    to.codes[sample] = std::uint8_t(code);
  } else {
    const auto narrow = std::uint16_t(code);
    std::memcpy(&to.codes[2 * sample], &narrow, sizeof narrow);
  }
}

/// Reduces any size to any smaller size. `means` are the values of `to`; see reduce_texels() for `exact`.
void reduce_any(const TexelLevel& from, const TexelKind& kind, const std::vector<float>& exact, TexelLevel& to,
                std::vector<float>& means) {
  const auto channels = std::size_t(kind.channels);
  const bool has_alpha = channels % 2 == 0;
  const auto value_at = [&](std::size_t sample, const TexelCodes& codes) {
    return exact.empty() ? codes.value[code_of(from, kind.bits, sample)] : exact[sample];
  };
  // Sums over the rows of `from` that a row of `to` covers; in `shown` colours are multiplied by alpha, for cutouts.
  std::vector<float> row(std::size_t(from.width) * channels), shown(kind.cutout ? row.size() : 0);
  for (int y = 0; y < to.height; ++y) {
    const Span tall(y, to.height, from.height);
    std::fill(row.begin(), row.end(), 0.0f);
    std::fill(shown.begin(), shown.end(), 0.0f);
    float rows = 0;
    for (int j = tall.first; j <= tall.last; ++j) {
      const float share = tall.share(j);
      rows += share;
      for (std::size_t i = 0; i < row.size(); ++i) {
        const TexelCodes& codes = has_alpha && i % channels == channels - 1 ? *kind.alpha : *kind.colour;
        const float value = value_at(std::size_t(j) * row.size() + i, codes);
        row[i] += share * value;
        if (!kind.cutout) continue;
        const std::size_t alpha = std::size_t(j) * row.size() + i / channels * channels + channels - 1;
        shown[i] += share * value * value_at(alpha, *kind.alpha);
      }
    }
    for (int x = 0; x < to.width; ++x) {
      const Span wide(x, to.width, from.width);
      const auto sum_of = [&](const std::vector<float>& values, std::size_t c) {
        float sum = 0;
        for (int i = wide.first; i <= wide.last; ++i) sum += wide.share(i) * values[std::size_t(i) * channels + c];
        return sum;
      };
      float columns = 0;
      for (int i = wide.first; i <= wide.last; ++i) columns += wide.share(i);
      const float covered = kind.cutout ? sum_of(row, channels - 1) : 0;
      for (std::size_t c = 0; c < channels; ++c) {
        const bool is_alpha = has_alpha && c == channels - 1;
        const float value = covered > 0 && !is_alpha ? sum_of(shown, c) / covered : sum_of(row, c) / (rows * columns);
        const std::size_t out = (std::size_t(y) * std::size_t(to.width) + std::size_t(x)) * channels + c;
        means[out] = value;
        put(to, kind.bits, out, (is_alpha ? *kind.alpha : *kind.colour).nearest(value, (x + y) % 2 == 0));
      }
    }
  }
}

/// Reduces to half the width and height, as nearly all levels need: same result as reduce_any(), 20 times as fast.
template <int kChannels, int kBits>
void halve(const TexelLevel& from, const TexelKind& kind, const std::vector<float>& exact, TexelLevel& to,
           std::vector<float>& means) {
  constexpr bool kAlpha = kChannels % 2 == 0;
  const std::size_t row = std::size_t(from.width) * kChannels;
  const float* colour = kind.colour->value.data();
  const float* alpha = kind.alpha->value.data();
  const auto value_at = [&](std::size_t sample, const float* values) {
    return exact.empty() ? values[code_of(from, kBits, sample)] : exact[sample];
  };
  std::size_t out = 0;
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x, out += kChannels) {
      const std::size_t upper = std::size_t(2 * y) * row + std::size_t(2 * x) * kChannels;
      const std::array<std::size_t, 4> at{upper, upper + row, upper + kChannels, upper + row + kChannels};
      std::array<float, 4> shares{};
      float covered = 0;
      if (kAlpha && kind.cutout) {
        for (std::size_t k = 0; k < 4; ++k) shares[k] = value_at(at[k] + kChannels - 1, alpha);
        covered = (shares[0] + shares[1]) + (shares[2] + shares[3]);
      }
      for (std::size_t c = 0; c < kChannels; ++c) {
        const bool is_alpha = kAlpha && c == kChannels - 1;
        const float* values = is_alpha ? alpha : colour;
        std::array<float, 4> v;
        for (std::size_t k = 0; k < 4; ++k) v[k] = value_at(at[k] + c, values);
        float mean;
        if (covered > 0 && !is_alpha)
          mean = ((v[0] * shares[0] + v[1] * shares[1]) + (v[2] * shares[2] + v[3] * shares[3])) / covered;
        else mean = ((v[0] + v[1]) + (v[2] + v[3])) / 4;
        means[out + c] = mean;
        put(to, kBits, out + c, (is_alpha ? kind.alpha : kind.colour)->nearest(mean, (x + y) % 2 == 0));
      }
    }
}

template <int kBits>
void halve(const TexelLevel& from, const TexelKind& kind, const std::vector<float>& exact, TexelLevel& to,
           std::vector<float>& means) {
  switch (kind.channels) {
    case 1: return halve<1, kBits>(from, kind, exact, to, means);
    case 2: return halve<2, kBits>(from, kind, exact, to, means);
    case 3: return halve<3, kBits>(from, kind, exact, to, means);
    default: return halve<4, kBits>(from, kind, exact, to, means);
  }
}

}  // namespace

TexelCodes::TexelCodes(std::size_t codes, bool srgb) : value(codes), from_(codes + 1), start_(kSteps + 1) {
  for (std::size_t i = 0; i < codes; ++i) {
    const float part = float(double(i) / double(codes - 1));
    value[i] = srgb ? srgb_to_linear(part) : part;
  }
  for (std::size_t i = 1; i < codes; ++i) from_[i] = 0.5f * (value[i - 1] + value[i]);
  from_.back() = INFINITY;
  std::uint32_t code = 0;
  for (int i = 0; i <= kSteps; ++i) {
    while (from_[code + 1] <= float(i) / kSteps) ++code;
    start_[std::size_t(i)] = code;
  }
}

const TexelCodes& TexelCodes::of(int bits, bool srgb) {
  static const TexelCodes linear8(256, false), srgb8(256, true);
  if (bits == 8) return srgb ? srgb8 : linear8;
  static const TexelCodes linear16(65536, false), srgb16(65536, true);
  return srgb ? srgb16 : linear16;
}

std::uint32_t TexelCodes::nearest(float of, bool up) const {
  if (!(of > 0)) return 0;
  std::uint32_t code = start_[std::size_t(std::min(of, 1.0f) * kSteps)];
  code += of >= from_[code + 1];  // with 8 bits no step holds more than one border
  while (of >= from_[code + 1]) ++code;
  if (!up && code > 0 && of == from_[code]) --code;
  return std::max(code, 1u);
}

TexelLevel reduce_texels(const TexelLevel& from, int width, int height, const TexelKind& kind,
                         std::vector<float>& exact) {
  const std::size_t samples = std::size_t(width) * std::size_t(height) * std::size_t(kind.channels);
  TexelLevel to{width, height, std::vector<std::uint8_t>(samples * std::size_t(kind.bits / 8))};
  std::vector<float> means(samples);
  if (from.width == 2 * width && from.height == 2 * height)
    kind.bits == 8 ? halve<8>(from, kind, exact, to, means) : halve<16>(from, kind, exact, to, means);
  else reduce_any(from, kind, exact, to, means);
  exact = std::move(means);
  return to;
}

}  // namespace tempolux
