// lib/gather/bright_points.h -- bright irradiance points, looked at on purpose as lamps are (docs/methods/split.md).
#pragma once

#include <array>
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
  int light_samples = 16;  ///< shadow rays of a site where a point's direct light is not that of the places near it
  std::span<const LampPhoton> beside_lamps =
      {};  ///< of lamps beside surfaces; their points are noted (PointLookup::note_lamp)
};

/// Light from bright points that arrives at a place.
struct BrightLight {
  Rgbd irradiance{0.0};                                ///< W/m^2
  std::array<Vec3d, 3> rotational{}, translational{};  ///< as IrradianceRecord's
};

/// Light L(y) that surfaces send out is divided in two: of the light of irradiance point p a share h_p is the high part
/// (photonmap-split), and of that the share
///
///     w(l) = t^2 (3 - 2 t),  t = (l - 4 R) / (2 R) cut to [0, 1],  R = spacing / sqrt(pi)
///
/// is sampled explicitly at a place x at the distance l = |x - y|; R is the radius of the disc that a point stands for.
/// Rays that meet y bring the rest, left() x L(y). Both use the point that stands for y and the distance to y: it is a
/// partition at each y, whatever h and w are, and the sum is what rays bring without it. From 4 R on 1/l^2 is bounded.
/// Rays that meet y so near that they go on (IncomingRadiance) bring all of it: the explicit part counts with the
/// probability that they do not.
///
/// The explicit part is an integral over surfaces, of h w L cos cos / l^2. It is sampled at sites: places uniform by
/// area, 16 for each point, each with the light of the point that stands for it. The sites of a point are a spot; spots
/// are drawn as lamps are (LightTree).
///
/// So is direct light of lamps beside surfaces, which light spots smaller than points can hold (lamp_light.h). Of the
/// light of a place z on a lamp that reaches y, d = |z - y| below kBesideLamp spacings, the share w is explicit with d
/// for R: from 4 d on. Where a point beside a lamp stands for y rays sample direct light, as they do where none stands
/// for it, and bring 1 - w of such samples. Sites are photons from the lamps: as dense as the light, however small its
/// spot. Thread-safe.
class BrightPoints {
 public:
  /// high_shares: h_p by point of `points`, in [0, 1]; points whose indirect light is not that of their neighbours
  /// (PointLookup::is_uniform_indirect) get none. All must outlive it.
  BrightPoints(const Tracer& tracer, const Lights& lights, const PointLookup& points, std::vector<float> high_shares,
               const BrightOptions& options);

  std::size_t spot_count() const { return sites_of_.size(); }
  std::size_t site_count() const { return sites_.size(); }

  /// Share of the light of what stands at `distance` m, for which the point stands, that rays bring.
  float left(const PointLookup::Light& point, float distance) const {
    const float high = high_[point.point];
    return high > 0 ? 1 - high * explicit_share(distance) : 1.0f;
  }
  /// w.
  float explicit_share(float distance) const;
  /// Share of the direct light of a lamp `lamp_distance` m from a place y that rays bring which meet y at `distance` m.
  /// 1 where the point that stands for y is not beside a lamp; nullptr: none stands for y.
  float left_of_lamp(const PointLookup::Light* point, float distance, float lamp_distance) const {
    return (!point || point->beside_lamp) && lamp_distance < lamp_reach_ ? 1 - lamp_share(distance, lamp_distance)
                                                                         : 1.0f;
  }

  /// A place that looks at bright points.
  struct Receiver {
    const SurfacePoint& place;
    Vec3 normal;  ///< unit, on the lit side
    const Bsdf* coat =
        nullptr;  ///< the lobes there, if they weigh light by the angle it arrives at (Bsdf::arrival_weight)
    bool reads_near = false;  ///< rays from here read the points of near hits, too, and do not go on
  };
  /// What `samples` explicit samples bring there. Counts shadow rays.
  BrightLight arriving(const Receiver& at, int samples, const PathRandom& random, GatherCounts& counts) const;

 private:
  struct Site {
    SurfacePoint place;
    Vec3 normal;           ///< geometric, on the lit side
    Rgb irradiance{0.0f};  ///< W/m^2: the high part
    Bsdf bsdf;
    float radius;             ///< m: of the estimate behind its point
    float area;               ///< m^2; of a photon 1, as its flux stands for irradiance x area
    std::uint32_t spot;       ///< its point, or beyond all points that of a cell of photons
    float lamp_distance = 0;  ///< m: of a lamp's photon; 0: light of the point
  };
  struct Sites {
    std::uint32_t first, count;
  };
  std::optional<Site> site_at(const IrradiancePoint& place, float area) const;
  void sample_uneven(const Lights& lights, const std::vector<std::uint32_t>& uneven, const BrightOptions& options);
  float share(const Site& site, float distance, bool reads_near) const;
  static float lamp_share(float distance, float lamp_distance);
  void place_high(const Lights& lights, const BrightOptions& options);
  void place_lamp_light(std::span<const LampPhoton> photons);
  void gather_spots();
  Rgb radiance(const Site& site, Vec3 wo) const;

  const Tracer& tracer_;
  const PointLookup& points_;
  std::vector<float> high_;
  float radius_, lamp_reach_;
  std::vector<Site> sites_;        ///< those of one spot side by side
  std::vector<Sites> sites_of_;    ///< by spot
  std::optional<LightTree> tree_;  ///< spots
};

/// Adds it and its gradients to a record of rays alone.
void add_bright_light(const BrightLight& light, IrradianceRecord& record);

}  // namespace tempolux
