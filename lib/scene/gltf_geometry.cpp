// lib/scene/gltf_geometry.cpp -- reads meshes as indexed triangles; each primitive gets only the vertices it uses.
#include <algorithm>
#include <array>
#include <string>

#include "lib/scene/gltf_check.h"
#include "lib/scene/gltf_deform.h"
#include "lib/scene/gltf_mend.h"
#include "lib/scene/tangents.h"

namespace tempolux::gltf {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t kMaxObjects = 65534;  // id.object is 16 bits in files; 65535 means none

std::vector<Triangle> triangles_from(const std::vector<std::uint32_t>& indices, int mode) {
  std::vector<Triangle> triangles;
  const std::size_t count = indices.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(count / 3);
    for (std::size_t i = 0; i + 2 < count; i += 3) triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  } else {
    const bool fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
    if (count > 2) triangles.reserve(count - 2);
    for (std::size_t i = 0; i + 2 < count; ++i) {
      if (fan) triangles.push_back({indices[i + 1], indices[i + 2], indices[0]});
      else triangles.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    }
  }
  return triangles;
}

/// True unless the corners are collinear. Double precision holds the differences and products of floats so exactly that
/// no other triangle gives zero.
bool has_area(const std::vector<Vec3>& positions, const Triangle& t) {
  const Vec3d a(positions[t[0]]), b(positions[t[1]]), c(positions[t[2]]);
  return length2(cross(b - a, c - a)) > 0;
}

/// Drops the vertices that no triangle uses: exporters may put the vertices of many primitives into one accessor.
void drop_unused_vertices(Primitive& primitive) {
  std::vector<std::uint32_t> new_index(primitive.positions.size(), 0), used;
  for (const Triangle& t : primitive.triangles)
    for (const std::uint32_t i : t) new_index[i] = 1;
  for (std::uint32_t i = 0; i < new_index.size(); ++i)
    if (new_index[i]) {
      new_index[i] = std::uint32_t(used.size());
      used.push_back(i);
    }
  if (used.size() == new_index.size()) return;
  take_vertices(primitive, used);
  for (Triangle& t : primitive.triangles)
    for (std::uint32_t& i : t) i = new_index[i];
}

std::vector<std::uint32_t> vertex_order(Import& import, const tinygltf::Primitive& source, std::size_t vertices,
                                        const std::string& place) {
  if (source.indices == -1) {
    import.take_memory(vertices * sizeof(std::uint32_t), place);
    std::vector<std::uint32_t> all(vertices);
    for (std::size_t i = 0; i < vertices; ++i) all[i] = std::uint32_t(i);
    return all;
  }
  std::vector<std::uint32_t> indices = read_indices(import, source.indices, place + ".indices");
  const auto largest = std::max_element(indices.begin(), indices.end());
  if (largest != indices.end() && *largest >= vertices)
    import.fail(place + ".indices",
                "index " + std::to_string(*largest) + " is beyond the " + std::to_string(vertices) + " vertices");
  return indices;
}

/// True if there is one value for each vertex; if not, warns that the values are left out.
bool as_many(Import& import, std::size_t values, const Primitive& primitive, const std::string& place,
             const char* name) {
  if (values == primitive.positions.size()) return true;
  import.mend(place,
              std::to_string(values) + " " + name + " for " + std::to_string(primitive.positions.size()) +
                  " positions are left out",
              1);
  return false;
}

void read_normals(Import& import, int accessor, const std::string& place, Primitive& primitive) {
  std::vector<std::uint32_t> unusable;
  primitive.normals = read_vec3(import, accessor, place, unusable);  // unusable normals are set to 0
  if (!as_many(import, primitive.normals.size(), primitive, place, "normals")) {
    primitive.normals.clear();
    return;
  }
  unusable.clear();
  for (std::size_t v = 0; v < primitive.normals.size(); ++v) {
    const Vec3d unit = normalize(Vec3d(primitive.normals[v]));
    if (length2(unit) == 0) unusable.push_back(std::uint32_t(v));
    primitive.normals[v] = Vec3(unit);
  }
  mend_normals(import, place, unusable, primitive);
}

/// True if the texture transform neither turns nor mirrors the map. If false, the file's tangents, which follow the
/// untransformed coordinates, are wrong and must be computed.
bool keeps_axes(const Texture& texture) {
  const auto& m = texture.transform;
  return m[0] > 0 && m[4] > 0 && m[1] == 0 && m[3] == 0;
}

/// Reads tangents: a unit vector and the sign of the third axis (glTF 2.0, 3.7.2.1). Reads nothing unless the primitive
/// has normals and its material a map along tangents that keeps the axes; read_primitive() then computes tangents if
/// needed.
void read_tangents(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive) {
  const auto found = source.attributes.find("TANGENT");
  const Material& material = import.scene.materials[primitive.material];
  if (found == source.attributes.end() || primitive.normals.empty()) return;
  const Texture* const along = material.textures ? material.textures->along_tangents() : nullptr;
  if (!along || !keeps_axes(*along)) return;
  std::vector<std::uint32_t> unusable;  // become 0
  const std::vector<double> numbers = read_numbers(import, found->second, 4, place, unusable);
  const std::size_t count = primitive.positions.size();
  if (!as_many(import, numbers.size() / 4, primitive, place, "tangents")) return;
  import.take_memory(count * (sizeof(Vec3) + sizeof(float)), place);
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3d unit = normalize(Vec3d{numbers[4 * v], numbers[4 * v + 1], numbers[4 * v + 2]});
    if (length2(unit) == 0) {
      import.ignore("tangents of zero length, NaN or infinity (theirs are made from the texture coordinates)");
      primitive.tangents.clear(), primitive.tangent_sides.clear();
      return;
    }
    primitive.tangents.push_back(Vec3(unit));
    primitive.tangent_sides.push_back(numbers[4 * v + 3] < 0 ? -1.0f : 1.0f);
  }
}

std::vector<Vec2> read_uvs(Import& import, const tinygltf::Primitive& source, const std::string& name,
                           const Primitive& primitive, const std::string& place) {
  const auto found = source.attributes.find(name);
  if (found == source.attributes.end()) return {};
  std::vector<std::uint32_t> unusable;
  std::vector<Vec2> uvs = read_vec2(import, found->second, place + "." + name, unusable);
  if (!as_many(import, uvs.size(), primitive, place + "." + name, "texture coordinates")) return {};
  static_assert(sizeof(Vec2) == 2 * sizeof(float));
  if (unusable.empty()) return uvs;
  mend_from_neighbours(primitive, unusable, {&uvs.front().x, 2 * uvs.size()}, 2);
  import.mend(place + "." + name, "texture coordinates with NaN or infinity take the mean of their neighbours'",
              unusable.size());
  return uvs;
}

/// Reads the vertex colours of a primitive (glTF 2.0, 3.7.2.1: RGB or RGBA, linear) and marks the material as one with
/// vertex colours. If all colours are white, the primitive gets none, and the material is not marked.
void read_colors(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive) {
  const auto found = source.attributes.find("COLOR_0");
  if (found == source.attributes.end()) return;
  const auto accessor = std::size_t(found->second);
  const bool rgb =
      accessor < import.model.accessors.size() && import.model.accessors[accessor].type == TINYGLTF_TYPE_VEC3;
  const std::size_t components = rgb ? 3 : 4;
  std::vector<std::uint32_t> unusable;
  const std::vector<double> numbers = read_numbers(import, found->second, int(components), place, unusable);
  const std::size_t count = primitive.positions.size();
  if (!as_many(import, numbers.size() / components, primitive, place, "colours")) return;
  import.take_memory(count * sizeof(primitive.colors[0]), place);
  primitive.colors.assign(count, {1, 1, 1, 1});
  bool outside = false;
  for (std::size_t v = 0; v < count; ++v)
    for (std::size_t c = 0; c < components; ++c) {
      const double number = numbers[components * v + c];
      outside |= number < 0 || number > 1;
      primitive.colors[v][c] = float(std::clamp(number, 0.0, 1.0));
    }
  if (outside) import.ignore("what vertex colours have below 0 and above 1");
  if (!unusable.empty()) {
    mend_from_neighbours(primitive, unusable, {primitive.colors.front().data(), 4 * count}, 4);
    import.mend(place, "colours with NaN or infinity take the mean of their neighbours'", unusable.size());
  }
  if (std::ranges::all_of(primitive.colors, [](const auto& color) {
        return color == std::array<float, 4>{1, 1, 1, 1};
      })) {
    primitive.colors.clear();
    return;
  }
  Material& material = import.scene.materials[primitive.material];
  if (!material.textures) material.textures.emplace();
  material.textures->vertex_colors = true;
}

void note_ignored(Import& import, const tinygltf::Primitive& source) {
  for (const auto& [name, accessor] : source.attributes) {
    if (name == "COLOR_1") import.ignore("second and further vertex colours");
  }
}

/// Reads a primitive; its triangles are empty if it draws nothing.
Primitive read_primitive(Import& import, const tinygltf::Primitive& source, const std::string& place) {
  Primitive primitive;
  if (source.mode < TINYGLTF_MODE_POINTS || source.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    import.mend(place + ".mode",
                "mode " + std::to_string(source.mode) + " is not one of glTF's; the primitive is left out", 1);
    return primitive;
  }
  if (source.mode < TINYGLTF_MODE_TRIANGLES) {
    import.ignore("points and lines");
    return primitive;
  }
  const auto position = source.attributes.find("POSITION");
  if (position == source.attributes.end()) {
    import.ignore("primitives without positions");
    return primitive;
  }
  primitive.positions = read_vec3(import, position->second, place + ".POSITION");
  const std::vector<std::uint32_t> order = vertex_order(import, source, primitive.positions.size(), place);
  if (source.mode == TINYGLTF_MODE_TRIANGLES && order.size() % 3 != 0)
    import.ignore("one or two indices at the end of a triangle list");
  import.take_memory(order.size() * sizeof(Triangle), place);
  primitive.triangles = triangles_from(order, source.mode);
  const std::size_t before = primitive.triangles.size();
  // A triangle of a deforming primitive may have an area in another pose.
  const bool deforms = !source.targets.empty() || source.attributes.contains("JOINTS_0");
  if (!deforms)
    std::erase_if(primitive.triangles, [&](const Triangle& t) { return !has_area(primitive.positions, t); });
  if (before > primitive.triangles.size()) import.ignore("triangles of zero area", before - primitive.triangles.size());
  if (const auto normal = source.attributes.find("NORMAL"); normal != source.attributes.end())
    read_normals(import, normal->second, place + ".NORMAL", primitive);
  const bool has_material = source.material >= 0 && source.material < int(import.model.materials.size());
  using Sets = std::array<std::uint32_t, 2>;
  const Sets sets = has_material ? import.uv_sets[std::size_t(source.material)] : Sets{0, 1};
  primitive.uvs = read_uvs(import, source, "TEXCOORD_" + std::to_string(sets[0]), primitive, place);
  if (sets[1] != kNone)
    primitive.uvs1 = read_uvs(import, source, "TEXCOORD_" + std::to_string(sets[1]), primitive, place);
  if (!has_material && source.material != -1)
    import.mend(place + ".material",
                "material " + std::to_string(source.material) + " does not exist; glTF's default material is taken", 1);
  primitive.material =
      !has_material ? std::uint32_t(import.scene.materials.size() - 1) : std::uint32_t(source.material);
  read_colors(import, source, place + ".COLOR_0", primitive);
  read_tangents(import, source, place + ".TANGENT", primitive);
  read_targets(import, source, place, primitive);
  read_influences(import, source, place, primitive);
  note_ignored(import, source);
  drop_unused_vertices(primitive);
  const Material& material = import.scene.materials[primitive.material];
  const Texture* const along = material.textures ? material.textures->along_tangents() : nullptr;
  if (primitive.tangents.empty() && along) {
    make_tangents(primitive, *along);
    import.take_memory(primitive.tangents.size() * (sizeof(Vec3) * (1 + primitive.targets.size()) + sizeof(float)),
                       place);
  }
  return primitive;
}

/// Index of the mesh in the scene; the mesh is read at its first use. -1 if it has no triangles.
int mesh_of(Import& import, std::size_t source_index, std::vector<bool>& seen) {
  if (seen[source_index]) return import.mesh_from_source[source_index];
  seen[source_index] = true;
  const tinygltf::Mesh& source = import.model.meshes[source_index];
  const std::string place = place_of("meshes", source_index, source.name);
  Mesh mesh;
  mesh.name = source.name;
  for (std::size_t p = 0; p < source.primitives.size(); ++p) {
    if (source.primitives[p].targets.size() != target_count(source))
      import.fail(place, "its primitives have different numbers of morph targets");
    Primitive primitive =
        read_primitive(import, source.primitives[p], place + ".primitives[" + std::to_string(p) + "]");
    if (!primitive.triangles.empty()) mesh.primitives.push_back(std::move(primitive));
  }
  if (mesh.primitives.empty()) return -1;
  import.scene.meshes.push_back(std::move(mesh));
  return import.mesh_from_source[source_index] = int(import.scene.meshes.size()) - 1;
}

}  // namespace

void import_meshes(Import& import) {
  Scene& scene = import.scene;
  import.mesh_from_source.assign(import.model.meshes.size(), -1);
  std::vector<bool> seen(import.model.meshes.size(), false);
  for (Node& node : scene.nodes) {
    if (node.mesh == -1) continue;
    node.mesh = mesh_of(import, std::size_t(node.mesh), seen);
    if (node.mesh == -1) continue;
    if (scene.object_names.size() >= kMaxObjects)
      import.fail("nodes", "more than " + std::to_string(kMaxObjects) + " objects; join meshes that move together");
    node.object = std::uint32_t(scene.object_names.size());
    scene.object_names.push_back(node.name.empty() ? scene.meshes[std::size_t(node.mesh)].name : node.name);
  }
  if (scene.meshes.empty())
    import.fail("nodes", "no node of the scene has a mesh with triangles; nothing to render" +
                             std::string(std::ranges::any_of(scene.nodes, &Node::never_seen)
                                             ? " (KHR_node_visibility hides some nodes)"
                                             : ""));
}

}  // namespace tempolux::gltf
