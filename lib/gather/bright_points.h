// lib/gather/bright_points.h -- bright irradiance points, sampled explicitly as lights are (docs/methods/split.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/gather/incoming_radiance.h"
#include "lib/points/lamp_light.h"
#include "lib/irradcache/points.h"
#include "lib/irradcache/records.h"
#include "lib/light/light_tree.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct BrightOptions {
  std::uint64_t seed = 0;
  int light_samples = 16;  ///< shadow rays of a site at a point whose direct light is not uniform
  /// Photons of lamps that are close to surfaces (lamp_light.h). The points that represent the photons' places must be
  /// marked (PointLookup::note_lamp); note_lamps_beside() marks them.
  std::span<const LampPhoton> beside_lamps = {};
};

/// Light of bright points that arrives at a place.
struct BrightLight {
  Rgbd irradiance{0.0};                                ///< W/m^2
  std::array<Vec3d, 3> rotational{}, translational{};  ///< as in IrradianceRecord
};

/// Divides the light L(y) that a surface reflects at y towards x into an explicit part and a remaining part. h is the
/// share of the high part (photonmap-split) in the light of the irradiance point that represents y, and l = |x - y|:
///
///     explicit part   h w(l) L(y),   w(l) = 1 if l > 4 R, else 0
///     remaining part  (1 - h w(l)) L(y), see remaining_share()
///
/// R = spacing / sqrt(pi) is the radius of a disc with the area of one point. The explicit part is sampled like a
/// light; gather rays that meet y contribute the remaining part. Both use the same point and the same l, so they add up
/// to L(y) for any h and w. If a ray meets y so close that it continues (IncomingRadiance), it contributes all of L(y);
/// so the explicit part is weighted by the probability that a ray does not continue.
///
/// The explicit part is an integral over surfaces of h w L cos cos / l^2. It is sampled at sites: places that are
/// uniform by area, 16 for each point, each with the light of the point that represents the place. The sites of a point
/// form a spot. Spots are drawn as lights are (LightTree).
///
/// Direct light of lamps close to surfaces is divided likewise, because it makes spots smaller than points resolve
/// (lamp_light.h). Let d = |z - y| be the distance from a place z on a lamp to y. If d is below kBesideLamp spacings,
/// the light from z is explicit if l > 4 d. Gather rays sample direct light at y if the point that represents y is
/// marked or no point represents y; they then leave out explicit light. Sites are photons from the lamps, so they are
/// as dense as the light, however small its spot.
///
/// Light that glossy lobes reflect is divided likewise, with l times the width of the lobe in place of l (lobe_width).
/// Thread-safe.
class BrightPoints {
 public:
  /// high_shares: h in [0, 1] of each point of `points`. If the indirect light around a point is not uniform
  /// (PointLookup::is_uniform_indirect), its share becomes 0. All arguments must outlive this object.
  BrightPoints(const Tracer& tracer, const Lights& lights, const PointLookup& points, std::vector<float> high_shares,
               const BrightOptions& options);

  std::size_t spot_count() const { return sites_of_.size(); }
  std::size_t site_count() const { return sites_.size(); }

  /// The share that gather rays contribute of the light at a hit that `point` represents. `distance` [m]: l, times the
  /// lobe's width.
  float remaining_share(const PointLookup::Light& point, float distance) const {
    return is_explicit(distance, radius_) ? 1 - high_[point.point] : 1.0f;
  }
  /// True if the direct light of a lamp at a hit is explicit, so that gather rays leave it out. `distance` as for
  /// remaining_share(); `lamp_distance` [m]: from the lamp to the hit; `point`: represents the hit, or nullptr.
  bool has_lamp_light(const PointLookup::Light* point, float distance, float lamp_distance) const {
    return (!point || point->beside_lamp) && lamp_distance < lamp_reach_ && is_explicit(distance, lamp_distance);
  }

  /// sqrt(1 / (pi p)), at most 1, where p [1/sr] is the pdf of wi in the lobes S: the width of these lobes around wi,
  /// in units of the width of a Lambert lobe around its normal. 0 for mirrors and glass. Rays of a narrow lobe that
  /// points at a spot meet the spot often, so explicit samples begin at a distance that is larger by the factor 1 /
  /// width.
  static float lobe_width(const Bsdf& bsdf, Vec3 wi, const Bsdf::Direction& wo) {
    return width_of(bsdf.gloss_density(wi, wo));
  }
  /// The same from p.
  static float width_of(float pdf_solid_angle) { return std::min(1.0f, 1 / std::sqrt(kPi * pdf_solid_angle)); }

  /// A place that receives light of bright points.
  struct Receiver {
    const SurfacePoint& place;
    Vec3 normal;  ///< unit, on the lit side
    /// The Bsdf of the place if its lobes weight light by direction (Bsdf::arrival_weight); else null.
    const Bsdf* coat = nullptr;
    bool reads_close = false;  ///< true if rays from here also read the points of close hits, and do not continue
    /// Unit, away from the surface. If given, the result is the radiance [W/m^2/sr] that the lobes S of `coat` reflect
    /// in this direction, in place of an irradiance, and has no gradients.
    std::optional<Vec3> seen_from = {};
    /// In [0, 1): a number of a low-discrepancy sequence, which chooses the site of a single sample. By default
    /// `random` chooses.
    std::optional<float> choice = {};
    bool lamps = true;  ///< false: only light of points, without light of lamps close to surfaces
  };
  /// An estimate of the explicit light that arrives at the place: the mean over `samples` samples. Adds the shadow rays
  /// to `counts`.
  BrightLight arriving(const Receiver& at, int samples, const PathRandom& random, GatherCounts& counts) const;

  /// A sample of the light of lamps close to surfaces that arrives at a place, before any division.
  struct LampSpot {
    Vec3 wi{};                              ///< unit, from the place to the spot
    float distance = 0, lamp_distance = 0;  ///< m: l, and d of the lamp
    /// Irradiance [W/m^2] of a surface that faces the spot, over the density of the sample: light from the spot's
    /// Lambert lobe, and from its lobes S but mirrors.
    Rgb matte{0.0f}, glossy{0.0f};
    float gloss_width = 0;  ///< lobe_width() of the lobes S
    Ray shadow;             ///< shadow ray: transmittance() along it is the share of the light that arrives
  };
  /// Draws a spot for a place by `choice` in [0, 1). normal: unit, on the lit side. Empty if no light can arrive; the
  /// sample then counts as 0.
  std::optional<LampSpot> lamp_spot(const SurfacePoint& place, Vec3 normal, float choice) const;

 private:
  struct Site {
    SurfacePoint place;
    Vec3 normal;           ///< geometric, on the lit side
    Rgb irradiance{0.0f};  ///< W/m^2: the high part
    Bsdf bsdf;
    float radius;             ///< m: radius of the density estimate of its point
    float area;               ///< m^2; 1 for a photon, whose `irradiance` is its flux [W]
    std::uint32_t spot;       ///< index of its point; above the points: number of a cell of photons without a point
    float lamp_distance = 0;  ///< m: distance of the photon's lamp; 0: the site belongs to a point with a high part
    Rgb arriving{0.0f};       ///< W: LampPhoton::arriving
    Vec3 wi{};                ///< LampPhoton::wi
  };
  struct Sites {
    std::uint32_t first, count;
  };
  std::optional<Site> site_at(const IrradiancePoint& place, float area) const;
  void sample_uneven(const Lights& lights, const std::vector<std::uint32_t>& uneven, const BrightOptions& options);
  static bool is_explicit(float distance, float radius);
  float share(const Site& site, float distance, bool reads_close) const;
  void place_high(const Lights& lights, const BrightOptions& options);
  void place_lamp_light(std::span<const LampPhoton> photons);
  void gather_spots();
  Rgb radiance(const Site& site, Vec3 wo) const;

  const Tracer& tracer_;
  const PointLookup& points_;
  std::vector<float> high_;      ///< h, by point
  float radius_, lamp_reach_;    ///< m: R; kBesideLamp spacings
  std::vector<Site> sites_;      ///< sites of one spot follow each other
  std::vector<Sites> sites_of_;  ///< by spot; spots of bright points come before spots of lamps
  std::size_t point_spots_ = 0;
  std::optional<LightTree> tree_, point_tree_;  ///< over all spots; over the spots of bright points
};

/// Distance [m] up to which a lamp beside a surface makes a spot for most of the records: the median distance of a
/// lamp, drawn as light samples are, over the 4 of the division (BrightPoints). 0 if no record has a lamp.
float reach_of_spots(const Lights& lights, std::span<const IrradianceRecord> records);

/// Adds the light and its gradients to a record of gather rays.
void add_bright_light(const BrightLight& light, IrradianceRecord& record);

}  // namespace tempolux
