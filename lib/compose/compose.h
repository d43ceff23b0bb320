// lib/compose/compose.h -- what a camera sees of media: slices of scattered light along each ray.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/compose/fluence_volume.h"
#include "lib/compose/phase_share.h"
#include "lib/gather/incoming_radiance.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/volume/medium.h"
#include "lib/volume/vdb_write.h"

namespace tempolux {

/// Light in the media of a frame: fluence as it counts towards one eye.
///
/// For a phase function that is even all around one volume serves all views. Otherwise each photon counts by 4 pi times
/// its phase function from its direction to the eye's, so that the same filter and look-up give what is scattered
/// there; one volume for each g that differs. Where the phase function has a peak rays from the eye bring what lies in
/// it (PhaseShare).
class MediaLight {
 public:
  struct Options {
    double cell = 0;  ///< m; 0: the finest voxel's edge
    FluenceFilter filter;
    bool direct = false;  ///< count photons straight from lamps too
    int rays = 0;         ///< of a pixel, sent on by the phase function: PhaseShare
  };
  MediaLight(const Media& media, const MajorantGrid& majorants, Vec3 eye, double emitted_flux, const Options& options);
  /// Photons of a block, positions plus `offset` = scene space; those of other kinds are passed over. `times` -1 takes
  /// them away.
  void add(const formats::PhotonBlock& block, Vec3 offset, int times = 1);
  /// Filters what was added; before scattered().
  void finish();
  /// Source: light scattered towards the eye per length, [W/m^3/sr]: sum over media of sigma_s fluence / 4 pi; the
  /// photons' share.
  Rgb scattered(Vec3 point) const;
  /// scattered() over extinction at the centres of the volume's cells, world space = scene space + `origin`: radiance
  /// that the smoke there would send towards the eye if it were opaque (source function) [W/m^2/sr]; black where there
  /// is none. After finish().
  ColourGrid source(Vec3d origin) const;
  const PhaseShare& share(float g) const;
  /// Does any medium's light come by rays in part?
  bool has_rays() const;
  const std::vector<FluenceSums>& sums() const { return sums_; }
  const FluenceVolume& volume() const { return volumes_.front(); }

 private:
  const Media& media_;
  Vec3 eye_;
  Options options_;
  std::vector<float> gs_;           ///< that differ
  std::vector<PhaseShare> shares_;  ///< by g
  std::vector<std::size_t> g_of_;   ///< by medium: index into gs_
  std::vector<FluenceSums> sums_;   ///< by g
  std::vector<FluenceVolume> volumes_;
};

struct ComposeOptions {
  int samples = 4;        ///< rays per pixel
  int light_samples = 2;  ///< places on a ray from which the lamps are sampled, where direct light is, and rays sent on
  bool sample_lights = true;
  bool surfaces_by_depth = false;  ///< rays end at the frame's depths, not at the scene's surfaces
  /// What rays bring that smoke with a peaked phase function sends on; needed where MediaLight::has_rays.
  const IncomingRadiance* incoming = nullptr;
  std::uint64_t seed = 0;
  std::function<void(double)> progress;  ///< may be empty
};

/// A pixel's smoke.
struct SmokePixel {
  Rgb light{0.0f};  ///< radiance scattered towards the eye on the way to what is seen [W/m^2/sr]
  float left = 1;   ///< share of the light from behind that comes through, mean over the pixel
};

/// All pixels, top row first. `depth`: the frame's Z channel (distance along the view axis), read only with
/// surfaces_by_depth. The same for any number of threads. Slices are half a voxel long; each scatters by -expm1(-tau) /
/// tau of its source over its length and takes exp(-tau) of what lies behind (docs/methods/formulas.md). Direct light:
/// places drawn in proportion to what they scatter towards the eye, and there a sample of the lamps, with what the
/// media leave of it.
std::vector<SmokePixel> compose_media(const RenderScene& scene, const CameraView& view, const MediaLight& light,
                                      const std::vector<float>& depth, const ComposeOptions& options,
                                      RayCounts& counts);

}  // namespace tempolux
