// lib/scene/gltf_nodes.cpp -- reads the node graph of the default scene, parents first.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>

#include "formats/error.h"
#include "lib/scene/gltf_gate.h"
#include "lib/scene/gltf_model.h"
#include "lib/scene/gltf_pointer.h"

namespace tempolux::gltf {
namespace {

constexpr std::size_t kMaxNodes = 1u << 20;

bool all_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

/// Three numbers; `fallback`, with a warning, for anything else that is not missing.
Vec3d vec3_of(Import& import, const std::vector<double>& values, Vec3d fallback, const std::string& place) {
  if (values.empty()) return fallback;
  if (values.size() == 3 && all_finite(values)) return {values[0], values[1], values[2]};
  import.mend(place, "what is not three finite numbers is left out", 1);
  return fallback;
}

void read_matrix(Import& import, const std::vector<double>& values, const std::string& place, Node& node) {
  if (values.size() != 16 || !all_finite(values))
    return import.mend(place, "what is not 16 finite numbers is left out: the node is not moved", 1);
  if (values[3] != 0 || values[7] != 0 || values[11] != 0 || values[15] != 1)
    return import.mend(place, "a matrix whose last row is not 0 0 0 1 is left out: the node is not moved", 1);
  node.has_matrix = true;
  for (std::size_t i = 0; i < 3; ++i) node.parent_from_node.row[i] = {values[i], values[4 + i], values[8 + i]};
  node.parent_from_node.translation = {values[12], values[13], values[14]};
}

/// Largest deviation of a rotation's length from 1 that goes without a warning.
constexpr double kRotationLength = 0.01;

void read_rotation(Import& import, const std::vector<double>& values, const std::string& place, Node& node) {
  if (values.empty()) return;
  std::array<double, 4> rotation{};
  if (values.size() == 4) std::copy(values.begin(), values.end(), rotation.begin());
  double length2 = 0;
  for (const double v : rotation) length2 += v * v;
  if (values.size() != 4 || !normalize_rotation(rotation))
    return import.mend(place, "what is not a quaternion is left out: the node is not turned", 1);
  if (std::abs(std::sqrt(length2) - 1) > kRotationLength)
    import.mend(place, "a quaternion whose length is not 1 is normalised", 1);
  node.rotation = rotation;
}

/// The index, or -1 with a warning if there is no such thing.
int checked_index(Import& import, int index, std::size_t count, const std::string& place) {
  if (index == -1 || (index >= 0 && std::size_t(index) < count)) return index;
  import.mend(place, "index " + std::to_string(index) + " does not exist; it is left out", 1);
  return -1;
}

int light_of(Import& import, const tinygltf::Node& source, const std::string& place) {
  const auto found = source.extensions.find("KHR_lights_punctual");
  if (found == source.extensions.end()) return -1;
  const bool known = found->second.IsObject() && found->second.Has("light") && found->second.Get("light").IsNumber();
  const double number = known ? found->second.Get("light").GetNumberAsDouble() : -1;
  if (!(number >= 0 && number < 2147483648.0 && number == std::floor(number))) {
    import.mend(place + ".extensions.KHR_lights_punctual.light", "what is not the index of a light is left out", 1);
    return -1;
  }
  const int light = int(number);
  return checked_index(import, light, import.model.lights.size(), place + ".extensions.KHR_lights_punctual");
}

/// KHR_node_visibility of a node; what is neither true nor false counts as true, which is the default.
bool is_visible(Import& import, const tinygltf::Node& source, const std::string& place) {
  const auto found = source.extensions.find("KHR_node_visibility");
  if (found == source.extensions.end() || !found->second.IsObject() || !found->second.Has("visible")) return true;
  const tinygltf::Value& visible = found->second.Get("visible");
  if (visible.IsBool()) return visible.Get<bool>();
  import.mend(place + ".extensions.KHR_node_visibility.visible", "what is neither true nor false counts as true", 1);
  return true;
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
  read_rotation(import, source.rotation, place + ".rotation", node);
  node.mesh = checked_index(import, source.mesh, import.model.meshes.size(), place + ".mesh");
  node.camera = checked_index(import, source.camera, import.model.cameras.size(), place + ".camera");
  node.light = light_of(import, source, place);
  node.visible = is_visible(import, source, place);
  return node;
}

const tinygltf::Scene& default_scene(Import& import) {
  const tinygltf::Model& model = import.model;
  if (model.scenes.empty()) import.fail("scenes", "the file has no scene; export one");
  int index = model.defaultScene == -1 ? 0 : model.defaultScene;
  if (index < 0 || std::size_t(index) >= model.scenes.size()) {
    import.mend("scene", "scene " + std::to_string(index) + " does not exist; the first one is rendered", 1);
    index = 0;
  }
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

void leave_out_hidden(Import& import, const std::string& only) {
  constexpr std::string_view kVisible = "/extensions/KHR_node_visibility/visible";
  std::set<std::size_t> animated;  // nodes whose visibility changes
  for (const PointerChannel& channel : import.gated->pointers) {
    if (!is_played(import.model, channel.animation, only) || !channel.pointer.ends_with(kVisible)) continue;
    PointedAt at;
    try {
      if (resolve_pointer(import, channel.pointer, at)) animated.insert(std::size_t(at.target));
    } catch (const InputError&) { continue; }  // import_animations() reports the channel
  }
  for (std::size_t n = 0; n < import.scene.nodes.size(); ++n) {
    Node& node = import.scene.nodes[n];
    const bool below_hidden = node.parent >= 0 && import.scene.nodes[std::size_t(node.parent)].never_seen;
    node.never_seen = below_hidden || (!node.visible && !animated.contains(n));
    if (node.never_seen) node.mesh = node.light = -1;
  }
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
    if (next.source < 0 || std::size_t(next.source) >= count) {
      const Node* const parent = next.parent < 0 ? nullptr : &import.scene.nodes[std::size_t(next.parent)];
      import.mend(parent ? place_of("nodes", parent->source_index, parent->name) + ".children" : "scenes.nodes",
                  "node " + std::to_string(next.source) + " does not exist; it is left out", 1);
      continue;
    }
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
