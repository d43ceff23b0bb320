// lib/temporal/ageing.h -- which cells get a new ray: drawn by how long they have had their old one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tempolux {

/// Weight of a cell in the draw: its age, its age squared; or the oldest come first, equal ages by lot.
enum class AgeWeight { linear, square, oldest };

/// Draws cells without replacement: each next one with probability weight / sum of the weights of those left [Tawara et
/// al. 2004, a random integer mapped through the cumulated weights]. Cells of one age are one class, so a draw costs a
/// step a class.
class AgeDraw {
 public:
  /// Ages are 1 to formats::kMaxAge; cells of that age are always drawn. `drawn` receives `count` cells, or all if
  /// there are fewer, or those of that age if there are more. `key`: of the random numbers, another one in each draw.
  void draw(std::span<const std::uint16_t> ages, std::size_t count, AgeWeight weight, std::uint64_t key,
            std::vector<std::uint32_t>& drawn);

 private:
  struct Class {
    std::uint64_t weight = 0;  ///< of a member
    std::uint32_t first = 0, size = 0;
  };
  std::uint32_t take(Class& from, std::uint64_t member);

  std::vector<Class> classes_;          ///< by age
  std::vector<std::uint32_t> members_;  ///< cells, class by class
};

}  // namespace tempolux
