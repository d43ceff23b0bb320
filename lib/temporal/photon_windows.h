// lib/temporal/photon_windows.h -- photons collected over time: for each element of the surfaces as many frames as its
// light stands still.
//
// Paper: Tawara's thesis talk (Myszkowski, Tawara, Akamine, Seidel 2001), "Temporal photon processing". Method:
// docs/methods/density.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/meshirrad/meshirrad.h"
#include "lib/core/vec.h"

namespace tempolux {

struct WindowOptions {
  int reach = 16;               ///< frames to each side at most
  double false_alarms = 0.005;  ///< share of the windows that close early though light is stationary
  double width = 1;  ///< m: least deviation of the Gaussian by which irradiance is smoothed afterwards; where photons
                     ///< are few it is wider, up to what counts kPhotonsInKernel photons of a single frame
};

/// Photons of one frame, counted by element.
struct FrameCounts {
  int frame = 0;
  double unit = 1;    ///< of sums and squares, in units of the frame in the middle; a power of two
  bool jump = false;  ///< from the frame before to this one light jumps: no window reaches across
  std::vector<formats::MeshElement> elements;  ///< of counts, photons > 0
};

/// Photons of one block of frames in one element, or in a region of elements.
struct HitBlock {
  double photons = 0;
  double flux = 0;     ///< sum of luminance
  double squares = 0;  ///< sum of its square: the variance of `flux` (compound Poisson)
  HitBlock& operator+=(const HitBlock& o) {
    photons += o.photons;
    flux += o.flux;
    squares += o.squares;
    return *this;
  }
  friend HitBlock operator+(HitBlock a, const HitBlock& b) { return a += b; }
  friend HitBlock operator-(HitBlock a, const HitBlock& b) {
    return {a.photons - b.photons, a.flux - b.flux, a.squares - b.squares};
  }
};

/// Is the light of `added` frames that of `old` ones? Standard deviations by which the flux of the added frames differs
/// from their share of all photons: each photon of both falls into an added frame with probability p = added / (old +
/// added), so the flux there has mean p S and variance p (1 - p) Q, S and Q sums over both, and skewness g = (1 - 2 p)
/// / sqrt(p (1 - p)) sqrt(Q) / S, exactly so for photons of equal power. The deviation z is made that of a Gaussian by
/// z - g (z^2 - 1) / 6 (Cornish and Fisher). 0 if there are no photons.
double block_contrast(const HitBlock& old, int old_frames, const HitBlock& added, int added_frames);

/// Deviations beyond which a test rejects, so that all tests of a window together reject stationary light with
/// probability `false_alarms`: n independent ones that do so with 1 - (1 - false_alarms)^(1/n) each.
class WindowThresholds {
 public:
  explicit WindowThresholds(const WindowOptions& options);
  int reach() const { return reach_; }
  double of(int tests) const { return by_tests_[std::size_t(tests)]; }

 private:
  int reach_;
  std::vector<double> by_tests_;
};

/// Frames before and after a frame.
struct Window {
  int before = 0, after = 0;
  bool operator==(const Window&) const = default;
};

/// Photons of consecutive frames, as running sums: block(a, b) in constant time.
class HitSeries {
 public:
  explicit HitSeries(std::size_t frames) : until_(frames + 1) {}
  HitBlock& at(std::size_t frame) { return until_[frame + 1]; }  ///< before sum_up()
  void sum_up();
  /// Of frames first .. last.
  HitBlock block(int first, int last) const { return until_[std::size_t(last) + 1] - until_[std::size_t(first)]; }

 private:
  std::vector<HitBlock> until_;
};

/// An element's photons, and those of the regions around it in which its light is tested, too.
struct WindowSeries {
  const HitSeries* element = nullptr;
  const HitSeries* kernel = nullptr;  ///< about the photons over which the spatial filter averages
  const HitSeries* ring = nullptr;    ///< nine times as many
  const HitSeries* frame = nullptr;   ///< all
};

/// The window of the frame `at` among `frames` frames (0 ..): grown by frames to both sides and by blocks of 1, 1, 2,
/// 4, 8 ... frames, as long as neither differs from the window so far.
Window grow_window(const WindowSeries& series, int at, int frames, const WindowThresholds& thresholds);

/// What windows make of the elements of a frame, one of each for an element.
struct CollectedLight {
  std::vector<Rgbd>
      flux;  ///< in a frame, mean over the window, for the size that the element has now [unit of the counts]
  std::vector<float>
      widths;  ///< m: deviation of the Gaussian that takes in kPhotonsInWindow photons there; 0: no photon near
};

/// Fills photons, sums and windows of `elements` (all_elements() at frames[at]) from `frames`, consecutive ones of a
/// segment; elements of surfaces from `moving` on may change their size. std::invalid_argument if counts are of other
/// elements.
CollectedLight collect_windows(std::span<const FrameCounts* const> frames, std::size_t at, std::uint32_t moving,
                               const WindowOptions& options, std::vector<formats::MeshElement>& elements);

}  // namespace tempolux
