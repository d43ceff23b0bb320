// lib/pilot/rough_frame.h -- measures work and error of each way to a frame's light on a few thousand samples.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lib/audit/audit.h"
#include "lib/light/aim.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/pilot/missed_light.h"
#include "lib/pilot/places_seen.h"

namespace tempolux {

/// Costs of the steps of rendering. The unit of work is the CPU time of one shadow ray with its light sample and
/// shading: .4 to 1.3 us, depending on the scene. Decisions count steps in this unit, so they do not depend on the
/// speed or the load of a machine. The look-up of a record costs one unit, and so does a gather ray of a record with
/// the look-up at its end. Measured in 18 scenes (docs/methods/ways.md, tests/bench/ways.py).
struct Work {
  /// A nearest hit with surface and material, of a camera path or of a light path with the photon that it leaves; also
  /// the look-up of a point.
  static constexpr double kRay = 0.6;
  static constexpr double kCausticLookUp = 2;
  static constexpr double kPoint = 27;    ///< an irradiance point: density estimates and light samples
  static constexpr double kRecord = 150;  ///< a record without its rays: its place, and a look around
  /// A photon of a map that a picture reads: its index, and slower look-ups of points and pixels. In furnished_day 1.7
  /// million further photons cost each picture 4 CPU s.
  static constexpr double kPhotonRead = 2;
};

/// Work and variance of one sample. Each variance is divided by the square of the error that its pixel may have
/// (allowed_error at pixel error 1), because a picture file stores about the root of radiance. A sample counts at most
/// as much as makes its pixel white. The variance of the picture follows from its 16 x 9 parts: it is the square of the
/// mean of the roots of their variances, because frames take more samples in noisy parts. n samples per pixel leave the
/// squared error variance / n.
struct SampleEffort {
  double work = 0;                                  ///< shadow rays
  double all = 0, without_caustic = 0;              ///< variance of all light, and of all but layer caustic
  double other = 0, other_without_caustic = 0;      ///< the same without layer indirect
  MissedLight missed_caustic{}, missed_indirect{};  ///< light of these layers that the samples miss
};

/// Caustic light in a part of the picture (pilot_part).
struct CausticPart {
  /// Square of the part's mean light over the square of the picture's mean light, divided by the number of parts. The
  /// sum over all parts is a mean over the picture.
  double square = 0;
  double seen_square = 0;  ///< the same, but over the square of the error that the part may have (SampleEffort)
  double photons = 0;  ///< mean number of photons that a light path leaves and the camera sees (SeenPhotons::photons)
};

/// Work and error of each way to light in a small number of samples. Values that were not measured are lower bounds. If
/// even its bounds make a way too costly, the way need not be measured.
struct RoughFrame {
  bool gathered = false, recorded = false;  ///< are gathering and records measured?
  int places = 0;                           ///< number of visible places with a Lambert lobe
  double radiance = 0;                      ///< mean of the picture by paths [W/m^2/sr]
  /// For all light but layer indirect: the mean squared error that the wish allows, at least pixel_error^2, and the
  /// variance of one sample.
  double wanted = 0, wanted_of = 0;
  double samples = 0;  ///< mean number of samples per pixel
  SampleEffort path;   ///< of whole paths
  /// Effort of paths that end at irradiance points. The variances without layer indirect also hold for frames with
  /// records.
  SampleEffort gather;
  double record_sample = 0;  ///< shadow rays of a sample that reads a record
  double records = 0;        ///< number of records that the picture needs
  double record_ray = 0;     ///< shadow rays of one gather ray of a record and of its continuation
  double record_error = 0;  ///< squared error of interpolated light at one gather ray per record; n rays divide it by n
  std::vector<CausticPart> caustic{};  ///< light that a density of photons estimates, by part of the picture
  double photons_per_path = 0;         ///< mean number of photons that a light path leaves
  std::uint64_t paths_of_light = 0;    ///< light paths of the photon map (photon_paths)
};

struct RoughOptions {
  std::string kinds;                     ///< kinds of photons, as for PhotonOptions::set_kinds: "caustic,indirect"
  double pixel_error = 0.016;            ///< FrameOptions::pixel_error
  std::uint64_t photons = 700'000;       ///< usual number of light paths of the map (photon_paths)
  std::span<const AimSphere> seen = {};  ///< spheres in which points lie; empty: everywhere
  std::uint64_t seed = 0;
  int places = kPilotPlaces;  ///< number of measured places of the picture
  /// Called with the frame so far before gathering is measured, and again before records are. If it returns true, the
  /// frame is returned as it is. Empty: everything is measured.
  std::function<bool(const RoughFrame&)> enough = {};
  const Lights* without_extent = nullptr;  ///< the lights of hidden_share(); null: none hides light
  double least_hidden = kAuditLimit;       ///< hidden_share(): `least`
};

/// Takes four samples at each place by whole paths and four by paths that end at the points of kPilotPaths light paths,
/// and gathers records at 64 places. Takes .1 to .2 s in all. `aimed`: lights that aim photons where the camera looks.
/// Same result for any number of threads.
RoughFrame rough_frame(const RenderScene& scene, const Lights& aimed, const CameraView& view,
                       const RoughOptions& options);

}  // namespace tempolux
