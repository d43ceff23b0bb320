// lib/aqm/fourier_module.h -- the interface between lib/aqm and the module tempolux-fourier; plain C types only.
#pragma once

#include <cstdint>

namespace tempolux {

inline constexpr std::uint32_t kFourierAbi = 1;

enum FourierKind : std::int32_t {
  fourier_forward =
      0,  ///< `in`: width*height reals; `out`: height rows of width/2 + 1 complex numbers; exp(-i 2 pi ..)
  fourier_inverse = 1,  ///< `in` = `out`: width*height complex numbers, transformed in place; exp(+i 2 pi ..)
};

/// One two-dimensional transform, not normalised. Arrays are aligned to kFourierAlignment bytes; complex numbers are
/// pairs of floats.
struct FourierRequest {
  std::uint32_t abi;  ///< kFourierAbi; the module refuses another version
  std::int32_t kind;  ///< FourierKind
  std::int32_t width, height;
  float* in;  ///< unchanged by fourier_forward
  float* out;
};
inline constexpr std::size_t kFourierAlignment = 64;

enum FourierResult : std::int32_t { fourier_ok = 0, fourier_bad_version = 1, fourier_no_memory = 2 };

/// The module's only symbol; any thread may call it.
using FourierEntry = std::int32_t(const FourierRequest*);
inline constexpr const char* kFourierSymbol = "tempolux_fourier";

}  // namespace tempolux
