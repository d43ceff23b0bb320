// lib/light/sky_by_normal.h -- directions of the sky as a surface sees it: by radiance and by the cosine.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/light/environment_light.h"

namespace tempolux {

/// EnvironmentLight draws directions by radiance alone: half of them may be below a surface, most of a bright sky at
/// its horizon. Here the square of the numbers that draw a direction is cut into kAcross x kDown parts, which have
/// equal shares of the sky's light, and for each of kNormals directions that a surface may face a part is drawn by the
/// mean cosine in it. Every part keeps a little: the density is above 0 wherever the map's own is.
class SkyByNormal {
 public:
  /// environment must outlive it. Memory: 1 MiB.
  explicit SkyByNormal(const EnvironmentLight& environment);

  /// A direction for a surface of this unit normal; u1, u2 as EnvironmentLight::sample().
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
    std::array<float, kParts> end;  ///< cumulative; the last is 1
    Guide<32> guide;
    std::uint32_t part_for(float u1, Guide<32>::Range parts) const;
  };
  const EnvironmentLight& environment_;
  std::vector<Ends> ends_;  ///< by normal
};

}  // namespace tempolux
