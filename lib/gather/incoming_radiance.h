// lib/gather/incoming_radiance.h -- what gather rays bring: the light of kind indirect that arrives along them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// near_hits: went on though a point stood for them, as it was near or its indirect light not that of the hit;
/// unanswered: went on as none did.
struct GatherCounts {
  std::uint64_t rays = 0, distance_rays = 0, near_hits = 0, shadow_rays = 0, points_read = 0, unanswered = 0;
  GatherCounts& operator+=(const GatherCounts& o) {
    rays += o.rays;
    distance_rays += o.distance_rays;
    near_hits += o.near_hits;
    shadow_rays += o.shadow_rays;
    points_read += o.points_read;
    unanswered += o.unanswered;
    return *this;
  }
};

/// What the radiance along a ray follows from, for whoever keeps it.
struct RadianceSource {
  /// The irradiance point that stands for the first hit, if it has a Lambert lobe and one does; of a hit near by, from
  /// which a ray goes on, too: the choice must not depend on the light (docs/methods/temporal.md).
  std::uint32_t point = kNone;
  bool partial = false;  ///< there is more to the radiance than that point's light times a constant
  bool mover = false;    ///< a surface on the way moves in the segment
};

struct MediumPoint;  // lib/transport/media.h
class BrightPoints;  // lib/gather/bright_points.h

/// Follows rays from places to what they meet. Emission counts nowhere on the way; events S are passed; at the first
/// Lambert lobe the point that stands for the hit is read, or the path goes on where none does or the first hit is
/// near. Media on the way take out and scatter. Thread-safe.
class IncomingRadiance {
 public:
  /// bright: points of which rays bring the low part alone, where they are read first (BrightPoints::left); may be
  /// null.
  IncomingRadiance(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                   float near_factor = PointLookup::kNear, const BrightPoints* bright = nullptr);

  /// Radiance [W/m^2/sr] arriving along rays that counts as indirect at their starts, and the distance to what each
  /// meets first, m (infinity: nothing). keys: random numbers, one for each ray. Fastest if rays that follow one
  /// another leave one place into like directions. All spans are of one length, but for `sources`, which may be empty.
  /// Of rays that start in a medium lamps seen by way of events S count too: no point tells of them there.
  enum class Start : std::uint8_t { surface, medium };
  void operator()(std::span<const Ray> rays, std::span<const std::uint64_t> keys, std::span<Rgb> radiance,
                  std::span<float> distance, GatherCounts& counts, std::span<RadianceSource> sources = {},
                  Start start = Start::surface) const;
  /// The lobes of the surface at a place, seen along its normal.
  Bsdf bsdf_at(const SurfacePoint& place, Vec3 normal) const;

 private:
  struct Met;
  struct Further;
  struct Gathered;
  void meet(Vec3 wo, float distance, Met& met) const;
  template <class Take, class Key, class TakeMedium, class Miss>
  void follow(std::span<const Ray> rays, bool alike, GatherCounts& counts, const Take& take, const Key& key,
              const TakeMedium& take_medium, const Miss& miss) const;
  Rgb scattered_in_media(const MediumPoint& at, const Further& from, const Gathered& to) const;
  Rgb reflected(const Met& met, const PointLookup::Light* point, const Further& from, int depth,
                const Gathered& to) const;
  Rgb reflected_beyond(const SurfacePoint& start, Vec3 travel, float distance, Further from, int depth,
                       const Gathered& to, const MaterialValues* inside) const;
  Rgb scattered(const Met& met, const PointLookup::Light* point, const Further& from, Rgb scale,
                const PathRandom& random, int depth, const Gathered& to) const;
  static float threshold(const PathRandom& random);
  Rgb beside_edge(const Met& met, const PointLookup::Light& light, bool low, const PathRandom& random,
                  GatherCounts& counts) const;
  Rgb sampled_light(const Met& met, const struct SeenSide& side, const PointLookup::Light* point, bool low,
                    const PathRandom& random, GatherCounts& counts) const;

  const Tracer& tracer_;
  const Lights& lights_;
  const PointLookup& points_;
  float near_factor_;
  const BrightPoints* bright_;
  std::vector<std::array<Bsdf, 2>> bsdfs_;  ///< by material: seen from behind, from in front
};

}  // namespace tempolux
