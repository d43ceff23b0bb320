// lib/gather/incoming_radiance.h -- estimates the indirect light that arrives along gather rays.
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

/// near_hits: rays that continued although a point represents the hit, because the hit is close or the point's indirect
/// light is not that of the hit. unanswered: rays that continued because no point represents the hit.
struct GatherCounts {
  std::uint64_t rays = 0, distance_rays = 0, near_hits = 0, shadow_rays = 0, points_read = 0, unanswered = 0;
  /// Records that were gathered twice: their variance, and the mean square of their noise (place_records.h).
  double twice_variance = 0, twice_noise = 0;
  GatherCounts& operator+=(const GatherCounts& o) {
    rays += o.rays;
    distance_rays += o.distance_rays;
    near_hits += o.near_hits;
    shadow_rays += o.shadow_rays;
    points_read += o.points_read;
    unanswered += o.unanswered;
    twice_variance += o.twice_variance;
    twice_noise += o.twice_noise;
    return *this;
  }
};

/// What the radiance along a ray was computed from, for callers that store it.
struct RadianceSource {
  /// The irradiance point that represents the ray's first hit. kNone if no point does, or the hit has no Lambert lobe.
  /// If the first hit is close, the ray continues to a second point. `point` is the first hit's even then, because the
  /// choice between the two must not depend on their light (docs/methods/temporal.md).
  std::uint32_t point = kNone;
  bool partial = false;  ///< the radiance is more than this point's light times a constant
  bool mover = false;    ///< the path meets a surface that moves in the segment
  Rgb noise{0.0f};       ///< W/m^2/sr: noise that the radiance has from IrradiancePoint::noise
};

struct MediumPoint;  // lib/transport/media.h
class BrightPoints;  // lib/gather/bright_points.h

/// Follows gather rays to their hits. Emission on the way does not count. Events S are followed. At the first Lambert
/// lobe the point that represents the hit is read; if no point does or the first hit is close, the path continues.
/// Media on the way attenuate and scatter. Thread-safe.
class IncomingRadiance {
 public:
  /// bright: points whose high part is sampled explicitly, so that rays contribute the rest
  /// (BrightPoints::remaining_share); may be null.
  IncomingRadiance(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                   const BrightPoints* bright = nullptr);

  /// Computes the radiance [W/m^2/sr] that arrives along rays and counts as indirect light at their starts, and the
  /// distance to each ray's first hit in m (infinity: none). keys: one random key per ray. Fastest if successive rays
  /// leave one place in similar directions. All spans have the same length, except that `sources` may be empty. For
  /// rays that start in a medium, lights seen by events S count, too, because no point holds their light.
  enum class Start : std::uint8_t { surface, medium };
  void operator()(std::span<const Ray> rays, std::span<const std::uint64_t> keys, std::span<Rgb> radiance,
                  std::span<float> distance, GatherCounts& counts, std::span<RadianceSource> sources = {},
                  Start start = Start::surface) const;
  /// The Bsdf at a place, seen along its normal.
  Bsdf bsdf_at(const SurfacePoint& place, Vec3 normal) const;

 private:
  struct Met;
  struct Further;
  struct Gathered;
  void meet(Vec3 wo, float leg, float before, Met& met) const;
  float remaining_share(const Met& met, const PointLookup::Light* point, const Further& from) const;
  template <class Take, class Key, class TakeMedium, class Miss>
  void follow(std::span<const Ray> rays, GatherCounts& counts, const Take& take, const Key& key,
              const TakeMedium& take_medium, const Miss& miss) const;
  Rgb scattered_in_media(const MediumPoint& at, const Further& from, const Gathered& to) const;
  Rgb reflected(const Met& met, const PointLookup::Light* point, const Further& from, int depth,
                const Gathered& to) const;
  Rgb radiance_after_specular(const SurfacePoint& start, Vec3 travel, float distance, Further from, int depth,
                              const Gathered& to, const MaterialValues* inside) const;
  Rgb scattered(const Met& met, const PointLookup::Light* point, const Further& from, Rgb scale,
                const PathRandom& random, int depth, const Gathered& to) const;
  static float threshold(const PathRandom& random);
  Rgb beside_edge(const Met& met, const PointLookup::Light& light, float sampled_lobe, const PathRandom& random,
                  GatherCounts& counts) const;
  Rgb sampled_light(const Met& met, const struct SeenSide& side, const PointLookup::Light* point, float sampled_lobe,
                    const PathRandom& random, GatherCounts& counts) const;

  const Tracer& tracer_;
  const Lights& lights_;
  const PointLookup& points_;
  const BrightPoints* bright_;
  std::vector<std::array<Bsdf, 2>> bsdfs_;  ///< by material: seen from the back, from the front
};

}  // namespace tempolux
