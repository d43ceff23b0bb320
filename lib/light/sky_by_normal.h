// lib/light/sky_by_normal.h -- samples directions of the sky by radiance times the cosine at a surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/light/environment_light.h"

namespace tempolux {

/// EnvironmentLight draws directions by radiance alone: half of them may lie below a surface's horizon, and the horizon
/// is often the brightest part of a sky. This class cuts the square of the two numbers that draw a direction into
/// kAcross x kDown parts, which have equal shares of the sky's light. For each of kNormals normals, a part is drawn in
/// proportion to the mean cosine in it. Every part keeps a small probability, so the density is above 0 wherever the
/// map's own density is.
class SkyByNormal {
 public:
  /// The environment must outlive this object. Memory: 1 MiB.
  explicit SkyByNormal(const EnvironmentLight& environment);

  /// Draws a direction for a surface of this unit normal; u1 and u2 as in EnvironmentLight::sample().
  bool sample(Vec3 normal, double u1, double u2, EnvironmentLight::Sample& sample) const;
  /// Density [1/sr] with which sample() gives this direction.
  double pdf_solid_angle(Vec3 normal, Vec3 direction) const {
    return pdf_solid_angle(normal, environment_.place_of(direction), direction);
  }
  double pdf_solid_angle(Vec3 normal, const EnvironmentLight::Place& place, Vec3 direction) const;
  static constexpr std::uint32_t kAcross = 32, kDown = 16, kParts = kAcross * kDown, kSide = 16,
                                 kNormals = kSide * kSide;

 private:
  struct Ends {
    std::array<float, kParts> end;  ///< cumulative probabilities of the parts; the last is 1
    Guide<32> guide;
    std::uint32_t part_for(float u1, Guide<32>::Range parts) const;
  };
  const EnvironmentLight& environment_;
  std::vector<Ends> ends_;  ///< by normal
};

}  // namespace tempolux
