// lib/render/rough_frame.h -- measures work and error of each way to a frame's light on a few thousand samples.
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
#include "lib/render/places_seen.h"

namespace tempolux {

/// Work is counted in shadow rays, so that decisions do not depend on the speed or the load of a machine. The unit is
/// a shadow ray with its light sample and shading (.3 us); the other costs are CPU times over that time
/// (docs/pixels.md).
struct Work {
  static constexpr double kRay = 2;        ///< nearest hit, surface, material
  static constexpr double kGatherRay = 4;  ///< the same, and the look-up at its end
  static constexpr double kPhoton = 2;     ///< a light path; as much again for each photon that it leaves
  static constexpr double kPoint = 90;     ///< an irradiance point: density estimates and light samples
  static constexpr double kRecordLookUp = 3, kCausticLookUp = 9;
};

/// Work and variance of one sample. Variances are in the unit of a picture file, which stores about the root of
/// radiance: each variance is divided by the square of the error that its pixel may have (allowed_error at pixel
/// error 1). A sample counts at most as much as makes its pixel white. Frames take more samples in noisy parts, so a
/// variance here is the square of the mean root over 16 x 9 parts of the picture: n samples per pixel leave variance
/// / n.
struct SampleEffort {
  double work = 0;                              ///< shadow rays
  double all = 0, without_caustic = 0;          ///< variance of all light, and of all but layer caustic
  double other = 0, other_without_caustic = 0;  ///< variance of all light but layer indirect, likewise
  /// Light of layers caustic and indirect that one sample of a place alone brings, as far as it is above white. It
  /// shows in lone white pixels, and all other pixels lack it. A share of the picture's light: the root of a squared
  /// error.
  double lost_caustic = 0, lost_indirect = 0;
};

/// Light that photons show and paths miss with certainty.
struct MissedLight {
  double square = 0;    ///< squared error of never finding it
  double variance = 0;  ///< at least: variance of one path that might find the light
};

/// Light that the visible surfaces scatter, and the work and error of each way to find it. Values that were not
/// measured are lower bounds: a way that is too costly even so need not be measured.
struct RoughFrame {
  bool gathered = false, recorded = false;  ///< are gathering and records measured?
  int places = 0;                           ///< number of visible places with a Lambert lobe
  double radiance = 0;                      ///< mean of the picture by paths [W/m^2/sr]
  /// All light but layer indirect. wanted: the mean squared error that the wish allows, at least pixel_error^2.
  /// wanted_of: the variance of one sample.
  double wanted = 0, wanted_of = 0;
  double samples = 0;  ///< mean number of samples per pixel
  SampleEffort path;   ///< whole paths
  /// Paths that end at irradiance points. The variances of all light but layer indirect hold for frames with records,
  /// too.
  SampleEffort gather;
  double record_sample = 0;  ///< shadow rays of a sample that reads a record
  /// records: the number of records that the picture needs. record_ray: the work of one gather ray and the rays that
  /// continue it, in shadow rays. record_error: the squared error of the interpolated light with one gather ray per
  /// record; n rays divide it by n.
  double records = 0, record_ray = 0, record_error = 0;
  MissedLight missed, missed_caustic;  ///< of layers indirect and caustic
  double map_error = 0;                ///< squared error of the caustic light that a density of photons estimates
  double hidden = 0;                   ///< share of the picture that surely no path finds (hidden_share)
  /// Share of the picture that is indirect light which too few samples of paths meet to tell it from none; else 0
  double unsure = 0;
  double photons_per_path = 0;
  std::uint64_t paths_of_light = 0;  ///< light paths of the photon map; more if few of them leave photons
};

struct RoughOptions {
  std::string kinds;  ///< kinds of photons, as for PhotonOptions::set_kinds: "caustic,indirect"
  double pixel_error = 0.016;
  std::uint64_t photons = 700'000;       ///< light paths of the map if enough of them leave photons
  std::span<const AimSphere> seen = {};  ///< spheres in which points lie; empty: everywhere
  std::uint64_t seed = 0;
  int places = kPilotPlaces;  ///< number of measured places of the picture
  /// Called before gathering and before records are measured, with the frame so far. True: the frame is returned as
  /// it is, without the rest. Empty: everything is measured.
  std::function<bool(const RoughFrame&)> enough = {};
  const Lights* without_extent = nullptr;  ///< the lights of hidden_share(); null: none hides light
};

/// Takes four samples at each place, by paths and by the points of 32768 light paths, and gathers records at 64
/// places. Takes .1 to .2 s in all. `aimed`: lights that aim photons where the camera looks. Same result for any
/// number of threads.
RoughFrame rough_frame(const RenderScene& scene, const Lights& aimed, const CameraView& view,
                       const RoughOptions& options);

}  // namespace tempolux
