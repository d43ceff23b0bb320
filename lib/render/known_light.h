// lib/render/known_light.h -- light that is known at surfaces, so that eye paths may end there.
#pragma once

#include <optional>

#include "lib/gather/bright_points.h"
#include "lib/gather/final_gather.h"
#include "lib/gather/place_records.h"
#include "lib/render/camera_view.h"
#include "lib/render/photon_light.h"

namespace tempolux {

class LocalisedLight;
class MeshLight;

/// Irradiance [W/m^2] told by records, points and photons. Each part may be missing: the path then finds that light
/// itself. All must outlive it. Thread-safe.
class KnownLight {
 public:
  const RecordStore* records = nullptr;       ///< kind indirect where the eye looks
  const MeshLight* mesh = nullptr;            ///< in place of records: a light texture of kind indirect
  bool mesh_has_caustic = false;              ///< and of kind caustic: all of it counts as indirect then
  const LocalisedLight* localised = nullptr;  ///< in place of records: of what stands, and of what movers change
  const PointLookup* points = nullptr;        ///< all kinds where a ray from a matte surface ends
  const PhotonLight* photons = nullptr;       ///< kind caustic; indirect, too, if it has it and there are no records
  /// Of `points` those that are sampled explicitly where no record tells: what paths meet first beyond then brings the
  /// rest.
  const BrightPoints* bright = nullptr;
  int bright_samples = 0;  ///< at the first such place of an eye path; one at each later one
  /// Can a ray meet a light: is there an environment, or a surface that emits? Where not, and indirect and caustic
  /// light are known at a place, no ray goes on from its Lambert lobe: the ray would find nothing.
  bool lights_are_met = true;
  /// Do eye paths fork at the first Lambert lobe under a gloss, to follow both? A gloss reflects 4 % as a rule: one ray
  /// in 25 that meets something bright makes a dot. Where nothing is known both would be whole paths: a fork costs as
  /// much as it gains then.
  bool forks() const { return records || mesh || localised || points || (photons && photons->has_indirect()); }

  /// Irradiance of kind indirect at the first Lambert lobe of an eye path; both normals are unit and on the side seen.
  /// None where no record counts: a ray of the hemisphere is to find it.
  std::optional<Rgb> indirect(const SurfacePoint& surface, Vec3 geometric, Vec3 shading) const;
  bool has_caustic() const { return photons || (mesh && mesh_has_caustic); }
  /// Irradiance of kind caustic; only if has_caustic(). 0 where indirect() has it.
  Rgb caustic(Vec3 position, const LitSurface& surface) const {
    return photons ? photons->caustic(position, surface) : Rgb(0.0f);
  }
  /// What a point tells of the light at a hit.
  struct Told {
    Rgb irradiance{0.0f};
    bool direct =
        true;  ///< of all kinds; else of all but direct: where the border of a shadow runs paths sample that themselves
  };
  /// At a hit `distance` m along the way from the last Lambert lobe; none where no point stands for the hit, the
  /// point's indirect light is not that of the hit, or the hit is near (PointLookup::is_near).
  std::optional<Told> told(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const;
  /// Share of the light scattered by the Lambert lobe at the hit that is not sampled explicitly where the path comes
  /// from; 1 where it is so near that the path goes on for its light. The same u as told().
  float left(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const;
};

/// What a raster position sees: the first surface with a Lambert lobe, through mirrors and glass by the
/// likelier of reflection and transmission, or by one drawn from Look::random.
std::optional<SeenPoint> seen_through(const Tracer& tracer, const CameraView& view, const Look& look);

}  // namespace tempolux
