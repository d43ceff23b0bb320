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
#include "lib/gather/lamp_light.h"
#include "lib/irradcache/points.h"
#include "lib/irradcache/records.h"
#include "lib/light/light_tree.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct BrightOptions {
  std::uint64_t seed = 0;
  int light_samples = 16;  ///< shadow rays of a site at a point whose direct light varies around it
  /// Photons of lamps close to surfaces; their points are marked (PointLookup::note_lamp)
  std::span<const LampPhoton> beside_lamps = {};
};

/// Light from bright points that arrives at a place.
struct BrightLight {
  Rgbd irradiance{0.0};                                ///< W/m^2
  std::array<Vec3d, 3> rotational{}, translational{};  ///< as in IrradianceRecord
};

/// Divides the light L(y) that a surface reflects at y towards x into an explicit part and a remaining part. h is the
/// share of the high part (photonmap-split) in the light of the irradiance point that represents y, and l = |x - y|:
///
///     explicit part   h w(l) L(y),   w(l) = t^2 (3 - 2 t),  t = (l - 4 R) / (2 R) clamped to [0, 1]
///     remaining part  (1 - h w(l)) L(y), see remaining_share()
///
/// R = spacing / sqrt(pi) is the radius of a disc with the area of one point; from l = 4 R on, 1/l^2 is bounded. The
/// explicit part is sampled like a light; gather rays that meet y contribute the remaining part. Both use the same
/// point and the same l, so they add up to L(y), for any h and w. A ray that meets y so close that it continues
/// (IncomingRadiance) contributes all of L(y); the explicit part is then weighed with the probability that a ray does
/// not continue.
///
/// The explicit part is an integral over surfaces of h w L cos cos / l^2. It is sampled at sites: places that are
/// uniform by area, 16 for each point, each with the light of the point that represents it. The sites of a point form a
/// spot. Spots are drawn as lights are (LightTree).
///
/// Direct light of lamps close to surfaces is treated likewise, because it makes spots smaller than points resolve
/// (lamp_light.h). Let d = |z - y| be the distance from a place z on a lamp to y. If d is below kBesideLamp spacings,
/// the share w with R = d is explicit, which is above 0 from l = 4 d on. If the point that represents y is marked, or
/// no point represents y, gather rays sample direct light at y and contribute 1 - w of it. Sites are photons from the
/// lamps, so they are as dense as the light, however small its spot. Glossy lobes are treated likewise, with l times
/// their width in place of l (lobe_width). Thread-safe.
class BrightPoints {
 public:
  /// high_shares: h_p in [0, 1] by point of `points`. Points whose indirect light is not that of their surroundings
  /// (PointLookup::is_uniform_indirect) get the share 0. All arguments must outlive this object.
  BrightPoints(const Tracer& tracer, const Lights& lights, const PointLookup& points, std::vector<float> high_shares,
               const BrightOptions& options);

  std::size_t spot_count() const { return sites_of_.size(); }
  std::size_t site_count() const { return sites_.size(); }

  /// The share that gather rays contribute of the light at a hit `distance` m away, which `point` represents.
  float remaining_share(const PointLookup::Light& point, float distance) const {
    const float high = high_[point.point];
    return high > 0 ? 1 - high * explicit_share(distance) : 1.0f;
  }
  /// w at this distance [m].
  float explicit_share(float distance) const;
  /// The share that gather rays contribute of the direct light of a lamp: the rays meet a place y after `distance` m,
  /// and the lamp is `lamp_distance` m from y. `point` represents y, or is nullptr if no point does. 1 if the point is
  /// not marked as close to a lamp.
  float remaining_lamp_share(const PointLookup::Light* point, float distance, float lamp_distance) const {
    return (!point || point->beside_lamp) && lamp_distance < lamp_reach_ ? 1 - lamp_share(distance, lamp_distance)
                                                                         : 1.0f;
  }

  /// sqrt(1 / (pi p)), at most 1, where p [1/sr] is the density of wi in the lobes S: the width of these lobes around
  /// wi in units of the width of a Lambert lobe around its normal. 0 for mirrors and glass. Rays of a narrow lobe that
  /// sees a spot meet it often, so the spot's light is sampled explicitly from a distance that is larger by 1 / width.
  static float lobe_width(const Bsdf& bsdf, Vec3 wi, const Bsdf::Direction& wo) {
    return std::min(1.0f, 1 / std::sqrt(kPi * bsdf.gloss_density(wi, wo)));
  }

  /// A place that receives light of bright points.
  struct Receiver {
    const SurfacePoint& place;
    Vec3 normal;  ///< unit, on the lit side
    /// The Bsdf of the place, if its lobes weight light by direction (Bsdf::arrival_weight); else null.
    const Bsdf* coat = nullptr;
    bool reads_close = false;  ///< rays from here read the points of close hits, too, and do not continue
    /// Unit. If given, the light is the radiance [W/m^2/sr] that the lobes S of `coat` reflect this way, in place of an
    /// irradiance, and has no gradients.
    std::optional<Vec3> seen_from = {};
    /// In [0, 1): chooses the site of a single sample, from a sequence that fills the interval evenly. By default
    /// `random` chooses.
    std::optional<float> choice = {};
    bool lamps = true;  ///< false: light of points alone, without that of lamps close to surfaces
  };
  /// The mean over `samples` explicit samples of the light that arrives at the place. Adds the shadow rays to `counts`.
  BrightLight arriving(const Receiver& at, int samples, const PathRandom& random, GatherCounts& counts) const;

 private:
  struct Site {
    SurfacePoint place;
    Vec3 normal;           ///< geometric, on the lit side
    Rgb irradiance{0.0f};  ///< W/m^2: the high part
    Bsdf bsdf;
    float radius;             ///< m: radius of the density estimate of its point
    float area;               ///< m^2; 1 for a photon, whose flux is irradiance x area
    std::uint32_t spot;       ///< index of its point, or above all points that of a cell of photons
    float lamp_distance = 0;  ///< m: distance of the photon's lamp; 0: the light is a point's
  };
  struct Sites {
    std::uint32_t first, count;
  };
  std::optional<Site> site_at(const IrradiancePoint& place, float area) const;
  void sample_uneven(const Lights& lights, const std::vector<std::uint32_t>& uneven, const BrightOptions& options);
  float share(const Site& site, float distance, bool reads_close) const;
  static float lamp_share(float distance, float lamp_distance);
  void place_high(const Lights& lights, const BrightOptions& options);
  void place_lamp_light(std::span<const LampPhoton> photons);
  void gather_spots();
  Rgb radiance(const Site& site, Vec3 wo) const;

  const Tracer& tracer_;
  const PointLookup& points_;
  std::vector<float> high_;
  float radius_, lamp_reach_;
  std::vector<Site> sites_;      ///< sites of one spot lie side by side
  std::vector<Sites> sites_of_;  ///< by spot; spots of points come before those of lamps
  std::size_t point_spots_ = 0;
  std::optional<LightTree> tree_, point_tree_;  ///< over all spots, and over those of points
};

/// Adds the light and its gradients to a record that holds the light of gather rays.
void add_bright_light(const BrightLight& light, IrradianceRecord& record);

}  // namespace tempolux
