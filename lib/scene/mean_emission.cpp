// lib/scene/mean_emission.cpp -- averages the emission of a textured triangle.
#include <algorithm>
#include <cmath>
#include <optional>

#include "lib/image/texture_images.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

std::array<Vec2, 3> coordinates_of(const Surface& surface, std::uint32_t triangle, const Texture& texture,
                                   const TrianglePart& part) {
  std::array<Vec2, 3> at = corner_coordinates(*surface.primitive, surface.primitive->triangles[triangle], texture);
  if (part.size == 1) return at;
  const Vec2 along1{at[1].x - at[0].x, at[1].y - at[0].y}, along2{at[2].x - at[0].x, at[2].y - at[0].y};
  const auto place = [&, origin = at[0]](Vec2 b) {
    return Vec2{origin.x + along1.x * b.x + along2.x * b.y, origin.y + along1.y * b.x + along2.y * b.y};
  };
  return {place(part.at(0, 0)), place(part.at(1, 0)), place(part.at(0, 1))};
}

/// The piece of a texture that lies on a part of a triangle.
class Spread {
 public:
  Spread(const SceneFrame& frame, const Surface& surface, std::uint32_t triangle, const TrianglePart& part,
         const Texture& texture, TextureTransfer transfer)
      : texture_(texture),
        pyramid_(frame.images->pyramid(texture.image, transfer)),
        at_(coordinates_of(surface, triangle, texture, part)),
        lower_{std::min({at_[0].x, at_[1].x, at_[2].x}), std::min({at_[0].y, at_[1].y, at_[2].y})},
        upper_{std::max({at_[0].x, at_[1].x, at_[2].x}), std::max({at_[0].y, at_[1].y, at_[2].y})} {}

  bool any_colour() const { return pyramid_.any_colour(lower_, upper_, texture_.wrap_u, texture_.wrap_v); }
  /// Texels along the longer side of the bounding rectangle.
  float extent() const {
    return std::max((upper_.x - lower_.x) * float(pyramid_.width()), (upper_.y - lower_.y) * float(pyramid_.height()));
  }
  /// The level of the pyramid whose texels are as large as one of cuts^2 equal pieces; at least 0.
  float level(int cuts) const {
    const Vec2 a{at_[1].x - at_[0].x, at_[1].y - at_[0].y}, b{at_[2].x - at_[0].x, at_[2].y - at_[0].y};
    const float texels = 0.5f * std::abs(a.x * b.y - a.y * b.x) * float(pyramid_.width()) * float(pyramid_.height());
    return std::max(0.0f, 0.5f * std::log2(std::clamp(texels / float(cuts * cuts), 1.0f, 1e30f)));
  }
  Rgba read(float u, float v, float level) const {
    const float w = 1 - u - v;
    return pyramid_.read({at_[0].x * w + at_[1].x * u + at_[2].x * v, at_[0].y * w + at_[1].y * u + at_[2].y * v},
                         texture_.wrap_u, texture_.wrap_v, texture_.nearest, level);
  }

 private:
  const Texture& texture_;
  const TexturePyramid& pyramid_;
  std::array<Vec2, 3> at_;
  Vec2 lower_, upper_;
};

}  // namespace

Rgb mean_emission_share(const SceneFrame& frame, std::uint32_t surface_index, std::uint32_t triangle,
                        const TrianglePart& part, Rgb whole) {
  const Surface& surface = frame.surfaces[surface_index];
  const Material& material = frame.materials[surface.material];
  if (!emission_varies(material)) return Rgb(1.0f);
  std::optional<Spread> emission, base_color;
  float extent = 0;
  if (material.textures && material.textures->emission) {
    emission.emplace(frame, surface, triangle, part, material.textures->emission, TextureTransfer::srgb);
    if (!emission->any_colour()) return Rgb(0.0f);
    extent = emission->extent();
  }
  const bool covers = !lets_rays_pass(material);
  if (!covers && material.textures && material.textures->base_color) {
    base_color.emplace(frame, surface, triangle, part, material.textures->base_color, base_color_transfer(material));
    extent = std::max(extent, base_color->extent());
  }
  const auto vertex_alpha = [&](float u, float v) {
    const Vec2 b = part.at(u, v);
    return TextureSpot(frame, surface_index, triangle, b.x, b.y, 0).vertex_color()[3];
  };
  constexpr int kMostCuts = 8;
  int cuts = extent < kMostCuts - 1 ? 2 + int(extent) : kMostCuts;
  if (part.size != 1) cuts = std::max(2, int(kMostCuts * std::abs(part.size)));
  const float level = emission ? emission->level(cuts) : 0;
  Rgbd sum{0.0};
  for (int i = 0; i < cuts; ++i)
    for (int j = 0; j < cuts - i; ++j)
      for (int down = 0; down < (j < cuts - i - 1 ? 2 : 1); ++down) {
        const float third = down ? 2.0f / 3 : 1.0f / 3;
        const float u = (float(i) + third) / float(cuts), v = (float(j) + third) / float(cuts);
        Rgba value{1, 1, 1, 1};
        if (emission) value = emission->read(u, v, level);
        const float alpha = covers ? 1 : (base_color ? base_color->read(u, v, 0)[3] : 1) * vertex_alpha(u, v);
        const double share = covers ? 1 : double(coverage(material, alpha));
        sum += Rgbd(Rgb{value[0], value[1], value[2]}) * share;
      }
  constexpr float kLeast = 0.01f;
  const Rgb mean(sum / double(cuts * cuts));
  const Rgb least = whole * kLeast;
  return {std::max(mean.r, least.r), std::max(mean.g, least.g), std::max(mean.b, least.b)};
}

float emission_texels(const SceneFrame& frame, std::uint32_t surface_index, std::uint32_t triangle) {
  const Surface& surface = frame.surfaces[surface_index];
  const Material& material = frame.materials[surface.material];
  if (!material.textures) return 0;
  float extent = 0;
  const auto add = [&](const Texture& texture, TextureTransfer transfer) {
    if (texture) extent = std::max(extent, Spread(frame, surface, triangle, {}, texture, transfer).extent());
  };
  add(material.textures->emission, TextureTransfer::srgb);
  if (lets_rays_pass(material)) add(material.textures->base_color, base_color_transfer(material));
  return extent;
}

}  // namespace tempolux
