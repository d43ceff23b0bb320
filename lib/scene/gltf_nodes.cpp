// lib/scene/gltf_nodes.cpp -- reads the node graph of the default scene, parents first.
#include <algorithm>
#include <cmath>
#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {
namespace {

constexpr std::size_t kMaxNodes = 1u << 20;

Vec3d vec3_of(const Import& import, const std::vector<double>& values, Vec3d fallback, const std::string& place) {
  if (values.empty()) return fallback;
  if (values.size() != 3) import.fail(place, "must have 3 numbers");
  const Vec3d v{values[0], values[1], values[2]};
  if (!is_finite(v)) import.fail(place, "is not finite");
  return v;
}

void read_matrix(const Import& import, const std::vector<double>& values, const std::string& place, Node& node) {
  if (values.size() != 16) import.fail(place, "must have 16 numbers");
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
    import.fail(place, "is not finite");
  if (values[3] != 0 || values[7] != 0 || values[11] != 0 || values[15] != 1)
    import.fail(place, "must be affine: last row 0 0 0 1");
  node.has_matrix = true;
  for (std::size_t i = 0; i < 3; ++i) node.parent_from_node.row[i] = {values[i], values[4 + i], values[8 + i]};
  node.parent_from_node.translation = {values[12], values[13], values[14]};
}

int checked_index(const Import& import, int index, std::size_t count, const std::string& place) {
  if (index < -1 || (index >= 0 && std::size_t(index) >= count))
    import.fail(place, "index " + std::to_string(index) + " does not exist");
  return index;
}

int light_of(const Import& import, const tinygltf::Node& source, const std::string& place) {
  const auto found = source.extensions.find("KHR_lights_punctual");
  if (found == source.extensions.end()) return -1;
  if (!found->second.Has("light") || !found->second.Get("light").IsInt())
    import.fail(place + ".extensions.KHR_lights_punctual", "has no light index");
  const int light = found->second.Get("light").GetNumberAsInt();
  if (light < 0) import.fail(place + ".extensions.KHR_lights_punctual", "has a negative light index");
  return checked_index(import, light, import.model.lights.size(), place + ".extensions.KHR_lights_punctual");
}

Node read_node(Import& import, std::uint32_t index, int parent) {
  const tinygltf::Node& source = import.model.nodes[index];
  const std::string place = place_of("nodes", index, source.name);
  Node node;
  node.name = source.name;
  node.parent = parent;
  node.source_index = index;
  if (!source.matrix.empty()) read_matrix(import, source.matrix, place + ".matrix", node);
  node.translation = vec3_of(import, source.translation, {}, place + ".translation");
  node.scale = vec3_of(import, source.scale, {1, 1, 1}, place + ".scale");
  if (!source.rotation.empty()) {
    if (source.rotation.size() != 4) import.fail(place + ".rotation", "must have 4 numbers");
    std::copy(source.rotation.begin(), source.rotation.end(), node.rotation.begin());
    if (!normalize_rotation(node.rotation)) import.fail(place + ".rotation", "is not a quaternion: zero or not finite");
  }
  node.mesh = checked_index(import, source.mesh, import.model.meshes.size(), place + ".mesh");
  node.camera = checked_index(import, source.camera, import.model.cameras.size(), place + ".camera");
  node.light = light_of(import, source, place);
  return node;
}

const tinygltf::Scene& default_scene(const Import& import) {
  const tinygltf::Model& model = import.model;
  if (model.scenes.empty()) import.fail("scenes", "the file has no scene; export one");
  const int index = model.defaultScene == -1 ? 0 : model.defaultScene;
  if (index < 0 || std::size_t(index) >= model.scenes.size())
    import.fail("scene", "scene " + std::to_string(index) + " does not exist");
  const tinygltf::Scene& scene = model.scenes[std::size_t(index)];
  if (scene.nodes.empty())
    import.fail(place_of("scenes", std::size_t(index), scene.name), "has no nodes; nothing to render");
  return scene;
}

}  // namespace

bool normalize_rotation(std::array<double, 4>& q) {
  const double length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(length2 > 1e-12 && std::isfinite(length2))) return false;
  for (double& component : q) component /= std::sqrt(length2);
  return true;
}

/// Visits nodes depth first, children in their order. An explicit stack lets nodes nest as deeply as memory allows.
void import_nodes(Import& import) {
  struct Pending {
    int source, parent;
  };
  const std::size_t count = import.model.nodes.size();
  if (count > kMaxNodes) import.fail("nodes", "more than " + std::to_string(kMaxNodes) + " nodes");
  import.node_from_source.assign(count, -1);
  const std::vector<int>& roots = default_scene(import).nodes;
  std::vector<Pending> stack;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, -1});
  while (!stack.empty()) {
    const Pending next = stack.back();
    stack.pop_back();
    if (next.source < 0 || std::size_t(next.source) >= count)
      import.fail("nodes", "node " + std::to_string(next.source) + " is named as a child or root but does not exist");
    const std::size_t source = std::size_t(next.source);
    if (import.node_from_source[source] != -1)
      import.fail(place_of("nodes", source, import.model.nodes[source].name),
                  "is reached twice: the nodes form a loop or a node has two parents");
    const int index = int(import.scene.nodes.size());
    import.node_from_source[source] = index;
    import.scene.nodes.push_back(read_node(import, std::uint32_t(source), next.parent));
    const std::vector<int>& children = import.model.nodes[source].children;
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      if (stack.size() > 2 * kMaxNodes) import.fail("nodes", "children name far more nodes than there are");
      stack.push_back({*child, index});
    }
  }
}

}  // namespace tempolux::gltf
