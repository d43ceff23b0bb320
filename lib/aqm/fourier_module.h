// lib/aqm/fourier_module.h -- what lib/aqm and the module tempolux-fourier agree on; plain C types only.
#pragma once

#include <cstdint>

namespace tempolux {

inline constexpr std::uint32_t kFourierAbi = 1;

enum FourierKind : std::int32_t {
  fourier_forward =
      0,  ///< `in`: width*height reals; `out`: height rows of width/2 + 1 complex numbers; exp(-i 2 pi ..)
  fourier_inverse = 1,  ///< `in` = `out`: width*height complex numbers, transformed in place; exp(+i 2 pi ..)
};

/// One transform of two dimensions, not normalised. Arrays are aligned to kFourierAlignment bytes, complex
/// numbers are pairs of floats.
struct FourierRequest {
  std::uint32_t abi;  ///< kFourierAbi; another: refused
  std::int32_t kind;  ///< FourierKind
  std::int32_t width, height;
  float* in;  ///< kept by fourier_forward
  float* out;
};
inline constexpr std::size_t kFourierAlignment = 64;

enum FourierResult : std::int32_t { fourier_ok = 0, fourier_bad_version = 1, fourier_no_memory = 2 };

/// The module's only symbol; from any thread.
using FourierEntry = std::int32_t(const FourierRequest*);
inline constexpr const char* kFourierSymbol = "tempolux_fourier";

}  // namespace tempolux
