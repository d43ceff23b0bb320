// lib/render/known_light.h -- light that is known at surfaces, so that camera paths may end there.
#pragma once

#include <optional>

#include "lib/gather/bright_points.h"
#include "lib/gather/final_gather.h"
#include "lib/gather/place_records.h"
#include "lib/render/camera_view.h"
#include "lib/render/photon_light.h"

namespace tempolux {

/// Mirrors in a row that a look follows. Dark mirrors leave nothing to see: 16 of albedo .6 leave 3e-4 of the light.
inline constexpr int kMostMirrors = 16;

class LocalisedLight;
class MeshLight;

/// Irradiance [W/m^2] from records, points and photons. A member may be null: camera paths then find that light
/// themselves. All members must outlive this object. Thread-safe.
class KnownLight {
 public:
  const RecordStore* records = nullptr;  ///< indirect light at the first Lambert lobe of a camera path
  const MeshLight* mesh = nullptr;       ///< replaces records: a light texture of kind indirect
  bool mesh_has_caustic = false;  ///< the light texture holds kind caustic, too; both kinds then count as indirect
  const LocalisedLight* localised = nullptr;  ///< replaces records: static records and the changes by movers
  const PointLookup* points = nullptr;        ///< light of all kinds at the hits of rays that start at a Lambert lobe
  /// Caustic light; also indirect light if the map holds this kind and there are no records.
  const PhotonLight* photons = nullptr;
  /// The bright points among `points`; places without a record sample them explicitly. Rays from such a place
  /// contribute the remaining light.
  const BrightPoints* bright = nullptr;
  /// The light of lamps close to surfaces that `records` leave out (GatherOptions::lamps_apart); null: they hold all
  /// light. Where records are read, these spots are sampled as often as lamps are.
  const BrightPoints* lamp_spots = nullptr;
  int bright_samples = 4;  ///< explicit samples at the first such place of a camera path; later places take one each
  /// Can a ray meet a light, that is, is there an environment or an emitting surface? If not, and indirect and caustic
  /// light are known at a place, no ray is sent from its Lambert lobe: the ray would find nothing.
  bool lights_are_met = true;
  /// Do camera paths fork at the first surface with two lobes (a Lambert lobe under gloss, or the reflection and the
  /// transmission of smooth glass), to follow both? Gloss and glass usually reflect 4 %: without a fork one path in 25
  /// follows the reflection. A bright hit of this path makes a bright dot, and before a bright sky a dark one. If no
  /// light is known, both branches are whole paths, and a fork costs as much as it gains.
  bool forks() const { return records || mesh || localised || points || (photons && photons->has_indirect()); }

  /// Indirect irradiance [W/m^2] at the first Lambert lobe of a camera path. Both normals are unit vectors on the
  /// side that is seen. Empty where no record is valid: a gather ray must then estimate the light. `noise` also
  /// receives the noise of the records (RecordStore::Interpolated::noise); it stays as it is where no records are read.
  std::optional<Rgb> indirect(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, Rgb* noise = nullptr) const;
  /// Is noise of light known, that is, may indirect() or caustic() report some?
  bool has_noise() const { return records || localised || photons; }
  bool has_caustic() const { return photons || (mesh && mesh_has_caustic); }
  /// Caustic light; call only if has_caustic(). 0 if indirect() includes caustic light.
  FootprintLight caustic(Vec3 position, const LitSurface& surface) const {
    return photons ? photons->caustic(position, surface) : FootprintLight{};
  }
  /// Irradiance that a point stores for a hit.
  struct PointLight {
    Rgb irradiance{0.0f};
    /// True if the irradiance includes direct light. False where the border of a shadow runs: paths sample it there.
    bool has_direct = true;
  };
  /// Irradiance at a hit `distance` m from the last Lambert lobe of the path. Empty if no point represents the hit, if
  /// the point's indirect light is not that of the hit, or if the hit is close (PointLookup::is_near with `u` in [0,
  /// 1)).
  std::optional<PointLight> point_light(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const;
  /// Share of the light from the hit's Lambert lobe that was not sampled explicitly at the place where the path comes
  /// from. 1 if the hit is so close that the path continues for its light. `u` as for point_light().
  float remaining_share(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const;
};

/// The first surface with a Lambert lobe that a raster position sees. At mirrors and glass the ray follows the likelier
/// of reflection and transmission, or draws one with Look::random.
std::optional<SeenPoint> seen_through(const Tracer& tracer, const CameraView& view, const Look& look);

}  // namespace tempolux
