// lib/temporal/photon_windows.h -- collects photons over time: each element uses as many neighbouring frames as its
// light stays constant.
//
// Paper: Tawara's thesis talk (Myszkowski, Tawara, Akamine, Seidel 2001), "Temporal photon processing". Method:
// docs/methods/density.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/meshirrad/meshirrad.h"
#include "lib/core/vec.h"
#include "lib/light_texture/mesh_elements.h"

namespace tempolux {

struct WindowOptions {
  int reach = 16;               ///< most frames to each side
  double false_alarms = 0.005;  ///< share of windows that end too early although light is constant
  /// Standard deviation s [m] of the Gaussian that smooths irradiance afterwards, at the mean density of photons in a
  /// full window. If photons are fewer by a factor f, the Gaussian is wider by f^(1/4): with N photons per area its
  /// squared error is about v / (N s^2) + b s^2 (noise and blur), which is least at s^4 = v / (N b). f is at most that
  /// of a window of one frame.
  double width = 1;
};

/// The photons of one frame, counted by element.
struct FrameCounts {
  int frame = 0;
  double unit = 1;    ///< of sums and squares, over the result's unit; a power of two
  bool jump = false;  ///< true if light jumps between the previous frame and this one: no window holds both
  std::vector<formats::MeshElement> elements;  ///< elements with photons
};

/// The photons of one block of frames, in one element or one region.
struct HitBlock {
  double photons = 0;
  double flux = 0;     ///< sum of the photons' luminance
  double squares = 0;  ///< sum of the photons' squared luminance: the variance of `flux` (compound Poisson)
  /// Number of photons of equal flux whose sum has the same relative variance; at most `photons`.
  double equal_photons() const { return squares > 0 ? flux * flux / squares : 0; }
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

/// The difference in light between the added and the old frames, in standard deviations; 0 if there are no photons. If
/// the light is constant, each photon falls into an added frame with the probability p = added / (old + added). Let S
/// be the flux and Q the sum of squares of all frames. The flux of the added frames then has the mean p S, the variance
/// p (1 - p) Q and the skewness g = (1 - 2 p) / sqrt(p (1 - p)) sqrt(Q) / S, which is exact for photons of equal flux.
/// Returns z - g (z^2 - 1) / 6, where z is the flux minus its mean in standard deviations; this value is nearly
/// Gaussian (Cornish and Fisher).
double block_contrast(const HitBlock& old, int old_frames, const HitBlock& added, int added_frames);

/// Thresholds [standard deviations] above which a test rejects. The n tests of a window count as independent. Each
/// rejects constant light with probability 1 - (1 - false_alarms)^(1/n), so that a window ends too early with
/// probability `false_alarms`.
class WindowThresholds {
 public:
  explicit WindowThresholds(const WindowOptions& options);
  int reach() const { return reach_; }
  double of(int tests) const { return by_tests_[std::size_t(tests)]; }

 private:
  int reach_;
  std::vector<double> by_tests_;
};

/// Numbers of frames before and after the middle frame.
struct Window {
  int before = 0, after = 0;
  bool operator==(const Window&) const = default;
};

/// Photons of consecutive frames as running sums, so that block(a, b) takes constant time.
class HitSeries {
 public:
  explicit HitSeries(std::size_t frames) : until_(frames + 1) {}
  HitBlock& at(std::size_t frame) { return until_[frame + 1]; }  ///< valid before sum_up()
  void sum_up();
  /// The sum over the frames first to last, both included.
  HitBlock block(int first, int last) const { return until_[std::size_t(last) + 1] - until_[std::size_t(first)]; }

 private:
  std::vector<HitBlock> until_;
};

/// The photons of an element, of two regions around it, and of the frame. Its light is tested in all of them.
struct WindowSeries {
  const HitSeries* element = nullptr;
  const HitSeries* kernel = nullptr;  ///< a region as large as the Gaussian of the spatial filter
  const HitSeries* ring = nullptr;    ///< a region nine times as large
  const HitSeries* frame = nullptr;   ///< all photons
};

/// Finds the window of frame `at` among `frames` frames (numbered from 0). The window grows to both sides by blocks of
/// 1, 1, 2, 4, 8 ... frames as long as the added frames do not differ from the window.
Window grow_window(const WindowSeries& series, int at, int frames, const WindowThresholds& thresholds);

/// The light that windows give to the elements of a frame; one entry per element.
struct CollectedLight {
  MeshFlux flux;              ///< per frame, mean over the window, for the element's present size [unit of the counts]
  std::vector<float> widths;  ///< m: deviation of the Gaussian of each element; 0: no photon is close
};

/// Finds the window of each element and collects its photons. `frames` are consecutive frames of a segment; `elements`
/// are all_elements() at frames[at], whose photons, sums and windows are set. Elements of surfaces from number `moving`
/// on may change their size. Throws std::invalid_argument if the counts belong to other elements.
CollectedLight collect_windows(std::span<const FrameCounts* const> frames, std::size_t at, std::uint32_t moving,
                               const WindowOptions& options, std::vector<formats::MeshElement>& elements);

}  // namespace tempolux
