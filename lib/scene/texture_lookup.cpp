#include "lib/scene/texture_lookup.h"

#include <algorithm>
#include <cmath>

#include "lib/image/texture_images.h"

namespace tempolux {
namespace {

/// Sine of the least angle between a bent normal and the triangle's plane.
constexpr float kLeastRise = 0.05f;

float cross2(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
Vec2 minus(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }

}  // namespace

const std::vector<Vec2>& texture_coordinates(const Primitive& primitive, std::uint32_t uv_set) {
  static const std::vector<Vec2> none;
  return uv_set == 0 ? primitive.uvs : uv_set == 1 ? primitive.uvs1 : none;
}

std::array<Vec2, 3> corner_coordinates(const Primitive& primitive, const std::array<std::uint32_t, 3>& triangle,
                                       const Texture& texture) {
  const std::vector<Vec2>& uvs = texture_coordinates(primitive, texture.uv_set);
  const auto& m = texture.transform;
  std::array<Vec2, 3> at;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec2 uv = uvs.empty() ? Vec2{} : uvs[triangle[c]];
    at[c] = {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
  }
  return at;
}

Vec3 TextureSpot::edge(int corner) const {
  return surface_.position(corners_[std::size_t(corner)]) - surface_.position(corners_[0]);
}

float TextureSpot::level(const Corners& corners, const TexturePyramid& pyramid) const {
  if (!(width_ > 0)) return 0;
  const float area = length(cross(edge(1), edge(2)));
  const float texels = std::abs(cross2(minus(corners[1], corners[0]), minus(corners[2], corners[0]))) *
                       float(pyramid.width()) * float(pyramid.height());
  const float ratio = texels / area * width_ * width_;  // number of texels in the footprint
  return ratio > 1 ? 0.5f * std::log2(std::min(ratio, 1e30f)) : 0;
}

Rgba TextureSpot::read(const Texture& texture, TextureTransfer transfer) const {
  const TexturePyramid& pyramid = frame_.images->pyramid(texture.image, transfer);
  const Corners corners = corner_coordinates(*surface_.primitive, corners_, texture);
  const float w = 1 - u_ - v_;
  const Vec2 uv{corners[0].x * w + corners[1].x * u_ + corners[2].x * v_,
                corners[0].y * w + corners[1].y * u_ + corners[2].y * v_};
  return pyramid.read(uv, texture.wrap_u, texture.wrap_v, texture.nearest, level(corners, pyramid));
}

Rgba TextureSpot::vertex_color() const {
  const auto& colors = surface_.primitive->colors;
  if (colors.empty()) return {1, 1, 1, 1};
  Rgba color;
  for (std::size_t c = 0; c < 4; ++c)
    color[c] = colors[corners_[0]][c] * (1 - u_ - v_) + colors[corners_[1]][c] * u_ + colors[corners_[2]][c] * v_;
  return color;
}

bool TextureSpot::axes_of_tangents(Vec3 normal, Vec3& right, Vec3& up) const {
  const Primitive& primitive = *surface_.primitive;
  if (primitive.tangents.empty() || !surface_.smooth()) return false;
  const std::array<float, 3> share{1 - u_ - v_, u_, v_};
  Vec3 tangent{0, 0, 0};
  float side = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    tangent = tangent + surface_.tangent(corners_[c]) * share[c];
    side += primitive.tangent_sides[corners_[c]] * share[c];
  }
  right = normalize(tangent - normal * dot(normal, tangent));
  // On a mirrored surface normal and tangent are mirrored, too, but their cross product is not.
  up = cross(normal, right) * ((side < 0) != surface_.flipped ? -1.0f : 1.0f);
  return length2(right) > 0.5f;
}

bool TextureSpot::axes_of_coordinates(const Texture& normal_map, Vec3 normal, Vec3& right, Vec3& up) const {
  const Corners corners = corner_coordinates(*surface_.primitive, corners_, normal_map);
  const Vec2 a = minus(corners[1], corners[0]), b = minus(corners[2], corners[0]);
  const float determinant = cross2(a, b);
  if (!(std::abs(determinant) > 0)) return false;
  // dP/du and dP/dv times |determinant|
  const float side = determinant < 0 ? -1.0f : 1.0f;
  const Vec3 along_u = (edge(1) * b.y - edge(2) * a.y) * side, along_v = (edge(2) * a.x - edge(1) * b.x) * side;
  right = normalize(along_u - normal * dot(normal, along_u));
  up = cross(normal, right);
  if (dot(up, along_v) > 0) up = -up;  // v grows downwards in the image
  return length2(right) > 0.5f;
}

Vec3 TextureSpot::bend(const Texture& normal_map, float scale, Vec3 normal, Vec3 geometric) const {
  Vec3 right, up;
  if (!axes(normal_map, normal, right, up)) return normal;
  const Rgba code = read(normal_map, TextureTransfer::linear);
  Vec3 bent =
      normalize(right * (scale * (2 * code[0] - 1)) + up * (scale * (2 * code[1] - 1)) + normal * (2 * code[2] - 1));
  if (!(length2(bent) > 0.5f)) return normal;
  if (const float rise = dot(bent, geometric); rise < kLeastRise)
    bent = normalize(bent + geometric * (kLeastRise - rise));
  return bent;
}

bool lets_rays_pass(const Material& material) {
  if (material.alpha_mode == Material::Alpha::opaque) return false;
  const bool textured = material.textures && (material.textures->base_color || material.textures->vertex_colors);
  return textured ||
         (material.alpha_mode == Material::Alpha::mask ? material.alpha < material.alpha_cutoff : material.alpha < 1);
}

TextureTransfer base_color_transfer(const Material& material) {
  return material.alpha_mode == Material::Alpha::opaque ? TextureTransfer::srgb : TextureTransfer::srgb_cutout;
}

float coverage_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v) {
  const Material& material = frame.materials[frame.surfaces[surface].material];
  if (!lets_rays_pass(material)) return 1;
  float alpha = 1;
  if (material.textures) {
    const TextureSpot spot(frame, surface, triangle, u, v, 0);
    if (material.textures->base_color)
      alpha = spot.read(material.textures->base_color, base_color_transfer(material))[3];
    if (material.textures->vertex_colors) alpha *= spot.vertex_color()[3];
  }
  return coverage(material, alpha);
}

bool emission_varies(const Material& material) {
  return (material.textures && material.textures->emission) || lets_rays_pass(material);
}

Rgb emission_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, float u, float v, float width) {
  const Material& material = frame.materials[frame.surfaces[surface].material];
  if (!material.textures || !material.textures->emission || !material.emissive()) return material.emission;
  const Rgba value =
      TextureSpot(frame, surface, triangle, u, v, width).read(material.textures->emission, TextureTransfer::srgb);
  return material.emission * Rgb{value[0], value[1], value[2]};
}

}  // namespace tempolux
