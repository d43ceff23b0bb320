// lib/scene/gltf_extensions.cpp
#include "lib/scene/gltf_extensions.h"

#include <algorithm>
#include <array>

#include "formats/error.h"

namespace tempolux::gltf {
namespace {

/// What an extension stores in a form of its own.
enum class Packs { geometry_of_primitives, buffer_views, textures, nothing };

struct Extension {
  const char* name;
  Packs packs;
  const char* remedy;
};

// `gltf-transform cp` writes geometry unpacked. `gltf-transform png` leaves WebP as it is unless told otherwise;
// `ktxdecompress` calls the program ktx. gltfpack reads packed files from version 0.22 on.
constexpr const char* kUnpack = "unpack it with `gltf-transform cp IN.glb OUT.glb`";
constexpr const char* kToPng = "convert its textures with `gltf-transform png IN.glb OUT.glb --formats '*'`";
constexpr std::array kExtensions{
    Extension{"KHR_draco_mesh_compression", Packs::geometry_of_primitives,
              "unpack it with `gltf-transform cp IN.glb OUT.glb`, or export without Compression"},
    Extension{"EXT_meshopt_compression", Packs::buffer_views,
              "unpack it with `gltf-transform cp IN.glb OUT.glb` or `gltfpack -noq -kn -i IN.glb -o OUT.glb`"},
    Extension{"KHR_meshopt_compression", Packs::buffer_views,
              "unpack it with `gltfpack -noq -kn -i IN.glb -o OUT.glb`"},
    Extension{"EXT_texture_webp", Packs::textures, kToPng},
    Extension{"EXT_texture_avif", Packs::textures, kToPng},
    Extension{"KHR_texture_basisu", Packs::textures,
              "convert its textures with `gltf-transform ktxdecompress IN.glb OUT.glb` (it calls ktx of KTX-Software)"},
    Extension{"KHR_materials_pbrSpecularGlossiness", Packs::nothing,
              "convert its materials with `gltf-transform metalrough IN.glb OUT.glb`"},
    Extension{"KHR_gaussian_splatting", Packs::nothing, "only triangles can be rendered"}};

[[noreturn]] void refuse(const std::string& file, const std::string& place, const std::string& name,
                         const std::string& remedy) {
  throw InputError(file + ": " + place + ": " + name.substr(0, 80) + " is not supported; " + remedy);
}

std::string numbered(const char* array, std::size_t index) {
  return std::string(array) + "[" + std::to_string(index) + "]";
}

bool has_extension(const Json& object, const char* name) {
  const auto extensions = object.find("extensions");
  return extensions != object.end() && extensions->contains(name);
}

/// Where the file uses an extension, and where it has nothing but that.
struct Use {
  bool used = false;
  std::string only;  ///< place of the first data without a fallback; empty: all have one
  void found(bool has_fallback, const std::string& place) {
    used = true;
    if (!has_fallback && only.empty()) only = place;
  }
};

/// A primitive has its geometry unpacked too if all its accessors have bytes.
Use use_by_primitives(const Json& document, const char* name) {
  Use use;
  const Json &accessors = array_of(document, "accessors"), &meshes = array_of(document, "meshes");
  const auto has_bytes = [&](const Json& index) {
    const std::size_t i = index.get<std::size_t>();
    return i >= accessors.size() || accessors[i].contains("bufferView");  // beyond: said later
  };
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (const Json& primitive : meshes[m]["primitives"]) {
      if (!has_extension(primitive, name)) continue;
      const Json& attributes = primitive["attributes"];
      const bool all = std::all_of(attributes.begin(), attributes.end(), has_bytes) &&
                       (!primitive.contains("indices") || has_bytes(primitive["indices"]));
      use.found(all, numbered("meshes", m));
    }
  return use;
}

/// A buffer that only stands for what unpacking gives has no bytes: no URI, nor is it the binary chunk.
Use use_by_views(const Json& document, const char* name) {
  Use use;
  const Json &buffers = array_of(document, "buffers"), &views = array_of(document, "bufferViews");
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!has_extension(views[v], name)) continue;
    const std::size_t b = views[v]["buffer"].get<std::size_t>();
    const bool is_stand_in = b < buffers.size() && has_extension(buffers[b], name) && !buffers[b].contains("uri");
    use.found(!is_stand_in, numbered("bufferViews", v));
  }
  return use;
}

Use use_by_textures(const Json& document, const char* name) {
  Use use;
  const Json& textures = array_of(document, "textures");
  for (std::size_t t = 0; t < textures.size(); ++t)
    if (has_extension(textures[t], name)) use.found(textures[t].contains("source"), numbered("textures", t));
  return use;
}

Use use_of(const Extension& extension, const Json& document) {
  switch (extension.packs) {
    case Packs::geometry_of_primitives:
      return use_by_primitives(document, extension.name);
    case Packs::buffer_views:
      return use_by_views(document, extension.name);
    case Packs::textures:
      return use_by_textures(document, extension.name);
    case Packs::nothing:
      break;
  }
  return {};
}

}  // namespace

void check_packing(const Json& document, const std::string& file, const std::set<std::string>& known,
                   std::set<std::string>& handled, std::vector<std::string>& warnings) {
  for (const Json& required : array_of(document, "extensionsRequired")) {
    const std::string name = required.get<std::string>();
    const auto extension = std::find_if(kExtensions.begin(), kExtensions.end(),
                                        [&](const Extension& e) { return name == e.name; });
    if (known.contains(name)) continue;
    refuse(file, "extensionsRequired", name,
           extension != kExtensions.end() ? extension->remedy : "export without it");
  }
  for (const Extension& extension : kExtensions) {
    if (known.contains(extension.name) || extension.packs == Packs::nothing) continue;
    const Use use = use_of(extension, document);
    if (!use.only.empty()) refuse(file, use.only, extension.name, extension.remedy);
    if (!use.used) continue;
    handled.insert(extension.name);
    warnings.push_back(file + ": " + extension.name + " is not unpacked: the plain copy beside it is read");
  }
}

}  // namespace tempolux::gltf
