// lib/temporal/ageing.h -- draws the cells whose gather rays are renewed, by the age of their rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tempolux {

/// Draws `count` cells without replacement; all cells if there are fewer. The weight of a cell is its age squared
/// [Tawara et al. 2004]; each draw takes a cell with the probability weight / sum of the weights of the remaining
/// cells. Ages are 1 to formats::kMaxAge. Cells of the maximum age are always drawn, also if there are more than
/// `count` of them. `drawn` receives the cells in the order of the draws. `key` seeds the random numbers and must
/// differ between calls.
void draw_by_age(std::span<const std::uint16_t> ages, std::size_t count, std::uint64_t key,
                 std::vector<std::uint32_t>& drawn);

}  // namespace tempolux
