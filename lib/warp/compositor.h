// lib/warp/compositor.h -- composes a target pixel from the keys.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "lib/warp/warp.h"

namespace tempolux {

/// The composed colour of one pixel.
struct ComposedPixel {
  alignas(32) std::array<float, kMostChannels> colour;                 ///< composed
  alignas(32) std::array<std::array<float, kMostChannels>, 2> of_key;  ///< from each key alone
  alignas(32) std::array<float, kMostChannels> square;  ///< mean of the squared colour over several positions
  std::array<int, 2> parts{};                           ///< by key: number of positions the key has given
  std::array<LookUp, 2> failed{LookUp::found, LookUp::found};
  bool missing = false;  ///< true if no key shows one of the positions
  bool undersampled = false, resampled = false;
};

/// Points of the target, looked up in all keys.
struct LookedUp {
  WantedPoints wanted;  ///< count, at and face are set by the caller
  std::array<FoundPoints, 2> found;
};

class Compositor {
 public:
  /// All references must outlive this object.
  Compositor(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options);

  void look_up(LookedUp& points) const;
  /// Composes pixel p from one position, its centre, which is points[i].
  void centre(std::size_t p, const LookedUp& points, std::size_t i, ComposedPixel& pixel) const;
  /// Composes pixel p as the mean of all positions.
  void mean(std::size_t p, const LookedUp& points, ComposedPixel& pixel) const;

 private:
  void start(ComposedPixel& pixel) const;
  bool shows_the_same(std::size_t p, const KeyView& view) const;
  bool copy_unmoved(std::size_t p, ComposedPixel& pixel) const;
  bool weigh(const LookedUp& points, std::size_t i, ComposedPixel& pixel, std::array<float, 2>& weight) const;
  void add(const float* colour, float* sum) const;

  const WarpTarget& target_;
  std::span<const WarpKey> keys_;
  const WarpOptions& options_;
  std::size_t stride_;
  std::array<float, 2> nearness_{};
  std::array<bool, 2> stays_{};
};

}  // namespace tempolux
