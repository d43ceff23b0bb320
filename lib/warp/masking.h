// lib/warp/masking.h -- decides which warped pixels must be traced although keys give them.
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
  /// All references must outlive this object.
  Masking(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options,
          const std::vector<std::string>& names);

  /// Causes (slow, specular) to mask a pixel that is not the same in target and key. `first` and `second` are the
  /// candidates of both keys; nullptr if a key does not give the whole pixel.
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
  /// True if the keys agree about a pixel that is composed of several surfaces.
  bool edge_agrees(const float* first, const float* second) const;

  /// Mean and mean square of the colours at several positions.
  struct Spread {
    std::array<float, 3> mean{}, square{};  ///< R, G, B
  };
  Spread spread(const float* mean, const float* square) const;
  /// Number of positions at which a pixel composed of several surfaces is looked up, so that its error is
  /// WarpOptions::edge_share of its light. n positions of which no two share a row or a column have the error sigma
  /// n^(-5/6) (docs/pixels.md), with sigma the standard deviation of the colours.
  /// `at`: spread of the colours at the `count` positions tried. A surface that all of these missed covers a share of
  /// about 1 / (2 count) of the pixel. `around`: spread of the colours at the centres of the 3 x 3 pixels. An edge
  /// leaves a third of these centres on its other side, so `around` gives the difference in colour of the missed
  /// surface.
  std::size_t edge_positions(Spread at, std::size_t count, Spread around) const;

  /// True if the light may differ on any surface that a key shows; else mark_changed_light() has nothing to do.
  bool light_may_differ() const;
  /// Masks pixels around which the two keys' light differs, and pixels given by one key alone whose light may differ
  /// from the target's. `light`: by key and pixel, the luminance; < 0 if the key does not give the whole pixel.
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
