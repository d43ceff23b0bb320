// lib/image/reduce_texels.h -- computes the coarser levels of a texture from texels as codes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace tempolux {

/// Converts codes of 8 or 16 bits to linear values in [0, 1] and back.
struct TexelCodes {
  std::vector<float> value;  ///< by code, ascending

  /// bits: 8 or 16; srgb: IEC 61966-2-1, else proportional.
  static const TexelCodes& of(int bits, bool srgb);
  /// The code with the nearest value (the higher code of two equally near); never 0 for a value above 0.
  std::uint32_t nearest(float of) const;

 private:
  TexelCodes(std::size_t codes, bool srgb);
  static constexpr int kSteps = 4096;
  std::vector<float> from_;           ///< by code: the smallest value whose nearest code it is; infinity at the end
  std::vector<std::uint32_t> start_;  ///< by value x kSteps, rounded down: that value's nearest code
};

/// Texels row by row from the top. A sample is a code of one byte, or of two bytes in the machine's order.
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

/// Meaning of the channels: with 2 or 4 channels the last one is alpha. cutout: means of colours are weighted by alpha;
/// where all texels are hidden, they are plain means.
struct TexelKind {
  int channels = 3, bits = 8;
  bool cutout = false;
  const TexelCodes* colour = nullptr;
  const TexelCodes* alpha = nullptr;
};

/// Each texel is the mean of the linear light over its area, rounded to the nearest code, but 0 only if all texels of
/// its area are 0. width and height are at most those of `from`.
TexelLevel reduce_texels(const TexelLevel& from, int width, int height, const TexelKind& kind);

}  // namespace tempolux
