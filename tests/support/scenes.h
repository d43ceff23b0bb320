// tests/support/scenes.h -- builds small scenes by hand, for tests that need no file.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "lib/core/frame.h"
#include "lib/core/sampling.h"
#include "lib/image/texture_images.h"
#include "lib/scene/at_frame.h"

namespace tempolux::test {

/// A scene at one frame: groups of triangles, each with its own material. It must outlive everything that refers to
/// it.
class HandMadeScene {
 public:
  /// Adds triangles as one surface with a material of its own; returns its index.
  std::uint32_t add(const std::vector<Vec3>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                    const Material& material, bool moving = false, const std::vector<Vec3>& normals = {}) {
    auto primitive = std::make_unique<Primitive>();
    primitive->positions = positions;
    primitive->triangles = triangles;
    Surface surface;
    surface.object = surface.node = surface.material = std::uint32_t(frame_.materials.size());
    surface.primitive = primitive.get();
    surface.positions = positions;
    if (!normals.empty()) surface.normals = normals;
    frame_.materials.push_back(material);
    primitives_.push_back(std::move(primitive));
    (moving ? moving_ : fixed_).push_back(surface);
    for (Vec3 p : positions) frame_.bounds.add(p);
    return surface.object;
  }
  /// Adds a quad a, b, c, d, counter-clockwise seen from its front.
  std::uint32_t add_quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d, const Material& material, bool moving = false) {
    return add({a, b, c, d}, {{0, 1, 2}, {0, 2, 3}}, material, moving);
  }
  /// Adds the six faces of a box, fronts outwards; returns the object's number.
  std::uint32_t add_box(Vec3 lower, Vec3 upper, const Material& material, bool moving = false) {
    return add_faces_of_box(lower, upper, material, moving, false);
  }
  /// The same without the face at the largest x. A slab of glass with such a gap in its rim is no plate (plates.h) and
  /// refracts light.
  std::uint32_t add_open_box(Vec3 lower, Vec3 upper, const Material& material) {
    return add_faces_of_box(lower, upper, material, false, false, true);
  }
  /// Adds the six faces of a box, fronts inwards.
  void add_room(Vec3 lower, Vec3 upper, const Material& material) {
    add_faces_of_box(lower, upper, material, false, true);
  }
  /// Adds a sphere of subdivided octahedron faces, fronts inwards.
  void add_hollow_sphere(Vec3 centre, float radius, int subdivisions, const Material& material) {
    add_sphere(centre, radius, subdivisions, material, true, false);
  }
  /// The same with fronts inwards or outwards, and flat or smooth shading.
  void add_sphere(Vec3 centre, float radius, int subdivisions, const Material& material, bool inwards, bool smooth,
                  bool moving = false) {
    std::vector<Vec3> p;
    std::vector<std::array<std::uint32_t, 3>> t;
    for (int face = 0; face < 8; ++face) {
      const Vec3 x{face & 1 ? -1.f : 1.f, 0, 0}, y{0, face & 2 ? -1.f : 1.f, 0}, z{0, 0, face & 4 ? -1.f : 1.f};
      const bool mirrored = ((face & 1) + (face >> 1 & 1) + (face >> 2 & 1)) % 2 != 0;
      const int n = subdivisions;
      const auto corner = [&](int i, int j) {
        const float a = float(i) / float(n), b = float(j) / float(n);
        p.push_back(centre + normalize(x * (1 - a - b) + y * a + z * b) * radius);
        return std::uint32_t(p.size() - 1);
      };
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j) {
          const auto put = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            if (mirrored == inwards) t.push_back({a, b, c});
            else t.push_back({a, c, b});
          };
          put(corner(i, j), corner(i + 1, j), corner(i, j + 1));
          if (j < n - i - 1) put(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
        }
    }
    std::vector<Vec3> normals;
    if (smooth)
      for (Vec3 at : p) normals.push_back(normalize(inwards ? centre - at : at - centre));
    add(p, t, material, moving, normals);
  }
  void set_media(std::shared_ptr<const Media> media) { frame_.media = std::move(media); }
  /// Sets the texture coordinates of the surface added last, by vertex.
  void set_uvs(const std::vector<Vec2>& uvs) { primitives_.back()->uvs = uvs; }
  void set_colors(const std::vector<std::array<float, 4>>& colors) { primitives_.back()->colors = colors; }
  const std::vector<Vec3>& last_positions() const { return primitives_.back()->positions; }
  /// Sets the images to which the materials' textures refer by number.
  void set_images(std::vector<EncodedImage> images) {
    frame_.images = std::make_shared<const TextureImages>(std::move(images));
  }
  void add_point_light(Vec3 position, Rgb intensity) {
    PlacedLight light;
    light.light.intensity = intensity;
    light.position = position;
    light.direction = {0, -1, 0};
    light.node = std::uint32_t(frame_.lights.size());
    frame_.lights.push_back(light);
  }
  /// A sun without size that shines along `travel`, unit.
  void add_sun(Vec3 travel, Rgb irradiance) {
    add_point_light({}, irradiance);
    frame_.lights.back().light.kind = PunctualLight::Kind::directional;
    frame_.lights.back().direction = travel;
  }
  /// Returns the finished frame, static surfaces first.
  const SceneFrame& frame() {
    frame_.surfaces = fixed_;
    frame_.static_count = fixed_.size();
    frame_.surfaces.insert(frame_.surfaces.end(), moving_.begin(), moving_.end());
    return frame_;
  }

 private:
  std::uint32_t add_faces_of_box(Vec3 l, Vec3 u, const Material& material, bool moving, bool inwards,
                                 bool open = false) {
    const std::vector<Vec3> p{{l.x, l.y, l.z}, {u.x, l.y, l.z}, {u.x, u.y, l.z}, {l.x, u.y, l.z},
                              {l.x, l.y, u.z}, {u.x, l.y, u.z}, {u.x, u.y, u.z}, {l.x, u.y, u.z}};
    std::vector<std::array<std::uint32_t, 3>> faces{{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                                    {3, 6, 2}, {3, 7, 6}, {0, 7, 3}, {0, 4, 7}, {1, 2, 6}, {1, 6, 5}};
    if (inwards)
      for (auto& [a, b, c] : faces) std::swap(b, c);
    if (open) faces.resize(faces.size() - 2);
    return add(p, faces, material, moving);
  }
  SceneFrame frame_;
  std::vector<Surface> fixed_, moving_;
  std::vector<std::unique_ptr<Primitive>> primitives_;
};

inline Material matte(Rgb reflectance, Rgb emission = Rgb(0.0f)) {
  Material material;
  material.base_color = reflectance;
  material.metallic = 0;
  material.roughness = 1;
  material.specular = 0;
  material.emission = emission;
  material.double_sided = true;
  return material;
}

/// Draws points uniformly by area on all surfaces of a frame, with their front normals.
struct AreaSampler {
  struct Triangle {
    Vec3 a, b, c;
  };
  std::vector<Triangle> triangles;
  std::vector<double> cumulative;  ///< m^2

  explicit AreaSampler(const SceneFrame& frame) {
    double sum = 0;
    for (const Surface& surface : frame.surfaces)
      for (const auto& t : surface.primitive->triangles) {
        triangles.push_back({surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]});
        const auto& k = triangles.back();
        sum += 0.5 * double(length(cross(k.b - k.a, k.c - k.a)));
        cumulative.push_back(sum);
      }
  }
  double area() const { return cumulative.back(); }
  void sample(float u, Vec2 v, Vec3& position, Vec3& normal) const {
    const auto at = std::size_t(std::upper_bound(cumulative.begin(), cumulative.end() - 1, double(u) * area()) -
                                cumulative.begin());
    const Triangle& t = triangles[at];
    const Vec2 b = sample_triangle(v);
    position = t.a * (1 - b.x - b.y) + t.b * b.x + t.c * b.y;
    normal = normalize(cross(t.b - t.a, t.c - t.a));
  }
};

}  // namespace tempolux::test
