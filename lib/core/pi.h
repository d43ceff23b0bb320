// lib/core/pi.h -- pi in double precision; kPi in float is in sampling.h.
#pragma once

#include <numbers>

namespace tempolux {

inline constexpr double kPiD = std::numbers::pi;

}  // namespace tempolux
