// lib/pilot/see_photons.h -- estimates the caustic and indirect light that a camera sees, from photons alone.
#pragma once

#include <vector>

#include "formats/photons/photons.h"
#include "lib/density/photon_view.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Radiance [W/m^2/sr] of one kind of light that a camera sees, mean of the channels.
struct SeenPhotons {
  double mean = 0, mean_error = 0;  ///< mean over the picture, and its standard error
  double square = 0;                ///< mean square over the parts of the picture (pilot_part)
  std::vector<double> light;        ///< by part: mean radiance
  /// By part: number of photons seen directly; if their contributions r differ, (sum r)^2 / sum r^2, which is the
  /// number of equal photons with the same relative variance.
  std::vector<double> photons;
};

/// The two kinds of light that paths may miss.
struct SeenLight {
  SeenPhotons caustic, indirect;
};

/// Sums photons of each kind that the camera sees directly; this sum is unbiased. At places that camera rays reach
/// through mirrors and glass, a density estimate of the photons is added. The estimate is at most 20 % too bright in
/// the middle of a wall (docs/methods/caustics.md). Positions are in scene space. Same result for any number of
/// threads.
SeenLight see_photons(const RenderScene& scene, const CameraView& view, const PhotonView& photons);

/// Light of few very bright samples: a lamp without extent lights a narrow lobe, the lobe lights a matte surface, and
/// few camera paths that leave this surface meet the lobe. Returns for each part of the picture (pilot_part) the mean
/// radiance [W/m^2/sr] of the samples that are brighter than `cut`. Each caustic photon that the camera sees represents
/// the camera path that runs back along its direction and takes a light sample where it meets the lobe. There are many
/// photons where there is much light, so they show samples that one path in a million finds. Photons must have
/// directions. Same result for any number of threads.
std::vector<double> lone_light(const RenderScene& scene, const CameraView& view, const PhotonView& photons, double cut);

}  // namespace tempolux
