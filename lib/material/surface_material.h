// lib/material/surface_material.h -- the material at a hit: its factors times its textures.
#pragma once

#include <optional>

#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// The width of a ray, which decides the level of textures. The width grows by `spread` metres per metre.
///
/// A camera ray starts with the angle of a pixel and keeps it through events S (the spreading by curved mirrors and
/// gloss is ignored). After an event D, and for rays from lights, the width is 0 and the finest level is read. Coarser
/// levels would be wrong there: they keep the mean of an image, but light does not depend linearly on roughness, normal
/// or metalness, they mix in parts of an image that the surface does not use, and a cone depends on the end at which a
/// path starts, so that photons and camera paths would meet different surfaces. In tests, cones of a fiftieth cost 0.2
/// % of the light on the ground of the scene Fox, and made caustics in AlphaBlendModeTest 3 % brighter by photons than
/// by paths.
struct RayCone {
  float width = 0, spread = 0;  ///< m; m/m
  void advance(float distance) { width += spread * distance; }
};

/// The material at a hit. For a material without textures this is its factors, which costs one test.
class SurfaceMaterial {
 public:
  /// Applies the normal map, if there is one, to point.normal. width [m]: RayCone; 0: the finest level. `point` belongs
  /// to `frame`.
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

/// True if the material can have a Lambert lobe somewhere on a surface (Bsdf::has_lambert), for any texture values.
bool may_have_lambert(const Material& material);

/// Which lobes reflect or transmit any light, by factors and for any texture values.
struct Lobes {
  bool lambert = false, specular = false;
  Lobes& operator|=(const Lobes& other) { return lambert |= other.lambert, specular |= other.specular, *this; }
};
Lobes lobes_of(const Material& material);
/// The lobes of all surfaces with triangles. Without S lobes there is no caustic light, without Lambert lobes no
/// indirect light.
Lobes lobes_of(const SceneFrame& frame);

}  // namespace tempolux
