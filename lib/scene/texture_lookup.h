// lib/scene/texture_lookup.h -- textures read at a point of a surface: coordinates, level, emission, coverage.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/image/texture_pyramid.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// A point of a triangle as textures see it. Everything it was made of must outlive it.
///
/// The level of a texture is that at which one texel is as large as the footprint: log2(width sqrt(texels per m^2)),
/// with the texels per area of the triangle (one number for both directions: where a texture is stretched, or seen
/// at a slant, that is sharper along one direction and smoother along the other than it might be).
class TextureSpot {
 public:
  /// u, v: barycentrics of corners 1 and 2; width [m]: of what looks at the point, 0: the finest level.
  TextureSpot(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v, float width)
      : frame_(frame),
        surface_(frame.surfaces[surface]),
        corners_(surface_.primitive->triangles[triangle]),
        u_(u),
        v_(v),
        width_(width) {}

  /// Linear value at the point; the texture must have an image. A primitive without the coordinates that the
  /// texture asks for shows the corner (0, 0).
  Rgba read(const Texture& texture, TextureTransfer transfer) const;

  /// Colour of the primitive's vertices there; 1 if it has none.
  Rgba vertex_color() const;

  /// `normal` (unit) bent by a normal map of glTF 2.0: x along the image's rightwards axis, y along its upwards axis,
  /// both across `normal`, times scale; at least 3 degrees above the triangle's plane. The axes are the primitive's
  /// tangents, else the directions of the texture coordinates in the triangle; `normal` itself where those have none.
  /// `geometric`: the triangle's, on the same side.
  Vec3 bend(const Texture& normal_map, float scale, Vec3 normal, Vec3 geometric) const;

 private:
  using Corners = std::array<Vec2, 3>;
  float level(const Corners& corners, const TexturePyramid& pyramid) const;
  Vec3 edge(int corner) const;
  /// Unit axes of a normal map across `normal`; false where there are none.
  bool axes_of_tangents(Vec3 normal, Vec3& right, Vec3& up) const;
  bool axes_of_coordinates(const Texture& normal_map, Vec3 normal, Vec3& right, Vec3& up) const;

  const SceneFrame& frame_;
  const Surface& surface_;
  const std::array<std::uint32_t, 3>& corners_;
  float u_, v_, width_;
};

/// Texture coordinates of a set; empty if the primitive has none.
const std::vector<Vec2>& texture_coordinates(const Primitive& primitive, std::uint32_t uv_set);

/// Where a texture's image is read at the corners of a triangle: coordinates of its set, transformed.
std::array<Vec2, 3> corner_coordinates(const Primitive& primitive, const std::array<std::uint32_t, 3>& triangle,
                                       const Texture& texture);

/// Does the material's emission, or whether it is there, depend on where?
bool emission_varies(const Material& material);
/// Radiance that the material emits at a point [glTF nits].
Rgb emission_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v, float width);

/// Share of rays that meet the surface at a point, by the finest level of the texture and the vertices' colour: 1 for
/// opaque materials, alpha for BLEND, 1 or 0 for MASK.
float coverage_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v);
/// The same of a material that lets rays pass, where the alpha of its texture times that of the vertices is `texel` (1:
/// none).
inline float coverage(const Material& material, float texel) {
  const float alpha = material.alpha * texel;
  if (material.alpha_mode == Material::Alpha::mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
  return alpha;
}
/// Can a ray pass a surface of this material?
bool lets_rays_pass(const Material& material);
/// How its base colour's texture is to be read.
TextureTransfer base_color_transfer(const Material& material);

/// Mean over a triangle of emission times coverage, as a share of the material's emission (1 where neither varies): 0
/// only if it is 0 everywhere, at least 0.01 elsewhere (so that nothing that emits is chosen too rarely). The triangle
/// is cut into as many like it as are about a texel large, 4 to 64, each read in its middle, over its size. Depends on
/// neither the material's emission nor the shape of the surface.
Rgb mean_emission_share(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle);

}  // namespace tempolux
