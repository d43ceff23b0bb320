// lib/render/matte_ends.h -- light at the matte ends of eye paths, of which the large lights' is controlled (LightControl).
#pragma once

#include <span>

#include "lib/render/path_tracer.h"
#include "lib/render/shading.h"

namespace tempolux {

/// A matte end of an eye path, where lights are sampled.
struct MatteEnd {
  SurfacePoint surface;
  Vec3 normal, normal_geometric;   ///< on the side seen
  Rgb reflected;                   ///< of irradiance, to the eye [1/sr]
  Layer layer;                     ///< direct or specular
  std::uint32_t first, count;      ///< samples' numbers: the light is the mean over them
  std::uint32_t bounce;
  Rgb light;                       ///< is set: radiance to the eye
  LightControl control;            ///< is added to

  /// Is wi on the lit side of both normals?
  bool sees(Vec3 wi) const { return dot(wi, normal_geometric) > 0 && dot(wi, normal) > 0; }
};

/// Samples large lights and the others apart, at all ends together: at most kPathsTogether. random: of the pixel.
void sample_controlled_lights(const RenderScene& scene, std::span<MatteEnd> ends, const PixelRandom& random, RayCounts& counts);

}  // namespace tempolux
