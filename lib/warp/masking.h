// lib/warp/masking.h -- decides which pixels must be traced although keys show them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/warp/warp.h"

namespace tempolux {

/// The decisions about the pixels of one warped frame.
class Masking {
 public:
  /// All references must outlive this object.
  Masking(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options,
          const std::vector<std::string>& names);

  /// The causes slow and specular of a pixel that was resampled. `first` and `second` are its colours from each key
  /// alone; nullptr if a key does not show the whole pixel.
  std::uint32_t of_moved_pixel(std::size_t pixel, const float* colour, const float* first, const float* second) const;

  /// True if WarpTarget::see_gloss decides about differences between the keys' specular light.
  bool judges_gloss() const { return specular_[0] >= 0 && keys_.size() == 2 && target_.see_gloss != nullptr; }
  /// Writes the keys' difference in specular light as R, G, B.
  void note_gloss(const float* first, const float* second, std::array<float, 3>& error) const {
    for (std::size_t c = 0; c < 3; ++c) error[c] = first[specular_[c]] - second[specular_[c]];
  }
  /// Masks pixels in which a viewer would see the error of specular light.
  void mark_seen_gloss(const std::vector<std::vector<float>>& colour, std::array<std::vector<float>, 3>&& error,
                       std::vector<std::uint32_t>& why) const;
  /// True if the colours from both keys agree about a pixel that shows several surfaces (WarpOptions::edge_share).
  bool edge_agrees(const float* first, const float* second) const;

  /// Mean and mean square of the colours at several positions.
  struct Spread {
    std::array<float, 3> mean{}, square{};  ///< R, G, B
  };
  Spread spread(const float* mean, const float* square) const;
  /// Number of positions n at which a pixel with several surfaces must be looked up so that its error is
  /// WarpOptions::edge_share of its light. n positions of which no two share a row or a column have the error sigma
  /// n^(-5/6) (docs/pixels.md), where sigma is the standard deviation of the colours. sigma is the larger of
  /// - the deviation at the `count` positions that were looked up (`at`), and
  /// - the deviation that a missed surface could cause. A surface missed by all positions covers about 1 / (2 count) of
  ///   the pixel. Its colour follows from `around`, the colours at the centres of the 3 x 3 pixels, of which about a
  ///   third lie on the other side of an edge.
  std::size_t edge_positions(Spread at, std::size_t count, Spread around) const;

  /// True if the light may differ on any surface that a key shows; else mark_changed_light() has nothing to do.
  bool light_may_differ() const;
  /// Masks pixels around which the light of both keys differs, and pixels shown by only one key if its light may differ
  /// from the target's light. `light`: luminance by key and pixel; < 0 if the key does not show the whole pixel.
  void mark_changed_light(const std::array<std::vector<float>, 2>& light, std::vector<std::uint32_t>& why) const;

  float luminance_of(const float* colour) const;
  /// Writes R, G, B of a colour.
  void note_light(const float* colour, std::array<float, 3>& rgb) const {
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = colour[rgb_[c]];
  }

 private:
  bool specular_matters(std::size_t pixel, const float* colour, const float* first, const float* second) const;

  const WarpTarget& target_;
  std::span<const WarpKey> keys_;
  const WarpOptions& options_;
  std::array<int, 3> rgb_{-1, -1, -1}, specular_{-1, -1, -1};  ///< indices of the channels; -1: absent
  float dark_ = 0;                                             ///< a tenth of the keys' mean luminance
};

}  // namespace tempolux
