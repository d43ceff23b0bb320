// lib/render/pixel_noise.h -- how many samples pixels need, by what their neighbours and they themselves saw.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lib/render/pixel_light.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {

/// What is kept of a pixel between its first and its further samples.
struct PixelState {
  PixelLight::Memory memory;
  float mean = 0;                       ///< of the first samples, mean of the channels
  Rgb direct_noise{0.0f}, specular_noise{0.0f};   ///< LightControl, of all samples
  float sampled = 0, seen = 0;          ///< of the first
  bool plain = false;                   ///< the first met one matte surface, controlled
  int lights = 1;                       ///< samples of the lights to a further camera ray
  int own = 0;                          ///< further samples for its own sake
  std::uint32_t surface = kNone;        ///< met by the first
  double sharp = 0, sharp_variance = 0; ///< of one of the first: PixelSum::sharp; a square of light may be beyond float
  float difference = 0, noise_difference = 0;     ///< of all else: mean over half of the first samples less that over the others

  void add_noise(const LightControl& more) {
    direct_noise += more.direct;
    specular_noise += more.specular;
  }
};

/// Of a picture whose pixels have their first samples.
class PixelNoise {
 public:
  /// controlled: large lights' noise is taken out (LightControl).
  PixelNoise(const CameraView& view, const FrameOptions& options, bool controlled, std::span<PixelState> pixels)
      : view_(view), options_(options), controlled_(controlled), first_half_((options.samples + 1) / 2), pixels_(pixels) {}

  int first_half() const { return first_half_; }   ///< of the first samples

  /// Samples each pixel still needs, by what its neighbours saw. Its own samples are left out: a pixel whose
  /// first samples happened to agree would keep them, and penumbrae would come out too bright.
  std::vector<int> missing_samples();

  /// Samples for its own sake of a pixel that stands out by what has edges: one of its samples met a lamp that is smaller than
  /// a pixel in a curved mirror, say, and its neighbours' first samples had met none. Shared out like a dot's.
  int spot_samples(std::size_t pixel, int x, int y, const PixelSum& further, int samples) const;

  /// Share of the large lights' light that shadows leave.
  float seen_around(int x, int y) const;

  /// body(pixel) for those that share what further samples for its own sake change: neighbours on the same surface.
  template <class Body>
  void for_each_heir(std::size_t pixel, int x, int y, const Body& body) const {
    for_each_neighbour(x, y, kNear, [&](std::size_t at) {
      if (pixels_[at].plain == pixels_[pixel].plain && pixels_[at].surface == pixels_[pixel].surface) body(at);
    });
  }
  int count_heirs(std::size_t pixel, int x, int y) const;

 private:
  // Pixels: one is judged by the 24 around it; by 8 for what has edges, which are narrow: all that see one pay for it.
  static constexpr int kNear = 2, kNearSharp = 1;

  /// body(pixel) for the neighbours of a pixel, at most `near` away, that are rendered.
  template <class Body>
  void for_each_neighbour(int x, int y, int near, const Body& body) const {
    for (int j = std::max(0, y - near); j <= std::min(view_.height() - 1, y + near); ++j)
      for (int i = std::max(0, x - near); i <= std::min(view_.width() - 1, x + near); ++i) {
        const std::size_t at = std::size_t(j) * std::size_t(view_.width()) + std::size_t(i);
        if ((i != x || j != y) && (options_.mask.empty() || options_.mask[at])) body(at);
      }
  }

  void ask_for_own(std::size_t pixel, int x, int y, int samples);
  double smooth_variance(std::size_t pixel, int x, int y) const;
  double sharp_variance(int x, int y) const;
  bool is_plain(int x, int y) const;
  double level_around(int x, int y) const;
  double wanted_samples(double sigma, double level) const;

  const CameraView& view_;
  const FrameOptions& options_;
  bool controlled_;
  int first_half_;
  double picture_ = 0;   ///< mean of all pixels' first samples
  std::span<PixelState> pixels_;
};

}  // namespace tempolux
