// formats/octahedral.h -- unit vectors in two 16-bit numbers (conventions.md, "Octahedral normals").
#pragma once

#include <array>
#include <cstdint>

namespace tempolux::formats {

/// Octahedral encoding (conventions.md) of a vector that is not zero, of any length, in two 16-bit numbers of
/// 0 .. 65534, and back (unit length to 1e-7). The axes are exact; the angle is off by at most 6.5e-5 rad.
std::array<std::uint16_t, 2> encode_normal(std::array<float, 3> n);
std::array<float, 3> decode_normal(std::array<std::uint16_t, 2> code);

}  // namespace tempolux::formats
