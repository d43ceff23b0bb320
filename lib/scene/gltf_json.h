// lib/scene/gltf_json.h -- parses the JSON of a glTF file and checks its types; private to the gate.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/json.h"
#include "lib/scene/gltf_place.h"

namespace tempolux::gltf {

using Json = nlohmann::json;

/// Parses JSON. A first pass counts values and levels: at most 8 million values and 64 levels, so that a hostile file
/// can exhaust neither memory nor stack. Throws InputError that names the line.
Json parse_json(std::string_view text, const std::string& file);

/// An array of the document by its key; empty if it is missing.
const Json& array_of(const Json& document, const char* key);

/// Collects what is left out of a document or replaced there: one warning for each kind of place and reason.
class LeftOut {
 public:
  /// `value` was left out, since it `what`: "must be a number". "": the whole object, or there was no value.
  void add(const std::string& place, const std::string& value, const std::string& what);
  /// `by` replaced the value.
  void replace(const std::string& place, const std::string& value, const std::string& what, const std::string& by);
  /// "FILE: PLACE and 3 more: VALUE is left out: must be a number".
  std::vector<std::string> warnings(const std::string& file) const;

 private:
  void note(const std::string& place, const std::string& value, const std::string& what);
  struct Kind {
    std::string place, value, what;
    std::size_t count = 0;
  };
  std::map<std::string, Kind> kinds_;
};

/// Checks the type of every property of glTF 2.0 that is read later, and that required properties exist. Whole numbers
/// that are written with a fraction (3.0) become integers. A property that glTF does not require and without which
/// other data keep their meaning is left out if its type is wrong; likewise a primitive, an animation or a channel.
/// Throws InputError that names the place for any other fault.
void check_types(Json& document, const std::string& file, LeftOut& left_out);

/// Leaves out every null inside the extensions that prune() has kept: tinygltf drops them silently.
void leave_out_nulls(Json& document, LeftOut& left_out);

/// Replaces what a camera needs and does not have: type, angle of view. Call after check_types().
void mend_cameras(Json& document, LeftOut& left_out);
/// A lamp of an unknown type becomes dark; a spot without a cone gets glTF's. Call after check_types().
void mend_lights(Json& document, LeftOut& left_out);

/// Checks the properties of an extension's object at `place` likewise: KHR_draco_mesh_compression of a primitive, EXT_
/// or KHR_meshopt_compression of a bufferView, EXT_texture_webp or EXT_texture_avif of a texture.
void check_draco(Json& extension, const std::string& place, const std::string& file);
void check_meshopt(Json& extension, const std::string& place, const std::string& file);
void check_image_source(Json& extension, const std::string& place, const std::string& file);

/// Removes all `extras` and all extensions whose name is not in `known`, since tinygltf needs 200 bytes for each of
/// their values. The names of removed extensions go to `unknown`. Throws InputError if the known extensions hold more
/// than a million values.
void prune(Json& document, const std::set<std::string>& known, std::set<std::string>& unknown, const std::string& file);

}  // namespace tempolux::gltf
