// lib/compose/compose.h -- composites media over a frame: slices of scattered light along each ray.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/compose/fluence_volume.h"
#include "lib/compose/phase_share.h"
#include "lib/gather/incoming_radiance.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/volume/medium.h"

namespace tempolux {

/// The fluence of photons in the media of a frame, weighted for one position of the eye.
/// For an isotropic phase function the weight is 1. For any other phase function the weight of a photon is 4 pi times
/// the phase function for scattering from the photon's direction to the eye. There is one volume for each different g.
/// Light in the peak of a phase function is left to rays (PhaseShare).
class MediaLight {
 public:
  struct Options {
    double cell = 0;         ///< m; 0: the edge of the finest voxel
    float filter_width = 0;  ///< cells: standard deviation of the Gaussian; 0: so that 256 photons count
    bool direct = false;     ///< true if photons directly from lights count, too
    int rays = 0;            ///< rays per pixel whose directions are drawn from the phase function (PhaseShare)
  };
  MediaLight(const Media& media, const MajorantGrid& majorants, Vec3 eye, double emitted_flux, const Options& options);
  /// Adds the volume photons of a block; positions plus `offset` are in scene space. With `times` -1 the photons are
  /// subtracted.
  void add(const formats::PhotonBlock& block, Vec3 offset, int times = 1);
  /// Filters the sums. Call before scattered().
  void finish();
  /// Radiance per length that scattering adds towards the eye [W/m^3/sr]: the sum over the media of sigma_s fluence /
  /// (4 pi), of the light that photons estimate.
  Rgb scattered(Vec3 point) const;
  /// How the light of media with this g is divided between photons and rays; g must be that of a medium of the frame.
  const PhaseShare& share(float g) const;
  /// True if rays estimate a share of any medium's light.
  bool has_rays() const;
  const std::vector<FluenceSums>& sums() const { return sums_; }
  const FluenceVolume& volume() const { return volumes_.front(); }

 private:
  const Media& media_;
  Vec3 eye_;
  Options options_;
  std::vector<float> gs_;           ///< the different values of g
  std::vector<PhaseShare> shares_;  ///< by g
  std::vector<std::size_t> g_of_;   ///< by medium: index into gs_
  std::vector<FluenceSums> sums_;   ///< by g
  std::vector<FluenceVolume> volumes_;
};

/// The position of the eye for MediaLight. For an orthographic camera it is so far outside the scene's `bounds` that
/// all directions to it are parallel.
Vec3 eye_for_phase(const CameraView& view, const Box3& bounds);

struct ComposeOptions {
  int samples = 4;                 ///< rays per pixel
  int light_samples = 2;           ///< places per ray at which direct light is sampled, and from which rays start
  bool sample_lights = true;       ///< false: photons give direct light
  bool surfaces_by_depth = false;  ///< rays end at the frame's depths instead of the scene's surfaces
  /// Radiance of the rays in the peak of a phase function; needed if MediaLight::has_rays.
  const IncomingRadiance* incoming = nullptr;
  std::uint64_t seed = 0;
  std::function<void(double)> progress;  ///< may be empty
};

/// Smoke in front of a pixel.
struct SmokePixel {
  Rgb light{0.0f};          ///< radiance scattered towards the eye in front of the surface [W/m^2/sr]
  float transmittance = 1;  ///< mean over the pixel
};

/// Smoke of all pixels, top row first; the same for any number of threads. `depth`: the frame's channel Z (distance
/// along the view axis), read only with surfaces_by_depth. Slices are half a voxel long. A slice scatters its source
/// times its length times -expm1(-tau) / tau, and multiplies the light behind it by exp(-tau)
/// (docs/methods/formulas.md). Direct light is sampled at places drawn along the ray in proportion to the light they
/// scatter towards the eye. Each place samples one light; the media attenuate its shadow ray.
std::vector<SmokePixel> compose_media(const RenderScene& scene, const CameraView& view, const MediaLight& light,
                                      const std::vector<float>& depth, const ComposeOptions& options,
                                      RayCounts& counts);

}  // namespace tempolux
