// lib/scene/gltf_deform.cpp -- reads morph targets, skins and instances.
#include "lib/scene/gltf_deform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lib/scene/gltf_check.h"

namespace tempolux::gltf {
namespace {

std::vector<Vec3> read_displacements(Import& import, const std::map<std::string, int>& target, const char* attribute,
                                     std::size_t vertices, const std::string& place) {
  const auto found = target.find(attribute);
  if (found == target.end()) return {};
  std::vector<std::uint32_t> unusable;
  std::vector<Vec3> values = read_vec3(import, found->second, place + "." + attribute, unusable);
  if (values.size() != vertices) {
    import.mend(
        place + "." + attribute,
        std::to_string(values.size()) + " displacements for " + std::to_string(vertices) + " positions are left out",
        1);
    return {};
  }
  if (!unusable.empty())
    import.mend(place + "." + attribute, "displacements with NaN or infinity are left out", unusable.size());
  return values;
}

/// Normalises the weights to a sum of 1. A vertex without weights follows its first joint.
void normalize_weights(Import& import, Primitive& primitive) {
  const std::size_t n = primitive.influences_per_vertex;
  for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
    Influence* of_vertex = &primitive.influences[v * n];
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += double(of_vertex[i].weight);
    if (!(sum > 0)) {
      of_vertex[0].weight = 1;
      import.ignore("vertices without joint weights (they follow their first joint)");
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) of_vertex[i].weight = float(double(of_vertex[i].weight) / sum);
  }
}

Affine affine_of(const Import& import, const double* m, const std::string& place) {
  if (std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) + std::abs(m[15] - 1) > 1e-3)
    import.fail(place, "is not affine: its last row must be 0 0 0 1");
  Affine affine;
  for (std::size_t r = 0; r < 3; ++r) affine.row[r] = {m[r], m[4 + r], m[8 + r]};
  affine.translation = {m[12], m[13], m[14]};
  return affine;
}

Skin read_skin(Import& import, std::size_t index) {
  const tinygltf::Skin& source = import.model.skins[index];
  const std::string place = place_of("skins", index, source.name);
  Skin skin;
  if (source.joints.empty()) import.fail(place, "has no joints");
  for (const int joint : source.joints) {
    const bool exists = joint >= 0 && std::size_t(joint) < import.node_from_source.size();
    if (!exists || import.node_from_source[std::size_t(joint)] < 0)
      import.fail(place + ".joints", "node " + std::to_string(joint) + " is not in the scene");
    skin.joints.push_back(import.node_from_source[std::size_t(joint)]);
  }
  skin.joint_from_mesh.resize(skin.joints.size());
  if (source.inverseBindMatrices == -1) return skin;
  const std::string matrices = place + ".inverseBindMatrices";
  const std::vector<double> numbers = read_numbers(import, source.inverseBindMatrices, 16, matrices);
  if (numbers.size() < 16 * skin.joints.size()) import.fail(matrices, "has fewer matrices than there are joints");
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    skin.joint_from_mesh[j] = affine_of(import, &numbers[16 * j], matrices + "[" + std::to_string(j) + "]");
  return skin;
}

/// Index in the scene of the skin `source` of the file, which is read at its first use; -1 if the mesh has no joints.
int skin_of(Import& import, const Node& node, int source, std::vector<int>& skin_from_source) {
  const std::string place = place_of("nodes", node.source_index, node.name);
  if (source < 0 || std::size_t(source) >= import.model.skins.size()) {
    import.mend(place + ".skin", "skin " + std::to_string(source) + " does not exist; the mesh stays rigid", 1);
    return -1;
  }
  const Mesh& mesh = import.scene.meshes[std::size_t(node.mesh)];
  std::uint32_t largest = 0;
  bool follows = false;
  for (const Primitive& primitive : mesh.primitives)
    for (const Influence& influence : primitive.influences) {
      follows = true;
      largest = std::max<std::uint32_t>(largest, influence.joint);
    }
  if (!follows) {
    import.ignore("skins of meshes without JOINTS_0 and WEIGHTS_0");
    return -1;
  }
  int& index = skin_from_source[std::size_t(source)];
  if (index < 0) {
    import.scene.skins.push_back(read_skin(import, std::size_t(source)));
    index = int(import.scene.skins.size()) - 1;
  }
  const std::size_t joints = import.scene.skins[std::size_t(index)].joints.size();
  if (largest >= joints)
    import.fail(place,
                "its mesh names joint " + std::to_string(largest) + ", but its skin has " + std::to_string(joints));
  return index;
}

std::vector<double> weights_of(Import& import, const Node& node) {
  const tinygltf::Node& source = import.model.nodes[node.source_index];
  const tinygltf::Mesh& mesh = import.model.meshes[std::size_t(source.mesh)];
  const std::size_t count = target_count(mesh);
  if (count == 0) return {};
  const std::vector<double>& given = source.weights.empty() ? mesh.weights : source.weights;
  if (!given.empty() && given.size() != count) {
    import.mend(place_of("nodes", node.source_index, node.name) + ".weights",
                std::to_string(given.size()) + " weights for " + std::to_string(count) +
                    " morph targets are left out: they are 0",
                1);
    return std::vector<double>(count, 0);
  }
  for (const double weight : given)
    if (!std::isfinite(weight))
      import.fail(place_of("nodes", node.source_index, node.name) + ".weights", "is not finite");
  return given.empty() ? std::vector<double>(count, 0) : given;
}

/// Numbers of one attribute of EXT_mesh_gpu_instancing; empty if the attribute is missing. Sets usable[i] to false if a
/// number of instance i is not finite.
std::vector<double> instance_numbers(Import& import, const tinygltf::Value& attributes, const char* name,
                                     std::size_t components, std::vector<bool>& usable, const std::string& place) {
  if (!attributes.Has(name)) return {};
  const tinygltf::Value& accessor = attributes.Get(name);
  if (!accessor.IsInt()) {
    import.mend(place + "." + name, "what is not the index of an accessor is left out", 1);
    return {};
  }
  std::vector<std::uint32_t> unusable;
  std::vector<double> numbers =
      read_numbers(import, accessor.GetNumberAsInt(), int(components), place + "." + name, unusable);
  if (!usable.empty() && numbers.size() / components != usable.size())
    import.fail(place, "its attributes have different counts");
  usable.resize(numbers.size() / components, true);
  for (const std::uint32_t i : unusable) usable[i] = false;
  return numbers;
}

std::vector<Affine> instances_of(Import& import, const Node& node) {
  const auto& extensions = import.model.nodes[node.source_index].extensions;
  const auto found = extensions.find("EXT_mesh_gpu_instancing");
  if (found == extensions.end()) return {};
  const std::string place =
      place_of("nodes", node.source_index, node.name) + ".extensions.EXT_mesh_gpu_instancing.attributes";
  if (!found->second.IsObject() || !found->second.Has("attributes") || !found->second.Get("attributes").IsObject()) {
    import.mend(place, "instances without attributes are left out: the mesh is drawn once", 1);
    return {};
  }
  if (node.skin >= 0) {
    import.ignore("instances of skinned meshes");
    return {};
  }
  const tinygltf::Value& attributes = found->second.Get("attributes");
  std::vector<bool> usable;
  const auto t = instance_numbers(import, attributes, "TRANSLATION", 3, usable, place);
  const auto r = instance_numbers(import, attributes, "ROTATION", 4, usable, place);
  const auto s = instance_numbers(import, attributes, "SCALE", 3, usable, place);
  import.take_memory(usable.size() * 320, place);  // memory of an instance with its surface
  std::vector<Affine> instances;
  for (std::size_t i = 0; i < usable.size(); ++i) {
    std::array<double, 4> rotation{0, 0, 0, 1};
    if (!r.empty()) std::copy_n(&r[4 * i], 4, rotation.begin());
    if (!usable[i] || !normalize_rotation(rotation)) {
      import.mend(place, "instances with NaN, infinity or a rotation of zero length are left out", 1);
      continue;
    }
    const auto vector = [i](const std::vector<double>& v, double rest) {
      return v.empty() ? Vec3d{rest, rest, rest} : Vec3d{v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    };
    instances.push_back(affine_from_trs(vector(t, 0), rotation, vector(s, 1)));
  }
  return instances;
}

}  // namespace

void read_targets(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive) {
  for (std::size_t t = 0; t < source.targets.size(); ++t) {
    const std::string target = place + ".targets[" + std::to_string(t) + "]";
    const std::size_t vertices = primitive.positions.size();
    primitive.targets.push_back({read_displacements(import, source.targets[t], "POSITION", vertices, target),
                                 read_displacements(import, source.targets[t], "NORMAL", vertices, target),
                                 primitive.tangents.empty()
                                     ? std::vector<Vec3>()
                                     : read_displacements(import, source.targets[t], "TANGENT", vertices, target)});
  }
}

void read_influences(Import& import, const tinygltf::Primitive& source, const std::string& place,
                     Primitive& primitive) {
  std::vector<std::vector<double>> joints, weights;
  for (std::size_t set = 0;; ++set) {
    const auto j = source.attributes.find("JOINTS_" + std::to_string(set));
    const auto w = source.attributes.find("WEIGHTS_" + std::to_string(set));
    if (j == source.attributes.end() || w == source.attributes.end()) break;
    joints.push_back(read_numbers(import, j->second, 4, place + "." + j->first));
    std::vector<std::uint32_t> unusable;  // become 0
    weights.push_back(read_numbers(import, w->second, 4, place + "." + w->first, unusable));
    std::size_t left_out = unusable.size();
    for (double& weight : weights.back())
      if (weight < 0) weight = 0, ++left_out;
    if (left_out > 0)
      import.mend(place + "." + w->first, "joint weights below 0, NaN or infinite are left out", left_out);
    if (joints.back().size() == 4 * primitive.positions.size() && weights.back().size() == joints.back().size())
      continue;
    import.mend(place + "." + w->first, "joints or weights of another number than positions are left out", 1);
    joints.pop_back(), weights.pop_back();
    break;
  }
  if (joints.empty()) return;
  const std::size_t n = primitive.influences_per_vertex = 4 * joints.size();
  import.take_memory(primitive.positions.size() * n * sizeof(Influence), place);
  primitive.influences.resize(primitive.positions.size() * n);
  for (std::size_t i = 0; i < primitive.influences.size(); ++i) {
    const std::size_t set = i % n / 4, at = i / n * 4 + i % 4;
    const double joint = joints[set][at], weight = weights[set][at];
    if (!(joint >= 0 && joint <= 65535 && joint == std::floor(joint)))
      import.fail(place + ".JOINTS_" + std::to_string(set), "a joint is not a whole number from 0 to 65535");
    primitive.influences[i] = {weight > 0 ? std::uint16_t(joint) : std::uint16_t(0), float(weight)};
  }
  normalize_weights(import, primitive);
}

void import_deformation(Import& import) {
  std::vector<int> skin_from_source(import.model.skins.size(), -1);
  for (Node& node : import.scene.nodes) {
    if (node.mesh < 0) continue;
    const int skin = import.model.nodes[node.source_index].skin;
    if (skin != -1) node.skin = skin_of(import, node, skin, skin_from_source);
    node.weights = weights_of(import, node);
    node.instances = instances_of(import, node);
  }
}

}  // namespace tempolux::gltf
