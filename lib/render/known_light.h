// lib/render/known_light.h -- light that files hold at surfaces, so that camera paths may end there.
#pragma once

#include <optional>

#include "lib/gather/bright_points.h"
#include "lib/gather/final_gather.h"
#include "lib/gather/place_records.h"
#include "lib/light_texture/mesh_light.h"
#include "lib/render/camera_view.h"
#include "lib/render/photon_light.h"

namespace tempolux {

/// Largest number of mirrors and panes of glass that a look follows. After 16 of albedo .6, 3e-4 of the light remains.
inline constexpr int kMostMirrors = 16;

class LocalisedLight;

/// How the indirect light of a camera path's first Lambert lobe is read.
enum class IndirectBy : std::uint8_t {
  paths,      ///< not at all: camera paths find it
  points,     ///< from points at the hits of rays that start at the lobe
  photons,    ///< from photons around the place
  records,    ///< from records around the place
  localised,  ///< from static records and the changes by movers
  texture,    ///< from a light texture
};

/// Irradiance [W/m^2] from records, points and photons. A member may be null; camera paths then find that light
/// themselves. All members must outlive this object. Positions are in scene space. Thread-safe.
class KnownLight {
 public:
  const RecordStore* records = nullptr;  ///< indirect light at the first Lambert lobe of a camera path
  /// Replaces records: a light texture of kind indirect. If it also holds kind caustic, indirect() is the sum of both.
  const MeshLight* mesh = nullptr;
  const LocalisedLight* localised = nullptr;  ///< replaces records: static records and the changes by movers
  const PointLookup* points = nullptr;        ///< light of all kinds at the hits of rays that start at a Lambert lobe
  /// Caustic light; also indirect light, if the map holds this kind and there are no records.
  const PhotonLight* photons = nullptr;
  /// The bright points among `points`. Places without a record sample bright points explicitly, and gather rays from
  /// there contribute the remaining light.
  const BrightPoints* bright = nullptr;
  /// Light of lamps close to surfaces that `records` leave out (GatherOptions::lamps_apart). Places that read records
  /// sample this light explicitly, as often as they sample lamps. null: records hold all light.
  const BrightPoints* lamp_spots = nullptr;
  /// Light of lamps farther away than these, which records hold. Like the light of lamp_spots it is sampled where the
  /// lobes S of the place or of the spot reflect it. null: rays find it.
  const BrightPoints* gloss_spots = nullptr;
  /// True if light is sampled explicitly that comes from a lamp by way of a spot `lamp_distance` m from the lamp. leg
  /// [m]: length of the path from the spot to the place, times the widths of the lobes at both.
  bool samples_spot(float leg, float lamp_distance) const {
    const BrightPoints* const widest = gloss_spots ? gloss_spots : lamp_spots;
    return widest && widest->has_lamp_light(nullptr, leg, lamp_distance);
  }
  int bright_samples = 4;  ///< explicit samples at the first such place of a camera path; later places take one each
  /// True if rays can meet a light: an environment or an emitting surface. If false, and if indirect and caustic light
  /// are known at a place, no ray is sent from the Lambert lobe, because it would find nothing.
  bool lights_are_met = true;
  /// True if camera paths fork at the first surface with two lobes and follow both: a Lambert lobe under gloss, or the
  /// reflection and the transmission of smooth glass. Gloss and glass reflect about 4 %. Without a fork one path in 25
  /// follows the reflection, and its pixel is too bright (or too dark before a bright sky). False without known light:
  /// both branches would be whole paths, and a fork would cost as much as it gains.
  bool forks() const { return indirect_by() != IndirectBy::paths; }
  /// How indirect light is read.
  IndirectBy indirect_by() const {
    return mesh                                 ? IndirectBy::texture
           : localised                          ? IndirectBy::localised
           : records                            ? IndirectBy::records
           : photons && photons->has_indirect() ? IndirectBy::photons
           : points                             ? IndirectBy::points
                                                : IndirectBy::paths;
  }

  /// Indirect irradiance [W/m^2] at the first Lambert lobe of a camera path. Both normals are unit vectors on the
  /// side that is seen. Empty if no record is valid: a gather ray must then estimate the light. `noise` receives the
  /// noise of the records (RecordStore::Interpolated::noise); it does not change if no records are read.
  std::optional<Rgb> indirect(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, Rgb* noise = nullptr) const;
  /// True if indirect() or caustic() may report noise.
  bool has_noise() const { return records || localised || photons; }
  /// True if caustic light is known.
  bool has_caustic() const { return photons || (mesh && mesh->has_caustic()); }
  /// Caustic light [W/m^2]; call only if has_caustic(). 0 if indirect() includes caustic light.
  FootprintLight caustic(Vec3 position, const LitSurface& surface) const {
    return photons ? photons->caustic(position, surface) : FootprintLight{};
  }
  /// Irradiance [W/m^2] of the point that represents a hit.
  struct PointLight {
    Rgb irradiance{0.0f};
    /// True if the irradiance includes direct light. False at the border of a shadow, where paths sample direct light.
    bool has_direct = true;
  };
  /// Light at a hit `distance` m from the last Lambert lobe of the path. geometric: unit normal on the side of the
  /// path. Empty if no point represents the hit, if indirect light differs between the points around it
  /// (PointLookup::is_uniform_indirect), or if the hit is a close hit (PointLookup::is_near with `u` in [0, 1)).
  std::optional<PointLight> point_light(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const;
  /// Share of the light from the hit's Lambert lobe that was not sampled explicitly at the last Lambert lobe of the
  /// path. 1 for a close hit, at which the path continues. Parameters as for point_light().
  float remaining_share(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const;
};

/// The first surface with a Lambert lobe that a raster position sees, also by mirrors and glass (at most kMostMirrors).
/// There the ray follows the likelier of reflection and transmission, or draws one with Look::random. Empty if the ray
/// leaves the scene.
std::optional<SeenPoint> seen_through(const Tracer& tracer, const CameraView& view, const Look& look);

}  // namespace tempolux
