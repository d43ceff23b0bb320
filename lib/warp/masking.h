// lib/warp/masking.h -- which warped pixels are not to be trusted although keys give them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/warp/warp.h"

namespace tempolux {

class Masking {
 public:
  /// All references outlive this.
  Masking(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options,
          const std::vector<std::string>& names);

  /// Causes of a pixel that is not the same in target and key: slow, specular. candidates: of both keys, or nullptr if
  /// one does not give the whole pixel.
  std::uint32_t of_moved_pixel(std::size_t pixel, const float* colour, const float* first, const float* second) const;

  /// Is what the keys differ by in specular light to be judged by WarpTarget::see_gloss?
  bool judges_gloss() const { return specular_[0] >= 0 && keys_.size() == 2 && target_.see_gloss != nullptr; }
  /// R, G, B of what they differ by.
  void note_gloss(const float* first, const float* second, std::array<float, 3>& error) const {
    for (std::size_t c = 0; c < 3; ++c) error[c] = first[specular_[c]] - second[specular_[c]];
  }
  /// Masks pixels where a viewer would see it.
  void mark_seen_gloss(const std::vector<std::vector<float>>& colour, std::array<std::vector<float>, 3>&& error,
                       std::vector<std::uint32_t>& why) const;
  /// Do the keys agree about a pixel that is composed of several surfaces?
  bool edge_agrees(const float* first, const float* second) const;

  /// Mean and mean square of what is seen at several positions.
  struct Spread {
    std::array<float, 3> mean{}, square{};  ///< R, G, B
  };
  Spread spread(const float* mean, const float* square) const;
  /// At how many positions a pixel composed of several surfaces must be known for its error to be
  /// WarpOptions::edge_share of its light: n positions in rows and columns of their own err by sigma n^(-5/6)
  /// (docs/pixels.md), sigma the standard deviation of what they show. `at`: of the `count` positions tried. What they
  /// all missed has a share of 1 / (2 count), about; how it differs is estimated from the centres of the 3 x 3 pixels
  /// `around`, of which an edge leaves a third on its other side.
  std::size_t edge_positions(Spread at, std::size_t count, Spread around) const;

  /// Does any key show what other light may shine upon? Else mark_changed_light() has nothing to do.
  bool light_may_differ() const;
  /// Marks pixels around which the two keys' light differs, and those that one key alone gives if its light may not be
  /// the target's. light: by key and pixel, luminance of what it gives; < 0: it does not give the whole pixel.
  void mark_changed_light(const std::array<std::vector<float>, 2>& light, std::vector<std::uint32_t>& why) const;

  float luminance_of(const float* colour) const;
  /// R, G, B of a colour.
  void note_light(const float* colour, std::array<float, 3>& rgb) const {
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = colour[rgb_[c]];
  }

 private:
  bool specular_matters(std::size_t pixel, const float* colour, const float* first, const float* second) const;

  const WarpTarget& target_;
  std::span<const WarpKey> keys_;
  const WarpOptions& options_;
  std::array<int, 3> rgb_{-1, -1, -1}, specular_{-1, -1, -1};  ///< where the channels are; -1: absent
  float dark_ = 0;                                             ///< a tenth of the keys' mean luminance
};

}  // namespace tempolux
