// lib/scene/gltf_extensions.cpp -- refuses packed data that this program cannot unpack.
#include "lib/scene/gltf_extensions.h"

#include <algorithm>
#include <array>

#include "formats/error.h"

namespace tempolux::gltf {
namespace {

struct Extension {
  const char* name;
  const char* remedy;
  bool is_of_textures = false;  ///< stores images in its own format, which this program does not decode
};

// The remedies name commands that unpack. `gltf-transform cp` writes unpacked geometry. gltfpack reads packed files
// from version 0.22 on.
constexpr std::array kExtensions{
    Extension{"KHR_draco_mesh_compression",
              "unpack it with `gltf-transform cp IN.glb OUT.glb`, or export without Compression"},
    Extension{"EXT_meshopt_compression",
              "unpack it with `gltf-transform cp IN.glb OUT.glb` or `gltfpack -noq -kn -i IN.glb -o OUT.glb`"},
    Extension{"KHR_meshopt_compression", "unpack it with `gltfpack -noq -kn -i IN.glb -o OUT.glb`"},
    Extension{"KHR_texture_basisu",
              "convert its textures with `gltf-transform ktxdecompress IN.glb OUT.glb` (it calls ktx of KTX-Software)",
              true},
    Extension{"KHR_gaussian_splatting", "only triangles can be rendered"}};

/// Extensions that a file may require although it can be rendered without them, and what is then rendered.
struct Dispensable {
  const char *name, *rendered;
};
constexpr const char* kRest = "the rest of its materials is rendered";
constexpr const char* kNothing = "it changes no picture";
constexpr std::array kDispensable{Dispensable{"KHR_materials_variants", "the default variant is rendered"},
                                  Dispensable{"KHR_materials_volume_scatter", kRest},
                                  Dispensable{"KHR_interactivity", kNothing},
                                  Dispensable{"KHR_node_hoverability", kNothing},
                                  Dispensable{"KHR_node_selectability", kNothing},
                                  Dispensable{"KHR_xmp_json_ld", kNothing},
                                  Dispensable{"EXT_mesh_features", kNothing},
                                  Dispensable{"EXT_structural_metadata", kNothing}};

[[noreturn]] void refuse(const std::string& file, const std::string& place, const std::string& name,
                         const std::string& remedy) {
  throw InputError(file + ": " + place + ": " + name.substr(0, 80) + " is not supported; " + remedy);
}

/// How a file uses an extension of textures.
struct Use {
  bool used = false;
  std::string only;  ///< place of the first texture without an image that this program reads; empty: there is none
};

Use use_by_textures(const Json& document, const char* name) {
  Use use;
  const Json& textures = array_of(document, "textures");
  for (std::size_t t = 0; t < textures.size(); ++t) {
    if (!has_extension(textures[t], name)) continue;
    use.used = true;
    const bool has_other =
        textures[t].contains("source") ||
        std::ranges::any_of(kImageExtensions, [&](const char* other) { return has_extension(textures[t], other); });
    if (!has_other && use.only.empty()) use.only = place_of("textures", t);
  }
  return use;
}

}  // namespace

void check_packing(const Json& document, const std::string& file, const std::set<std::string>& known,
                   std::set<std::string>& handled, std::vector<std::string>& warnings) {
  for (const Json& required : array_of(document, "extensionsRequired")) {
    const std::string name = required.get<std::string>();
    if (known.contains(name)) continue;
    const auto dispensable = std::ranges::find_if(kDispensable, [&](const Dispensable& d) { return name == d.name; });
    if (dispensable == kDispensable.end()) refuse(file, "extensionsRequired", name, remedy_of(name));
    if (handled.insert(name).second)
      warnings.push_back(file + ": extensionsRequired: " + name + " is left out: " + dispensable->rendered);
  }
  for (const Extension& extension : kExtensions) {
    if (!extension.is_of_textures) continue;
    const Use use = use_by_textures(document, extension.name);
    if (!use.only.empty()) refuse(file, use.only, extension.name, extension.remedy);
    if (!use.used) continue;
    handled.insert(extension.name);
    warnings.push_back(file + ": " + extension.name + " is not unpacked: the plain copy beside it is read");
  }
}

bool has_extension(const Json& object, const char* name) {
  const auto extensions = object.find("extensions");
  return extensions != object.end() && extensions->contains(name);
}

void mark_stand_ins(Json& document, bool has_chunk) {
  Json none = Json::array();
  Json& buffers = document.contains("buffers") ? document["buffers"] : none;
  std::vector<std::size_t> views(buffers.size(), 0), packed(buffers.size(), 0);
  const char* const names[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
  std::vector<const char*> name_of(buffers.size(), nullptr);
  for (const Json& view : array_of(document, "bufferViews")) {
    const std::size_t buffer = view["buffer"].get<std::size_t>();
    if (buffer >= buffers.size()) continue;
    ++views[buffer];
    for (const char* name : names)
      if (has_extension(view, name)) ++packed[buffer], name_of[buffer] = name;
  }
  for (std::size_t b = 0; b < buffers.size(); ++b)
    if (!buffers[b].contains("uri") && (b > 0 || !has_chunk) && views[b] > 0 && packed[b] == views[b])
      buffers[b]["extensions"][name_of[b]] = {{"fallback", true}};
}

bool is_stand_in(const Json& buffer) {
  return !buffer.contains("uri") &&
         (has_extension(buffer, "EXT_meshopt_compression") || has_extension(buffer, "KHR_meshopt_compression"));
}

bool view_is_packed_only(const Json& document, const Json& view, const char* name) {
  const Json& buffers = array_of(document, "buffers");
  const std::size_t buffer = view["buffer"].get<std::size_t>();
  return has_extension(view, name) && (buffer >= buffers.size() || is_stand_in(buffers[buffer]));
}

bool primitive_is_packed_only(const Json& document, const Json& primitive, const char* name) {
  if (!has_extension(primitive, name)) return false;
  const Json& accessors = array_of(document, "accessors");
  const auto has_bytes = [&](const Json& index) {
    const std::size_t i = index.get<std::size_t>();
    return i >= accessors.size() || accessors[i].contains("bufferView");  // indices out of range are reported later
  };
  const Json& attributes = primitive["attributes"];
  return !std::all_of(attributes.begin(), attributes.end(), has_bytes) ||
         (primitive.contains("indices") && !has_bytes(primitive["indices"]));
}

std::string remedy_of(const std::string& name) {
  const auto extension =
      std::find_if(kExtensions.begin(), kExtensions.end(), [&](const Extension& e) { return name == e.name; });
  return extension != kExtensions.end() ? extension->remedy : "export without it";
}

}  // namespace tempolux::gltf
