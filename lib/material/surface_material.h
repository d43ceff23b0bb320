// lib/material/surface_material.h -- what a material is at a hit: its factors times its textures there.
#pragma once

#include <optional>

#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Width of what a ray stands for, for choosing the level of textures: it grows by `spread` metres per metre.
///
/// A camera ray starts with a pixel's angle and keeps it through mirrors and smooth glass (curved ones are not
/// accounted for). After any other scattering, and from lights, a ray stands for a cone of kBounceSpread, which a Lambert
/// lobe begins anew: it spares the finest levels of what is far away. Coarse levels keep the mean of an image, but not of
/// the charts in it that a surface shows: beside them may be anything, which a wide cone mixes in. With a tenth the ground
/// about a fox got 4.5 % less light from it than without textures' levels, with this 0.2 %.
struct RayCone {
  float width = 0, spread = 0;   ///< m; m/m
  void advance(float distance) { width += spread * distance; }
};
inline constexpr float kBounceSpread = 0.02f;

/// The material at a hit. A material without textures is its factors: that costs one test.
class SurfaceMaterial {
 public:
  /// Bends point.normal by the normal map if there is one. width [m]: RayCone. `point` is of `frame`.
  SurfaceMaterial(const SceneFrame& frame, SurfacePoint& point, float width)
      : values_(&frame.materials[point.material]) {
    if (frame.materials[point.material].textures) [[unlikely]] read_textures(frame, point, width);
  }
  SurfaceMaterial(const SurfaceMaterial&) = delete;
  SurfaceMaterial& operator=(const SurfaceMaterial&) = delete;

  operator const MaterialValues&() const { return *values_; }
  const MaterialValues& values() const { return *values_; }

 private:
  void read_textures(const SceneFrame& frame, SurfacePoint& point, float width);

  const MaterialValues* values_;
  std::optional<MaterialValues> textured_;
};

/// Has the material a Lambert lobe somewhere on a surface (Bsdf::has_lambert), whatever its textures say?
bool may_have_lambert(const Material& material);

/// Which lobes reflect (or, of S, let through) anything, by factors and whatever textures may make of them.
struct Lobes {
  bool lambert = false, specular = false;
  Lobes& operator|=(const Lobes& other) { return lambert |= other.lambert, specular |= other.specular, *this; }
};
Lobes lobes_of(const Material& material);
/// Of all surfaces that have triangles. Without S lobes there is no caustic light, without Lambert lobes no indirect.
Lobes lobes_of(const SceneFrame& frame);

}  // namespace tempolux
