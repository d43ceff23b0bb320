// lib/material/surface_material.h -- what a material is at a hit: its factors times its textures there.
#pragma once

#include <optional>

#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Width of what a ray stands for, for choosing the level of textures: it grows by `spread` metres per metre.
///
/// A camera ray starts with a pixel's angle and keeps it through events S (curved mirrors, and what gloss spreads, are
/// not accounted for). After an event D, and from lights, there is none: the finest level is read. Coarse levels keep
/// the mean of an image, but light goes neither by the mean roughness, normal or metalness nor by what an image has
/// beside the chart that a surface shows, and a cone depends on which end a path is begun from: what photons met of a
/// lamp far away would be another surface than what eyes meet of a wall near by. Cones of a fiftieth cost a fox's
/// ground 0.2 % of its light, and made caustics of AlphaBlendModeTest's bed 3 % brighter by photons than by paths.
struct RayCone {
  float width = 0, spread = 0;  ///< m; m/m
  void advance(float distance) { width += spread * distance; }
};

/// The material at a hit. A material without textures is its factors: that costs one test.
class SurfaceMaterial {
 public:
  /// Bends point.normal by the normal map if there is one. width [m]: RayCone; 0: none. `point` is of `frame`.
  SurfaceMaterial(const SceneFrame& frame, SurfacePoint& point, float width = 0)
      : values_(&frame.materials[point.material]) {
    if (frame.materials[point.material].textures) [[unlikely]]
      read_textures(frame, point, width);
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
