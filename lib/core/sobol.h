// lib/core/sobol.h -- Owen-scrambled Sobol points, padded by dimension pairs, for pixel samples.
#pragma once

#include <cstdint>

#include "lib/core/vec.h"

namespace tempolux {

/// Point `index` of a scrambled two-dimensional Sobol sequence. The first 2^k points of one `key` are stratified in
/// every elementary box of area 2^-k; sequences of different keys are independent. Burley, "Practical Hash-based Owen
/// Scrambling", JCGT 9(4), 2020. Components in [0, 1).
Vec2 sobol_owen_2d(std::uint32_t index, std::uint64_t key);

/// Point `index` of a scrambled one-dimensional Sobol sequence (the radical inverse in base 2), in [0, 1).
float sobol_owen_1d(std::uint32_t index, std::uint64_t key);

}  // namespace tempolux
