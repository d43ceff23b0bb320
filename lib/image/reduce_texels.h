// lib/image/reduce_texels.h -- computes the coarser levels of a texture from texels as codes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace tempolux {

/// Converts codes of 8 or 16 bits to linear values in [0, 1] and back.
struct TexelCodes {
  std::vector<float> value;  ///< of each code, ascending

  /// `bits` is 8 or 16. `srgb`: IEC 61966-2-1; else values are proportional to codes. Thread-safe.
  static const TexelCodes& of(int bits, bool srgb);
  /// The code with the closest value; of two that are equally close the higher one with `up`, else the lower one. At
  /// least 1 for a value above 0.
  std::uint32_t nearest(float of, bool up) const;

 private:
  TexelCodes(std::size_t codes, bool srgb);
  static constexpr int kSteps = 4096;  ///< entries of start_; nearest() gives the same code for any number
  std::vector<float> from_;            ///< of each code: the smallest value that is rounded to it; infinity at the end
  std::vector<std::uint32_t> start_;  ///< of each i: the code of the value i / kSteps, where nearest() begins to search
};

/// A level of a texture: rows of texels from the top. A code has one byte, or two bytes in the machine's order.
struct TexelLevel {
  int width = 0, height = 0;
  std::vector<std::uint8_t> codes;
};

/// The code with index `sample`, of `bits` bits.
inline std::uint32_t code_of(const TexelLevel& level, int bits, std::size_t sample) {
  if (bits == 8) return level.codes[sample];
  std::uint16_t value;
  std::memcpy(&value, &level.codes[2 * sample], sizeof value);
  return value;
}

/// The meaning of codes. If there are 2 or 4 channels, the last one is alpha. cutout: means of colours are weighted by
/// alpha; if alpha is 0 in all texels, they are not weighted.
struct TexelKind {
  int channels = 3, bits = 8;
  bool cutout = false;
  const TexelCodes* colour = nullptr;
  const TexelCodes* alpha = nullptr;
};

/// A smaller level. Each texel is the mean of the linear light over its area, rounded to the closest code; it is 0 only
/// if all texels of its area are 0. A mean half way between two codes, which smooth gradients have often, goes up in
/// every second texel, as on a chessboard.
/// `exact`: the linear values of `from` without rounding; empty: those of its codes. Becomes the values of the result,
/// so that rounding does not add up over the levels. width and height are at most those of `from`.
TexelLevel reduce_texels(const TexelLevel& from, int width, int height, const TexelKind& kind,
                         std::vector<float>& exact);

}  // namespace tempolux
