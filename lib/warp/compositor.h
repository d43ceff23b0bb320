// lib/warp/compositor.h -- what the keys together give for a pixel.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "lib/warp/warp.h"

namespace tempolux {

/// What the keys give for one pixel.
struct ComposedPixel {
  alignas(32) std::array<float, kMostChannels> colour;                 ///< composed
  alignas(32) std::array<std::array<float, kMostChannels>, 2> of_key;  ///< by each key alone
  alignas(32) std::array<float, kMostChannels> square;  ///< of several positions: mean square of what they show
  std::array<int, 2> parts{};                           ///< how many positions it has given
  std::array<LookUp, 2> failed{LookUp::found, LookUp::found};
  bool missing = false;  ///< a position that no key gives
  bool undersampled = false, resampled = false;
};

/// Points of the target, looked up in all keys.
struct LookedUp {
  WantedPoints wanted;  ///< count, at, face: the caller's
  std::array<FoundPoints, 2> found;
};

class Compositor {
 public:
  /// All references outlive this.
  Compositor(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options);

  void look_up(LookedUp& points) const;
  /// Pixel p of the one position points[i], its centre.
  void centre(std::size_t p, const LookedUp& points, std::size_t i, ComposedPixel& pixel) const;
  /// Pixel p as the mean of all positions.
  void mean(std::size_t p, const LookedUp& points, ComposedPixel& pixel) const;

 private:
  double both_away() const { return keys_[0].frames_away + keys_[1].frames_away; }
  void start(ComposedPixel& pixel) const;
  bool stands(std::size_t p, const KeyView& view) const;
  bool take_what_stands(std::size_t p, ComposedPixel& pixel) const;
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
