// lib/scene/texture_lookup.h -- reads textures at a point of a surface: coordinates, level, emission, coverage.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/image/texture_pyramid.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Reads textures at a point of a triangle. All constructor arguments must outlive this object.
/// A texture is read at the level whose texels are as large as the footprint: log2(width sqrt(texels per m^2)), with
/// the triangle's mean number of texels per area. One level serves both directions, so a texture that is stretched, or
/// seen at a slant, is too sharp along one direction and too smooth along the other.
class TextureSpot {
 public:
  /// u and v are the barycentric coordinates of corners 1 and 2. `width` [m] is the width of the footprint; 0 reads the
  /// finest level.
  TextureSpot(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v, float width)
      : frame_(frame),
        surface_(frame.surfaces[surface]),
        corners_(surface_.primitive->triangles[triangle]),
        u_(u),
        v_(v),
        width_(width) {}

  /// Linear value at the point; the texture must have an image. A primitive without the texture's set of coordinates
  /// reads it at (0, 0).
  Rgba read(const Texture& texture, TextureTransfer transfer) const;

  /// Interpolated vertex colour; 1 if the primitive has none.
  Rgba vertex_color() const;

  /// The shading normal (unit) that a normal map of glTF 2.0 makes of `normal` (unit): the map's x along the image's
  /// axis to the right, y along its upward axis, both perpendicular to `normal` and multiplied by `scale`, and z along
  /// `normal`. The result is at least 3 degrees above the triangle's plane, on the side of `geometric`, the triangle's
  /// unit normal. The axes come from the primitive's tangents, or else from the texture coordinates of the triangle;
  /// without either the result is `normal`.
  Vec3 bend(const Texture& normal_map, float scale, Vec3 normal, Vec3 geometric) const;

  /// The axes of a map along tangents at `normal` (unit), as bend() has them: unit, perpendicular to `normal`. False if
  /// there are none.
  bool axes(const Texture& map, Vec3 normal, Vec3& right, Vec3& up) const {
    return axes_of_tangents(normal, right, up) || axes_of_coordinates(map, normal, right, up);
  }

 private:
  using Corners = std::array<Vec2, 3>;
  float level(const Corners& corners, const TexturePyramid& pyramid) const;
  Vec3 edge(int corner) const;
  /// Unit axes of a normal map perpendicular to `normal`; false if there are none.
  bool axes_of_tangents(Vec3 normal, Vec3& right, Vec3& up) const;
  bool axes_of_coordinates(const Texture& normal_map, Vec3 normal, Vec3& right, Vec3& up) const;

  const SceneFrame& frame_;
  const Surface& surface_;
  const std::array<std::uint32_t, 3>& corners_;
  float u_, v_, width_;
};

/// Texture coordinates of a set; empty if the primitive has none.
const std::vector<Vec2>& texture_coordinates(const Primitive& primitive, std::uint32_t uv_set);

/// Texture coordinates at the corners of a triangle, from the texture's set and with the texture's transform.
std::array<Vec2, 3> corner_coordinates(const Primitive& primitive, const std::array<std::uint32_t, 3>& triangle,
                                       const Texture& texture);

/// True if the material's emission or coverage varies over a surface.
bool emission_varies(const Material& material);
/// Radiance [W/m^2/sr] that the material emits at a point, whose barycentric coordinates of corners 1 and 2 are u and
/// v. The texture is averaged over `width` m; 0 reads its finest level.
Rgb emission_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v, float width);

/// Share of rays that hit the surface at a point, from the finest level of the texture and the vertex colours: 1 for
/// opaque materials, alpha for BLEND, 1 or 0 for MASK.
float coverage_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v);
/// Share of rays that hit a surface of a BLEND or MASK material; `texel` is the texture's alpha times the vertex
/// colour's, 1 without them.
inline float coverage(const Material& material, float texel) {
  const float alpha = material.alpha * texel;
  if (material.alpha_mode == Material::Alpha::mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
  return alpha;
}
/// True if a ray can pass through a surface of this material.
bool lets_rays_pass(const Material& material);
/// True if light may go straight through the surface at some values of the textures (Bsdf::passed_straight).
inline bool may_be_pane(const Material& material) {
  return material.transmission > 0 && material.thin_walled && !material.unlit;
}
/// True if solids of the material may be plates (lib/trace/plates.h): smooth, clear or coloured glass that transmits
/// all light that it does not reflect, without a normal map.
inline bool may_be_plate(const Material& m) {
  const bool smooth = m.roughness < kMirrorRoughness && m.metallic == 0 && !m.unlit && !m.emissive(),
             varies = m.textures && (m.textures->normal || m.textures->transmission);
  return m.transmission == 1 && !m.thin_walled && m.ior >= 1 && smooth && !varies &&
         m.alpha_mode == Material::Alpha::opaque;
}
/// How the texture of the base colour is decoded.
TextureTransfer base_color_transfer(const Material& material);

/// A part of a triangle that is similar to the triangle. Its corners have the barycentric coordinates `corner`,
/// `corner` + (size, 0) and `corner` + (0, size); a negative size turns the part by half a turn.
struct TrianglePart {
  Vec2 corner{0, 0};
  float size = 1;

  /// Barycentric coordinates in the triangle of a point that has the coordinates (b1, b2) in the part.
  Vec2 at(double b1, double b2) const { return {float(corner.x + size * b1), float(corner.y + size * b2)}; }
};

/// Mean over a part of a triangle of emission times coverage, as a share of the material's emission; 1 if neither
/// varies. A whole triangle is cut into 4 to 64 similar pieces of about a texel, a smaller part into at least 4 pieces.
/// The textures are read at the centre of each piece; the value of emission is averaged over the piece. If the texture
/// of emission is black everywhere on the part, the result is 0. Otherwise the result is at least 0.01 `whole`, so that
/// no emitting part is sampled too rarely. `whole`: for a smaller part, the result of its whole triangle. The result
/// depends neither on the material's emission nor on the surface's shape.
Rgb mean_emission_share(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle,
                        const TrianglePart& part = {}, Rgb whole = Rgb(1.0f));
/// Texels of the textures that make emission or coverage vary, along the longer side of the triangle's bounding
/// rectangle in the texture; 0 if there is none.
float emission_texels(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle);

}  // namespace tempolux
