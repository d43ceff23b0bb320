// lib/gather/incoming_radiance.h -- estimates the indirect light that arrives along gather rays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct GatherCounts {
  std::uint64_t rays = 0;           ///< gather rays and rays that continue them
  std::uint64_t distance_rays = 0;  ///< rays of FinalGather::distance()
  std::uint64_t shadow_rays = 0, points_read = 0;
  /// Rays that continued from a hit although a point represents it: the hit is close, or indirect light around the
  /// point is not uniform.
  std::uint64_t near_hits = 0;
  std::uint64_t unanswered = 0;  ///< rays that continued because no point represents the hit
  /// Sums over the records that were gathered twice: variance, and square of their noise (place_records.h).
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

/// The origin of the radiance along a ray, for callers that keep the radiance.
struct RadianceSource {
  /// The irradiance point that represents the ray's first hit; kNone if no point does, or if the hit has no Lambert
  /// lobe. If the first hit is close and the ray continues to a second point, `point` is still the point of the first
  /// hit: the choice between the two must not depend on their light (docs/methods/temporal.md).
  std::uint32_t point = kNone;
  bool partial = false;  ///< true if the radiance is not the light of this point times a constant
  bool mover = false;    ///< true if the path meets a surface that moves in the segment, or a medium
  Rgb noise{0.0f};       ///< W/m^2/sr: the part of the radiance's noise that comes from IrradiancePoint::noise
};

struct MediumPoint;  // lib/transport/media.h
class BrightPoints;  // lib/gather/bright_points.h

/// Follows gather rays. Emission that they meet does not count. Events S are followed. At the first Lambert lobe the
/// point that represents the hit is read; if no point represents it or the first hit is close, the path continues.
/// Media attenuate and scatter. Thread-safe.
class IncomingRadiance {
 public:
  /// bright: points whose high part is sampled explicitly, so that rays contribute the remaining share; may be null.
  /// All arguments must outlive this object.
  IncomingRadiance(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                   const BrightPoints* bright = nullptr);

  enum class Start : std::uint8_t { surface, medium };
  /// Computes the radiance [W/m^2/sr] that arrives along rays and counts as indirect light at their starts, and the
  /// distance to each ray's first hit [m] (infinity: none). keys: one random key per ray. Fastest if successive rays
  /// start at one place in similar directions. All spans have the same length, except that `sources` may be empty. If
  /// rays start in a medium, lights seen by events S count, too, because no point holds their light.
  void operator()(std::span<const Ray> rays, std::span<const std::uint64_t> keys, std::span<Rgb> radiance,
                  std::span<float> distance, GatherCounts& counts, std::span<RadianceSource> sources = {},
                  Start start = Start::surface) const;
  /// The Bsdf at a place, seen along its normal.
  Bsdf bsdf_at(const SurfacePoint& place, Vec3 normal) const;

 private:
  struct Met;
  struct Further;
  struct Gathered;
  void meet(Vec3 wo, float leg, float before, std::uint64_t key, Met& met) const;
  void look_at(Vec3 wo, Met& met) const;
  void draw_side(std::uint64_t key, SurfacePoint& smooth, Met& met) const;
  float remaining_share(const Met& met, const PointLookup::Light* point, const Further& from) const;
  template <class Take, class Key, class TakeMedium, class Miss>
  void follow(std::span<const Ray> rays, GatherCounts& counts, const Take& take, const Key& key,
              const TakeMedium& take_medium, const Miss& miss) const;
  Rgb scattered_in_media(const MediumPoint& at, const Further& from, const Gathered& to) const;
  Rgb reflected(const Met& met, const PointLookup::Light* point, const Further& from, int depth,
                const Gathered& to) const;
  Rgb reflected_on_side(const Met& met, const PointLookup::Light* point, const Further& from, int depth,
                        const Gathered& to) const;
  Rgb radiance_after_specular(const SurfacePoint& start, Vec3 travel, float distance, Further from, int depth,
                              const Gathered& to) const;
  Rgb scattered(const Met& met, const PointLookup::Light* point, const Further& from, Rgb scale, int depth,
                const Gathered& to) const;
  Rgb reflected_specular(const Met& met, const struct SeenSide& side, const Further& from, int depth,
                         const Gathered& to) const;
  Rgb sampled_light(const Met& met, const struct SeenSide& side, const PointLookup::Light* point, float sampled_lobe,
                    const PathRandom& random, GatherCounts& counts) const;

  const Tracer& tracer_;
  const Lights& lights_;
  const PointLookup& points_;
  const BrightPoints* bright_;
  std::vector<std::array<Bsdf, 2>> bsdfs_;  ///< by material: seen from the back, from the front
};

}  // namespace tempolux
