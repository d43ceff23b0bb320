// lib/image/reduce_texels.h -- the levels of a texture: texels as codes, and fewer texels from many.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace tempolux {

/// The linear value [0, 1] that each code of 8 or 16 bits means, and back.
struct TexelCodes {
  std::vector<float> value;  ///< by code, rising

  /// bits: 8 or 16; srgb: IEC 61966-2-1, else proportional.
  static const TexelCodes& of(int bits, bool srgb);
  /// The code whose value is nearest, the higher one of two; never 0 for a value above 0.
  std::uint32_t nearest(float of) const;

 private:
  TexelCodes(std::size_t codes, bool srgb);
  static constexpr int kSteps = 4096;
  std::vector<float> from_;           ///< by code: the least value that it is nearest to; at the end infinity
  std::vector<std::uint32_t> start_;  ///< by value x kSteps, rounded down: the code nearest to that
};

/// Texels row by row from the top, each sample a code of one byte, or of two in the machine's order.
struct TexelLevel {
  int width = 0, height = 0;
  std::vector<std::uint8_t> codes;
};

inline std::uint32_t code_of(const TexelLevel& level, int bits, std::size_t sample) {
  if (bits == 8) return level.codes[sample];
  std::uint16_t value;
  std::memcpy(&value, &level.codes[2 * sample], sizeof value);
  return value;
}

/// What texels are: with 2 or 4 channels the last is alpha. cutout: means of colours are weighted by alpha, the plain
/// mean where all is hidden.
struct TexelKind {
  int channels = 3, bits = 8;
  bool cutout = false;
  const TexelCodes* colour = nullptr;
  const TexelCodes* alpha = nullptr;
};

/// Each texel the mean of the linear light over the area that it covers, rounded to the nearest code, but 0 only if all
/// it covers is 0. width and height: at most those of `from`.
TexelLevel reduce_texels(const TexelLevel& from, int width, int height, const TexelKind& kind);

}  // namespace tempolux
