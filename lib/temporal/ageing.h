// lib/temporal/ageing.h -- draws the cells whose gather rays are renewed, by the age of their rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tempolux {

/// Draws cells without replacement: each time a cell is drawn with probability weight / sum of the remaining weights,
/// where the weight of a cell is its age squared
/// [Tawara et al. 2004, a random integer mapped through the cumulated weights]. Cells of one age form one class, so a
/// draw takes one step per class.
class AgeDraw {
 public:
  /// Ages are 1 to formats::kMaxAge; cells of the maximum age are always drawn. `drawn` receives `count` cells, fewer
  /// if there are fewer, more if more have the maximum age. `key` seeds the random numbers and must differ between
  /// draws.
  void draw(std::span<const std::uint16_t> ages, std::size_t count, std::uint64_t key,
            std::vector<std::uint32_t>& drawn);

 private:
  struct Class {
    std::uint64_t weight = 0;  ///< of a member
    std::uint32_t first = 0, size = 0;
  };
  std::uint32_t take(Class& from, std::uint64_t member);

  std::vector<Class> classes_;          ///< by age
  std::vector<std::uint32_t> members_;  ///< cells, sorted by class
};

}  // namespace tempolux
