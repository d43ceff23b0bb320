// lib/scene/at_frame.cpp
#include "lib/scene/at_frame.h"

#include <cmath>
#include <stdexcept>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/scene/animate.h"
#include "lib/scene/scene_hash.h"

namespace tempolux {
namespace {

/// Beyond this [m] squares of distances leave float32 and Embree's own limits come near.
constexpr float kMaxCoordinate = 1e15f;

/// Lumens per watt at 555 nm, the factor of Blender's unit mode "Standard".
constexpr float kLuminousEfficacy = 683;

std::string node_place(const Scene& scene, std::size_t n) {
  const Node& node = scene.nodes[n];
  return scene.path + ": nodes[" + std::to_string(node.source_index) + "]" +
         (node.name.empty() ? "" : " \"" + node.name + "\"");
}

/// Each point transformed in double, made relative to the origin, then rounded once.
std::vector<Vec3> place_points(const std::vector<Vec3>& points, const Affine& scene_from_node) {
  std::vector<Vec3> placed;
  placed.reserve(points.size());
  for (const Vec3& p : points) placed.push_back(Vec3(scene_from_node.point(Vec3d(p))));
  return placed;
}

/// Empty (flat shading) if there are none or the transform is flat, which leaves normals no direction.
std::vector<Vec3> place_normals(const std::vector<Vec3>& normals, const Affine& scene_from_node) {
  std::vector<Vec3> placed;
  if (scene_from_node.determinant() == 0) return placed;
  placed.reserve(normals.size());
  for (const Vec3& n : normals) {
    const Vec3d unit = normalize(scene_from_node.normal(Vec3d(n)));
    if (!(length2(unit) > 0.5 && length2(unit) < 2)) return {};
    placed.push_back(Vec3(unit));
  }
  return placed;
}

void check_range(const Scene& scene, std::size_t n, const Surface& surface) {
  Box3 box;
  for (const Vec3& p : surface.positions) box.add(p);
  for (const Vec3& corner : {box.lower, box.upper})
    if (!(max_component(abs(corner)) < kMaxCoordinate))
      throw InputError(node_place(scene, n) + ": its transform takes vertices beyond 1e15 m");
}

/// Surfaces of the nodes that move, or of those that do not, in node order.
std::vector<Surface> place_surfaces(const Scene& scene, const Segment& segment,
                                    const std::vector<Affine>& world, bool moving) {
  std::vector<Surface> surfaces;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0 || (segment.node_moves[n] != 0) != moving) continue;
    Affine scene_from_node = world[n];
    scene_from_node.translation = scene_from_node.translation - segment.origin;
    for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives) {
      Surface surface;
      surface.object = node.object;
      surface.node = std::uint32_t(n);
      surface.material = primitive.material;
      surface.flipped = scene_from_node.determinant() < 0;
      surface.primitive = &primitive;
      surface.positions = place_points(primitive.positions, scene_from_node);
      surface.normals = place_normals(primitive.normals, scene_from_node);
      surface.scene_from_node = scene_from_node;
      check_range(scene, n, surface);
      surfaces.push_back(std::move(surface));
    }
  }
  return surfaces;
}

std::vector<PlacedLight> place_lights(const Scene& scene, Vec3d origin, const std::vector<Affine>& world,
                                      const TimeOptions& options) {
  std::vector<PlacedLight> lights;
  const float unit = options.light_units == "spec" ? 1 / kLuminousEfficacy : 1.0f;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].light < 0) continue;
    PlacedLight placed{scene.lights[std::size_t(scene.nodes[n].light)], {}, {}, std::uint32_t(n)};
    placed.light.intensity *= unit;
    placed.position = Vec3(world[n].translation - origin);
    placed.direction = Vec3(normalize(world[n].direction({0, 0, -1})));
    if (!is_finite(placed.position) || !(max_component(abs(placed.position)) < kMaxCoordinate))
      throw InputError(node_place(scene, n) + ": its light stands beyond 1e15 m");
    const bool needs_direction = placed.light.kind != PunctualLight::Kind::point;
    if (needs_direction && !(length2(placed.direction) > 0.5f && length2(placed.direction) < 2))
      throw InputError(node_place(scene, n) + ": its light has no direction; the node's scale must not be 0");
    lights.push_back(placed);
  }
  return lights;
}

/// Right, up and backward of the node, made orthonormal about the direction of view.
PlacedCamera place_camera(const Scene& scene, std::size_t n, Vec3d origin, const Affine& world) {
  PlacedCamera placed{scene.cameras[std::size_t(scene.nodes[n].camera)], {}};
  const Vec3d backward = normalize(world.direction({0, 0, 1}));
  const Vec3d right = normalize(cross(normalize(world.direction({0, 1, 0})), backward));
  if (!(length2(backward) > 0.5 && length2(right) > 0.5) || !is_finite(backward) || !is_finite(right))
    throw InputError(node_place(scene, n) + ": its camera has no direction; the node's scale must not be 0");
  const Vec3d up = cross(backward, right);
  placed.scene_from_camera.row = {Vec3d{right.x, up.x, backward.x}, Vec3d{right.y, up.y, backward.y},
                                  Vec3d{right.z, up.z, backward.z}};
  placed.scene_from_camera.translation = world.translation - origin;
  return placed;
}

}  // namespace

SegmentScene::SegmentScene(const Scene& scene, Segment segment, const TimeOptions& options)
    : scene_(&scene),
      segment_(std::move(segment)),
      options_(options),
      animator_(std::make_shared<const Animator>(scene)) {
  if (options.light_units != "raw" && options.light_units != "spec")
    throw std::invalid_argument("light units are raw or spec");
  const std::vector<Affine> world = animator_->world_from_node(segment_.first / options_.fps);
  static_surfaces_ = place_surfaces(scene, segment_, world, false);
  if (!segment_.world_bounds.empty()) {
    bounds_.add(Vec3(segment_.world_bounds.lower - segment_.origin));
    bounds_.add(Vec3(segment_.world_bounds.upper - segment_.origin));
  }
  static_hash_ = geometry_hash(scene, segment_.origin, static_surfaces_);
  materials_hash_ = materials_hash(scene);
  media_hash_ = media_hash();
}

SceneFrame SegmentScene::at(int frame) const {
  if (frame < segment_.first || frame > segment_.last)
    throw std::invalid_argument("frame " + std::to_string(frame) + " is not in the segment");
  const std::vector<Affine> world = animator_->world_from_node(frame / options_.fps);
  SceneFrame at;
  at.scene = scene_;
  at.frame = frame;
  at.time_s = frame / options_.fps;
  at.segment = segment_;
  at.surfaces = static_surfaces_;
  at.static_count = at.surfaces.size();
  const std::vector<Surface> moving = place_surfaces(*scene_, segment_, world, true);
  at.surfaces.insert(at.surfaces.end(), moving.begin(), moving.end());
  at.materials = scene_->materials;
  at.images = scene_->images;
  at.lights = place_lights(*scene_, segment_.origin, world, options_);
  at.origin = segment_.origin;
  at.bounds = bounds_;
  at.world_from_node = world;
  at.hashes.static_geometry = static_hash_;
  at.hashes.moving_geometry = geometry_hash(*scene_, segment_.origin, moving);
  at.hashes.lights = lights_hash(*scene_, segment_.origin, at.lights, at.surfaces);
  at.hashes.materials = materials_hash_;
  at.hashes.media = media_hash_;
  Hasher cameras;
  for (std::size_t n = 0; n < scene_->nodes.size(); ++n)
    if (scene_->nodes[n].camera >= 0) cameras.add(std::string_view(camera_hash(at.camera(int(n)))));
  at.hashes.camera = cameras.hex();
  return at;
}

PlacedCamera SceneFrame::camera(int camera_node) const {
  const std::size_t n = std::size_t(camera_node);
  if (camera_node < 0 || n >= scene->nodes.size() || scene->nodes[n].camera < 0)
    throw std::invalid_argument("node " + std::to_string(camera_node) + " has no camera");
  return place_camera(*scene, n, origin, world_from_node[n]);
}

SceneFrame scene_at_frame(const Scene& scene, const Segment& segment, int frame, const TimeOptions& options) {
  return SegmentScene(scene, segment, options).at(frame);
}

}  // namespace tempolux
