// lib/scene/at_frame.cpp -- evaluates the scene at a frame.
#include "lib/scene/at_frame.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/scene/animate.h"
#include "lib/scene/place_surfaces.h"
#include "lib/scene/scene_hash.h"

namespace tempolux {
namespace {

/// Lumens per watt at 555 nm, the factor of Blender's unit mode "Standard".
constexpr float kLuminousEfficacy = 683;

/// Lights of the nodes that the segment shows; where a node is hidden at this time, its light is dark.
std::vector<PlacedLight> place_lights(const Scene& scene, const Animator& animator, double time_s,
                                      const Segment& segment, const std::vector<Affine>& world,
                                      const TimeOptions& options) {
  std::vector<PlacedLight> lights;
  const Vec3d origin = segment.origin;
  const std::vector<std::uint8_t> seen = animator.seen(time_s);
  const float unit = options.light_units == "spec" ? 1 / kLuminousEfficacy : 1.0f;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].light < 0 || segment.hides(std::uint32_t(n))) continue;
    PlacedLight placed{animator.light(std::size_t(scene.nodes[n].light), time_s), {}, {}, std::uint32_t(n)};
    placed.light.intensity *= seen[n] ? unit : 0.0f;
    if (placed.light.size == LampSize{}) placed.light.size = scene.nodes[n].lamp_size;
    placed.position = Vec3(world[n].translation - origin);
    placed.direction = Vec3(normalize(world[n].direction({0, 0, -1})));
    if (!is_finite(placed.position) || !(max_component(abs(placed.position)) < kMaxCoordinate))
      throw InputError(node_place(scene, n) + ": its light is farther than 1e15 m from the origin");
    const bool needs_direction = placed.light.kind != PunctualLight::Kind::point;
    if (needs_direction && !(length2(placed.direction) > 0.5f && length2(placed.direction) < 2))
      throw InputError(node_place(scene, n) + ": its light has no direction; the node's scale must not be 0");
    lights.push_back(placed);
  }
  return lights;
}

/// Places a camera at its node. The node's axes are made orthonormal without changing the direction of view.
PlacedCamera place_camera(const Scene& scene, const Camera& camera, std::size_t n, Vec3d origin, const Affine& world) {
  PlacedCamera placed{camera, {}};
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
  sharing_ = std::make_shared<const Sharing>(scene);
  static_surfaces_ =
      place_surfaces(scene, *animator_, *sharing_, segment_, {segment_.first / options_.fps, world}, false);
  if (!segment_.world_bounds.empty()) {
    bounds_.add(Vec3(segment_.world_bounds.lower - segment_.origin));
    bounds_.add(Vec3(segment_.world_bounds.upper - segment_.origin));
  }
  static_hash_ = geometry_hash(scene, segment_.origin, static_surfaces_);
  materials_stay_ = std::ranges::none_of(animator_->property_tracks(), [](const AnimationTrack* track) {
    return kind_of(track->path) == std::string_view("material");
  });
  if (materials_stay_) materials_hash_ = materials_hash(scene, scene.materials);
  media_hash_ = media_hash();
}

SceneFrame SegmentScene::at(double frame) const {
  if (!(frame >= segment_.first && frame <= segment_.last))
    throw std::invalid_argument("frame " + std::to_string(frame) + " is not in the segment");
  const std::vector<Affine> world = animator_->world_from_node(frame / options_.fps);
  SceneFrame at;
  at.scene = scene_;
  at.frame = int(std::floor(frame));
  at.time_s = frame / options_.fps;
  at.segment = segment_;
  at.surfaces = static_surfaces_;
  at.static_count = at.surfaces.size();
  const std::vector<Surface> moving =
      place_surfaces(*scene_, *animator_, *sharing_, segment_, {at.time_s, world}, true);
  at.surfaces.insert(at.surfaces.end(), moving.begin(), moving.end());
  at.materials = materials_stay_ ? scene_->materials : animator_->materials(at.time_s);
  at.images = scene_->images;
  for (std::size_t c = 0; c < scene_->cameras.size(); ++c) at.cameras.push_back(animator_->camera(c, at.time_s));
  at.lights = place_lights(*scene_, *animator_, at.time_s, segment_, world, options_);
  at.environment = scene_->environment.get();
  at.origin = segment_.origin;
  at.bounds = bounds_;
  at.world_from_node = world;
  at.hashes.static_geometry = static_hash_;
  at.hashes.moving_geometry = geometry_hash(*scene_, segment_.origin, moving);
  at.hashes.lights = lights_hash(*scene_, segment_.origin, at.lights, at.materials, at.surfaces);
  at.hashes.materials = materials_stay_ ? materials_hash_ : materials_hash(*scene_, at.materials);
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
  Camera camera = cameras[std::size_t(scene->nodes[n].camera)];
  const CameraExtras& extras = scene->nodes[n].camera_extras;
  extras.apply(frame, camera);
  PlacedCamera placed = place_camera(*scene, camera, n, origin, world_from_node[n]);
  if (extras.focus_node >= 0) {
    const Vec3d target = world_from_node[std::size_t(extras.focus_node)].translation - origin;
    placed.camera.focus_m = std::abs(inverse(placed.scene_from_camera).point(target).z);  // as Blender's focus object
  }
  return placed;
}

}  // namespace tempolux
