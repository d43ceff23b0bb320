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
  alignas(32) std::array<float, kMostChannels> square;         ///< mean of the squared colour over several positions
  std::array<int, 2> parts{};                                  ///< by key: number of positions that the key shows
  std::array<LookUp, 2> failed{LookUp::found, LookUp::found};  ///< by key: worst result of its look-ups
  bool missing = false;                                        ///< true if at least one position is shown by no key
  bool undersampled = false;  ///< true if all keys that show a position magnify it too much
  bool resampled = false;     ///< false: the pixel was copied from a key to the bit
};

/// Points of the target, and the results of looking them up in the keys.
struct LookedUp {
  WantedPoints wanted;  ///< the caller sets count, at and face
  std::array<FoundPoints, 2> found;
};

/// Composes the pixels of the target from one or two keys.
class Compositor {
 public:
  /// All references must outlive this object.
  Compositor(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options);

  /// Looks up points.wanted in all keys.
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
  std::array<float, 2> time_weight_{};  ///< by key
  std::array<bool, 2> same_camera_{};   ///< by key: unmoved pixels can be copied from it
};

}  // namespace tempolux
