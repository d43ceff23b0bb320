// lib/scene/scene.cpp -- cameras and lights of a scene.
#include "lib/scene/scene.h"
#include "lib/scene/material_properties.h"

#include <algorithm>

#include "formats/error.h"

namespace tempolux {
namespace {

/// Replaces the values of all vertices, `per_vertex` each, by those of the vertices `sources`.
template <class T>
void take(std::vector<T>& values, const std::vector<std::uint32_t>& sources, std::size_t per_vertex = 1) {
  if (values.empty()) return;
  std::vector<T> taken;
  taken.reserve(sources.size() * per_vertex);
  for (const std::uint32_t i : sources)
    for (std::size_t k = 0; k < per_vertex; ++k) taken.push_back(values[i * per_vertex + k]);
  values = std::move(taken);
}

}  // namespace

void take_vertices(Primitive& primitive, const std::vector<std::uint32_t>& sources) {
  take(primitive.positions, sources);
  take(primitive.normals, sources);
  take(primitive.uvs, sources);
  take(primitive.uvs1, sources);
  take(primitive.colors, sources);
  take(primitive.tangents, sources);
  take(primitive.tangent_sides, sources);
  take(primitive.influences, sources, primitive.influences_per_vertex);
  for (MorphTarget& target : primitive.targets) {
    take(target.positions, sources);
    take(target.normals, sources);
    take(target.tangents, sources);
  }
}

bool Scene::has_camera() const {
  return std::ranges::any_of(nodes, [](const Node& node) { return node.camera >= 0; });
}

bool Scene::has_distant_light() const {
  return environment || std::ranges::any_of(nodes, [&](const Node& node) {
           return node.light >= 0 && lights[std::size_t(node.light)].distant();
         });
}

int Scene::camera_node(const std::string& name) const {
  int first = -1;
  std::string names;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Node& node = nodes[n];
    if (node.camera < 0) continue;
    const std::string& own_name = cameras[std::size_t(node.camera)].name;
    const std::string camera_name = own_name.empty() ? "camera " + std::to_string(node.camera) : own_name;
    if (name != "auto" && (name == node.name || name == camera_name)) return int(n);
    if (first < 0 || node.source_index < nodes[std::size_t(first)].source_index) first = int(n);
    names += (names.empty() ? "" : ", ") + (node.name.empty() ? camera_name : node.name);
  }
  if (first < 0)
    throw InputError(path +
                     ": cameras: the scene has no camera; in Blender's glTF exporter tick Include > Cameras, or let "
                     "--camera auto frame what is there");
  if (name != "auto") throw InputError(path + ": cameras: no camera is named \"" + name + "\"; there is " + names);
  return first;
}

void require_lights(const Scene& scene) {
  if (scene.environment && scene.environment->emits()) return;
  const auto emits = [&](const Primitive& primitive) { return scene.materials[primitive.material].emissive(); };
  for (const Animation& animation : scene.animations)  // a light may be dark at rest and shine at some time
    for (const AnimationTrack& track : animation.tracks)
      if (changes_emission(track) || track.path == AnimationTrack::Path::light_color ||
          track.path == AnimationTrack::Path::light_intensity)
        return;
  for (const Node& node : scene.nodes) {
    if (node.light >= 0 && max_component(scene.lights[std::size_t(node.light)].intensity) > 0) return;
    if (node.mesh >= 0 && std::ranges::any_of(scene.meshes[std::size_t(node.mesh)].primitives, emits)) return;
  }
  throw InputError(scene.path +
                   ": lights: nothing in the scene emits light; give --environment FILE.hdr or 1,1,1 (make: "
                   "ENVIRONMENT=FILE.hdr, SKY=1,1,1); from Blender tick Include > Punctual Lights, or export by "
                   "tempolux_export.py, which keeps area lights and the world");
}

}  // namespace tempolux
