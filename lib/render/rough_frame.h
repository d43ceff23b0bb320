// lib/render/rough_frame.h -- a rough frame: what each way to a frame's light costs and errs, measured on a few
// thousand samples.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lib/light/aim.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Work is counted in shadow rays, so that decisions do not depend on how fast or how busy a machine is. What other
/// things cost was measured in CPU time over that of a shadow ray with its light sample (.3 us), shading included:
/// docs/pixels.md.
struct Work {
  static constexpr double kRay = 2;        ///< nearest hit, surface, material
  static constexpr double kGatherRay = 4;  ///< the same, and what its end is looked up with
  static constexpr double kPhoton = 2;     ///< a path of light, and as much for each photon that it leaves
  static constexpr double kPoint = 90;     ///< an irradiance point: densities, light samples
  static constexpr double kRecordLookUp = 3, kCausticLookUp = 9;
};

/// What one sample of a kind costs and errs. Errors are those of a picture file, which holds about the root of
/// radiance: each variance is divided by the square of what its pixel may err by (allowed_error of pixel error 1), and
/// a sample brings at most what makes its pixel white. As frames take more samples where noise is, a variance here is
/// the square of the mean of its root over 16 x 9 parts of the picture: n samples a pixel leave it / n.
struct SampleEffort {
  double work = 0;                              ///< shadow rays
  double all = 0, without_caustic = 0;          ///< variance of all light, and of all but layer caustic
  double other = 0, other_without_caustic = 0;  ///< of all but layer indirect, likewise
};

/// Light that photons show and paths do not, surely.
struct MissedLight {
  double square = 0;    ///< squared error of never finding it
  double variance = 0;  ///< of one path that might find it, at least
};

/// What the surfaces that a camera sees scatter, and how it is found. What has not been measured is the least that it
/// can be: where a way costs too much even so it need not be measured.
struct RoughFrame {
  bool gathered = false, recorded = false;  ///< are gathering and records measured?
  int places = 0;                           ///< seen that have a Lambert lobe; 0: none is
  double radiance = 0;                      ///< mean of the picture, as paths find it [W/m^2/sr]
  /// Mean squared error that the wish leaves of all light but layer indirect, and the variance of a sample of that
  /// light; at least the wish's own error, and what the first samples make it of.
  double wanted = 0, wanted_of = 0;
  double samples = 0;  ///< of a pixel, that it takes
  SampleEffort path;   ///< whole paths
  /// ... that end at irradiance points; of all but layer indirect also what is left where records are.
  SampleEffort gather;
  double record_sample = 0;  ///< shadow rays of a sample that reads a record
  /// Records: how many the picture needs, what a ray of one costs with all that follows, and squared error x rays of
  /// the light interpolated between them.
  double records = 0, record_ray = 0, record_error = 0;
  MissedLight missed, missed_caustic;  ///< of layers indirect and caustic
  double map_error = 0;                ///< squared error of the caustic light that a density of photons estimates
  double photons_per_path = 0;
  std::uint64_t paths_of_light = 0;  ///< that the map would have: more than asked for where few of them arrive
};

struct RoughOptions {
  std::string kinds;  ///< of photons, as PhotonOptions::set_kinds: "caustic,indirect"
  double pixel_error = 0.016;
  std::uint64_t photons = 700'000;       ///< paths of light that the map has where enough of them arrive
  std::span<const AimSphere> seen = {};  ///< where points lie; none: everywhere
  std::uint64_t seed = 0;
  int places = 2048;  ///< of the picture
  /// Is the answer known? Asked before gathering and before records are measured; empty: no.
  std::function<bool(const RoughFrame&)> enough = {};
};

/// Places of four samples each, by paths and by points of 32768 paths of light, and records at 64 places: a
/// tenth or two of a second in all. `aimed`: lights that aim photons where the camera looks. Same result for any number
/// of threads.
RoughFrame rough_frame(const RenderScene& scene, const Lights& aimed, const CameraView& view,
                       const RoughOptions& options);

}  // namespace tempolux
