// lib/material/surface_material.h -- the material at a hit: its factors times its textures.
#pragma once

#include <optional>

#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// The width of a ray, which decides the level of textures. The width grows by `spread` metres per metre.
///
/// A camera ray starts with the angle of a pixel and keeps this angle through events S; curved mirrors and gloss do not
/// widen it. After an event D, and for rays from lights, the width is 0 and the finest level is read. Coarser levels
/// would be wrong there for three reasons. They keep the mean of an image, but light does not depend linearly on
/// roughness, normal or metalness. They include parts of an image that the surface does not use. And a cone depends on
/// the end at which a path starts, so photons and camera paths would meet different surfaces.
struct RayCone {
  float width = 0, spread = 0;                                  ///< m; m/m
  void advance(float distance) { width += spread * distance; }  ///< m
};

/// The material at a hit: its factors times its textures there. Without textures, the factors are used without a copy.
class SurfaceMaterial {
 public:
  /// `point` is a hit of `frame`; if the material has a normal map, point.normal becomes the map's normal. `width` [m]
  /// is that of a RayCone; 0 reads the finest level. wavelength_nm: HeroWavelength::nm of the path; glass with
  /// dispersion gets its index at this wavelength.
  SurfaceMaterial(const SceneFrame& frame, SurfacePoint& point, float width = 0, float wavelength_nm = 0)
      : values_(&frame.materials[point.material]) {
    if (frame.materials[point.material].textures) [[unlikely]]
      read_textures(frame, point, width);
    if (wavelength_nm > 0) [[unlikely]]
      disperse(wavelength_nm);
  }
  SurfaceMaterial(const SurfaceMaterial&) = delete;
  SurfaceMaterial& operator=(const SurfaceMaterial&) = delete;

  operator const MaterialValues&() const { return *values_; }
  const MaterialValues& values() const { return *values_; }

 private:
  void read_textures(const SceneFrame& frame, SurfacePoint& point, float width);
  void disperse(float wavelength_nm);

  const MaterialValues* values_;
  std::optional<MaterialValues> textured_;
};

/// True if the material has a Lambert lobe (Bsdf::has_lambert) at some values of its textures.
bool may_have_lambert(const Material& material);

/// Which lobes reflect or transmit light at some values of the textures.
struct Lobes {
  bool lambert = false, specular = false;
  Lobes& operator|=(const Lobes& other) { return lambert |= other.lambert, specular |= other.specular, *this; }
};
Lobes lobes_of(const Material& material);
/// The lobes of all surfaces with triangles. Without S lobes there is no caustic light, without Lambert lobes no
/// indirect light.
Lobes lobes_of(const SceneFrame& frame);

}  // namespace tempolux
