// lib/scene/gltf_json.cpp -- parses and checks the JSON of a glTF file.
#include "lib/scene/gltf_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "formats/error.h"

namespace tempolux::gltf {
namespace {

constexpr std::size_t kMaxDepth = 64;
constexpr std::size_t kMaxValues = 8'000'000;

/// Counts values without storing them.
class Counter final : public nlohmann::json_sax<Json> {
 public:
  std::string trouble;
  std::size_t trouble_byte = 0;

  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(number_integer_t) override { return count(); }
  bool number_unsigned(number_unsigned_t) override { return count(); }
  bool number_float(number_float_t, const string_t&) override { return count(); }
  bool string(string_t&) override { return count(); }
  bool binary(binary_t&) override { return count(); }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return enter(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t byte, const std::string&, const nlohmann::detail::exception& error) override {
    trouble = what_is_wrong(error.what());
    trouble_byte = byte;
    return false;
  }

 private:
  std::size_t depth_ = 0, values_ = 0;

  /// Shortens the parser's message "[json...101] parse error at line 1, column 2: WHAT - DETAIL; last read: ..." to
  /// "column 2: WHAT - DETAIL", without bytes of the file.
  static std::string what_is_wrong(std::string text) {
    text = text.substr(0, text.find("; last read"));
    if (const std::size_t at = text.find("column "); at != std::string::npos) text = text.substr(at);
    return text.substr(0, 200) + "; mend it, or export the scene again";
  }
  bool count() {
    if (++values_ <= kMaxValues) return true;
    trouble = "more than " + std::to_string(kMaxValues) + " values";
    return false;
  }
  bool enter() {
    if (++depth_ > kMaxDepth) {
      trouble = "nested deeper than " + std::to_string(kMaxDepth) + " levels";
      return false;
    }
    return count();
  }
  bool leave() {
    --depth_;
    return true;
  }
};

// ---- types ----------------------------------------------------------------------------------------------

enum class Type { boolean, string, number, numbers, index, indices, size, strings, index_map, object, objects };

bool is_whole(Json& value, double limit) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (!(number >= 0 && number < 9e15 && number == std::floor(number))) return false;
    value = std::uint64_t(number);
  }
  return value.is_number_unsigned() && double(value.get<std::uint64_t>()) <= limit;
}
bool is_index(Json& value) { return is_whole(value, 2147483647.0); }
bool all_of(Json& values, bool (*test)(Json&)) { return std::all_of(values.begin(), values.end(), test); }

/// What a property of a Type must be, in words and as a test, which makes whole numbers integers.
struct TypeRule {
  const char* words;
  bool (*fits)(Json& value);
};
const std::array<TypeRule, 11> kTypes{
    {{"true or false", [](Json& v) { return v.is_boolean(); }},
     {"a string", [](Json& v) { return v.is_string(); }},
     {"a number", [](Json& v) { return v.is_number(); }},
     {"an array of numbers", [](Json& v) { return v.is_array() && all_of(v, [](Json& e) { return e.is_number(); }); }},
     {"a whole number from 0 to 2147483647", is_index},
     {"an array of whole numbers from 0 to 2147483647", [](Json& v) { return v.is_array() && all_of(v, is_index); }},
     {"a whole number, 0 or more", [](Json& v) { return is_whole(v, 1e18); }},
     {"an array of strings", [](Json& v) { return v.is_array() && all_of(v, [](Json& e) { return e.is_string(); }); }},
     {"an object of whole numbers from 0 to 2147483647", [](Json& v) { return v.is_object() && all_of(v, is_index); }},
     {"an object", [](Json& v) { return v.is_object(); }},
     {"an array of objects",
      [](Json& v) { return v.is_array() && all_of(v, [](Json& e) { return e.is_object(); }); }}}};

/// What happens to a value of the wrong type.
enum class Need {
  optional,  ///< it is left out with a warning, so that the default holds
  decisive,  ///< the file is refused: without the value, other data would be read wrongly
  required,  ///< likewise, and also if it is missing
};

struct Rule {
  std::string_view key;
  Type type;
  Need need = Need::optional;
  const std::vector<Rule>* inside = nullptr;  ///< rules for the object, or for each object of the array
  bool loose = false;  ///< an invalid object of the array is left out; nothing counts the others by index
};

constexpr Need kRequired = Need::required, kDecisive = Need::decisive;
constexpr bool kLoose = true;
using Rules = std::vector<Rule>;

// Properties of glTF 2.0 (section 5 of the specification) that tinygltf or this program reads.
const Rules kAsset{{"version", Type::string, kRequired}, {"minVersion", Type::string}};
const Rules kScene{{"name", Type::string}, {"nodes", Type::indices}};
const Rules kNode{{"name", Type::string},      {"children", Type::indices}, {"mesh", Type::index},
                  {"camera", Type::index},     {"skin", Type::index},       {"matrix", Type::numbers},
                  {"rotation", Type::numbers}, {"scale", Type::numbers},    {"translation", Type::numbers},
                  {"weights", Type::numbers}};
const Rules kTarget{};  // all its properties are indices
const Rules kPrimitive{{"attributes", Type::index_map, kRequired},
                       {"indices", Type::index, kDecisive},
                       {"material", Type::index},
                       {"mode", Type::index, kDecisive},
                       {"targets", Type::objects, Need::optional, &kTarget}};
const Rules kMesh{
    {"name", Type::string}, {"primitives", Type::objects, kRequired, &kPrimitive, kLoose}, {"weights", Type::numbers}};
const Rules kSparseIndices{{"bufferView", Type::index, kRequired},
                           {"byteOffset", Type::index, kDecisive},
                           {"componentType", Type::index, kRequired}};
const Rules kSparseValues{{"bufferView", Type::index, kRequired}, {"byteOffset", Type::index, kDecisive}};
const Rules kSparse{{"count", Type::index, kRequired},
                    {"indices", Type::object, kRequired, &kSparseIndices},
                    {"values", Type::object, kRequired, &kSparseValues}};
const Rules kAccessor{{"name", Type::string},
                      {"bufferView", Type::index, kDecisive},
                      {"byteOffset", Type::size, kDecisive},
                      {"componentType", Type::index, kRequired},
                      {"normalized", Type::boolean},
                      {"count", Type::size, kRequired},
                      {"type", Type::string, kRequired},
                      {"sparse", Type::object, kDecisive, &kSparse},
                      {"min", Type::numbers},
                      {"max", Type::numbers}};
const Rules kBufferView{{"name", Type::string},
                        {"buffer", Type::index, kRequired},
                        {"byteOffset", Type::size, kDecisive},
                        {"byteLength", Type::size, kRequired},
                        {"byteStride", Type::size, kDecisive},
                        {"target", Type::index}};
const Rules kBuffer{{"name", Type::string}, {"uri", Type::string, kDecisive}, {"byteLength", Type::size, kRequired}};
const Rules kTextureInfo{
    {"index", Type::index, kRequired}, {"texCoord", Type::index}, {"scale", Type::number}, {"strength", Type::number}};
const Rules kPbr{{"baseColorFactor", Type::numbers},
                 {"metallicFactor", Type::number},
                 {"roughnessFactor", Type::number},
                 {"baseColorTexture", Type::object, Need::optional, &kTextureInfo},
                 {"metallicRoughnessTexture", Type::object, Need::optional, &kTextureInfo}};
const Rules kMaterial{{"name", Type::string},
                      {"pbrMetallicRoughness", Type::object, Need::optional, &kPbr},
                      {"normalTexture", Type::object, Need::optional, &kTextureInfo},
                      {"occlusionTexture", Type::object, Need::optional, &kTextureInfo},
                      {"emissiveTexture", Type::object, Need::optional, &kTextureInfo},
                      {"emissiveFactor", Type::numbers},
                      {"alphaMode", Type::string},
                      {"alphaCutoff", Type::number},
                      {"doubleSided", Type::boolean}};
const Rules kTexture{{"name", Type::string}, {"source", Type::index}, {"sampler", Type::index}};
const Rules kImage{
    {"name", Type::string}, {"uri", Type::string}, {"bufferView", Type::index}, {"mimeType", Type::string}};
const Rules kSampler{
    {"magFilter", Type::index}, {"minFilter", Type::index}, {"wrapS", Type::index}, {"wrapT", Type::index}};
const Rules kSkin{{"name", Type::string},
                  {"joints", Type::indices, kRequired},
                  {"skeleton", Type::index},
                  {"inverseBindMatrices", Type::index}};
// mend_cameras() and mend_lights() replace what these lack.
const Rules kPerspective{
    {"aspectRatio", Type::number}, {"yfov", Type::number}, {"zfar", Type::number}, {"znear", Type::number}};
const Rules kOrthographic{
    {"xmag", Type::number}, {"ymag", Type::number}, {"zfar", Type::number}, {"znear", Type::number}};
const Rules kCamera{{"name", Type::string},
                    {"type", Type::string},
                    {"perspective", Type::object, Need::optional, &kPerspective},
                    {"orthographic", Type::object, Need::optional, &kOrthographic}};
const Rules kChannelTarget{{"node", Type::index}, {"path", Type::string, kRequired}};
const Rules kChannel{{"sampler", Type::index, kRequired}, {"target", Type::object, kRequired, &kChannelTarget}};
const Rules kAnimationSampler{
    {"input", Type::index, kRequired}, {"output", Type::index, kRequired}, {"interpolation", Type::string}};
const Rules kAnimation{{"name", Type::string},
                       {"channels", Type::objects, kRequired, &kChannel, kLoose},
                       {"samplers", Type::objects, kRequired, &kAnimationSampler}};
const Rules kSpot{{"innerConeAngle", Type::number}, {"outerConeAngle", Type::number}};
const Rules kLight{{"name", Type::string},   {"type", Type::string},
                   {"color", Type::numbers}, {"intensity", Type::number},
                   {"range", Type::number},  {"spot", Type::object, Need::optional, &kSpot}};
const Rules kLights{{"lights", Type::objects, kRequired, &kLight}};
const Rules kDraco{{"bufferView", Type::index, kRequired}, {"attributes", Type::index_map, kRequired}};
const Rules kMeshopt{{"buffer", Type::index, kRequired},
                     {"byteOffset", Type::size},
                     {"byteLength", Type::size, kRequired},
                     {"byteStride", Type::size, kRequired},
                     {"mode", Type::string, kRequired},
                     {"count", Type::size, kRequired},
                     {"filter", Type::string}};
const Rules kImageSource{{"source", Type::index, kRequired}};
const Rules kRootExtensions{{"KHR_lights_punctual", Type::object, Need::optional, &kLights}};
const Rules kRoot{{"asset", Type::object, kRequired, &kAsset},
                  {"extensionsUsed", Type::strings},
                  {"extensionsRequired", Type::strings},
                  {"scene", Type::index},
                  {"scenes", Type::objects, kDecisive, &kScene},
                  {"nodes", Type::objects, kDecisive, &kNode},
                  {"meshes", Type::objects, kDecisive, &kMesh},
                  {"accessors", Type::objects, kDecisive, &kAccessor},
                  {"bufferViews", Type::objects, kDecisive, &kBufferView},
                  {"buffers", Type::objects, kDecisive, &kBuffer},
                  {"materials", Type::objects, Need::optional, &kMaterial},
                  {"textures", Type::objects, Need::optional, &kTexture},
                  {"images", Type::objects, Need::optional, &kImage},
                  {"samplers", Type::objects, Need::optional, &kSampler},
                  {"skins", Type::objects, Need::optional, &kSkin},
                  {"cameras", Type::objects, Need::optional, &kCamera},
                  {"animations", Type::objects, Need::optional, &kAnimation, kLoose},
                  {"extensions", Type::object, Need::optional, &kRootExtensions}};

/// An invalid value, without the name of the file.
struct Fault {
  std::string place, what;
};

std::string text_of(const Json& value) {
  return one_line(
      value.is_structured() && value.size() > 4 ? std::string(value.type_name()) : value.dump(-1, ' ', true), 40);
}

/// Checks objects against the rules of their properties. The recursion is as deep as the rules, not as the file.
class Checker {
 public:
  explicit Checker(LeftOut& left_out) : left_out_(left_out) {}

  void object(Json& object, const Rules& rules, const std::string& place) const {
    const auto inside = [&](std::string_view key) { return (place.empty() ? "" : place + ".") + std::string(key); };
    for (const Rule& rule : rules) {
      const auto found = object.find(rule.key);
      if (found == object.end()) {
        if (rule.need == Need::required)
          throw Fault{inside(rule.key), std::string("is missing; it must be ") + words(rule)};
        continue;
      }
      try {
        property(*found, rule, inside(rule.key));
      } catch (const Fault& fault) {
        if (rule.need != Need::optional) throw;
        left_out_.add(inside(rule.key), fault.place == inside(rule.key) ? text_of(*found) : "",
                      fault.place == inside(rule.key) ? fault.what : fault.place + " " + fault.what);
        object.erase(found);
      }
    }
    extensions(object, inside("extensions"));
  }

 private:
  static const char* words(const Rule& rule) { return kTypes[std::size_t(rule.type)].words; }

  void property(Json& value, const Rule& rule, const std::string& place) const {
    if (rule.type == Type::index_map) indices(value, place);
    if (!kTypes[std::size_t(rule.type)].fits(value)) throw Fault{place, std::string("must be ") + words(rule)};
    if (!rule.inside) return;
    if (rule.inside == &kTarget)
      for (std::size_t i = 0; i < value.size(); ++i) indices(value[i], place + "[" + std::to_string(i) + "]");
    if (rule.type == Type::object) object(value, *rule.inside, place);
    else elements(value, rule, place);
  }

  /// Leaves out the entries of a map that are no indices.
  void indices(Json& map, const std::string& place) const {
    if (!map.is_object()) return;
    std::vector<std::string> invalid;
    for (auto& [name, value] : map.items())
      if (!is_index(value)) invalid.push_back(name);
    for (const std::string& name : invalid) {
      left_out_.add(place + "." + one_line(name, 60), text_of(map[name]),
                    std::string("must be ") + kTypes[std::size_t(Type::index)].words);
      map.erase(name);
    }
  }

  void elements(Json& array, const Rule& rule, const std::string& place) const {
    std::vector<std::size_t> invalid;
    for (std::size_t i = 0; i < array.size(); ++i) {
      const auto name = array[i].find("name");
      const std::string at =
          place_of(place.c_str(), i, name != array[i].end() && name->is_string() ? name->get<std::string>() : "");
      try {
        object(array[i], *rule.inside, at);
      } catch (const Fault& fault) {
        if (!rule.loose) throw;
        left_out_.add(at, "", fault.place + " " + fault.what);
        invalid.push_back(i);
      }
    }
    for (auto i = invalid.rbegin(); i != invalid.rend(); ++i) array.erase(*i);
  }

  void extensions(Json& object, const std::string& place) const {
    const auto extensions = object.find("extensions");
    if (extensions == object.end()) return;
    if (!extensions->is_object()) {
      left_out_.add(place, text_of(*extensions), "must be an object");
      object.erase(extensions);
      return;
    }
    std::vector<std::string> invalid;
    for (const auto& [name, value] : extensions->items())
      if (!value.is_object()) invalid.push_back(name);
    for (const std::string& name : invalid) {
      left_out_.add(place + "." + one_line(name, 60), text_of((*extensions)[name]), "must be an object");
      extensions->erase(name);
    }
  }

  LeftOut& left_out_;
};

/// Checks the object of an extension, in which nothing may be left out.
void check_extension(Json& extension, const Rules& rules, const std::string& place, const std::string& file) {
  LeftOut left_out;
  try {
    Checker(left_out).object(extension, rules, place);
  } catch (const Fault& fault) { fail(file, fault.place, fault.what); }
  if (const auto warnings = left_out.warnings(file); !warnings.empty()) throw InputError(warnings.front());
}

// ---- cameras and lights ---------------------------------------------------------------------------------

constexpr double kYfov = 0.8;  ///< rad, of a camera whose own cannot be used

void mend_camera(Json& camera, const std::string& place, LeftOut& left_out) {
  const bool knows_type =
      camera.contains("type") && (camera["type"] == "perspective" || camera["type"] == "orthographic");
  if (!knows_type) {
    const char* type = camera.contains("orthographic") ? "orthographic" : "perspective";
    left_out.replace(place + ".type", camera.contains("type") ? text_of(camera["type"]) : "",
                     "must be perspective or orthographic", type);
    camera["type"] = type;
  }
  const bool perspective = camera["type"] == "perspective";
  Json& view = camera[perspective ? "perspective" : "orthographic"];
  if (view.is_null()) view = Json::object();
  const char* key = perspective ? "yfov" : "ymag";
  const double size = view.value(key, 0.0);
  if (!(size > 0 && size < (perspective ? 3.14159265 : 1e30))) {
    left_out.replace(place + (perspective ? ".perspective.yfov" : ".orthographic.ymag"),
                     view.contains(key) ? text_of(view[key]) : "",
                     perspective ? "must lie between 0 and pi" : "must be above 0", perspective ? "0.8" : "1");
    view[key] = perspective ? kYfov : 1.0;
  }
  // tinygltf wants these, which nothing uses.
  for (const auto& [unused, value] : {std::pair{"znear", 0.01}, {"zfar", 1000.0}, {"xmag", 1.0}})
    if (!view.contains(unused) && !(perspective && unused != std::string_view("znear"))) view[unused] = value;
}

void mend_light(Json& light, const std::string& place, LeftOut& left_out) {
  const Json type = light.value("type", Json());
  if (type != "point" && type != "spot" && type != "directional") {
    left_out.add(place, type.is_null() ? "" : text_of(type), "type must be point, spot or directional");
    light["type"] = "point";
    light["intensity"] = 0;
  }
  if (light["type"] != "spot" || light.contains("spot")) return;
  left_out.replace(place + ".spot", "", "must be an object", "a cone of pi/4");
  light["spot"] = Json::object();
}

}  // namespace

void LeftOut::note(const std::string& place, const std::string& value, const std::string& what) {
  std::string kind;  // the place without indices and names
  bool inside = false;
  for (const char c : place) {
    if (c == '[') inside = true;
    if (!inside) kind += c;
    if (c == '.') inside = false;
  }
  Kind& of = kinds_[kind + what];
  if (of.count++ == 0) of = {place, value, what, 1};
}

void LeftOut::add(const std::string& place, const std::string& value, const std::string& what) {
  note(place, value, "is left out: " + what);
}

void LeftOut::replace(const std::string& place, const std::string& value, const std::string& what,
                      const std::string& by) {
  note(place, value,
       (value.empty() ? "is missing" : "is replaced") + std::string(": ") + what + "; " + by + " is taken");
}

std::vector<std::string> LeftOut::warnings(const std::string& file) const {
  std::vector<std::string> warnings;
  for (const auto& [kind, of] : kinds_)
    warnings.push_back(file + ": " + of.place + (of.count > 1 ? " and " + std::to_string(of.count - 1) + " more" : "") +
                       ": " + (of.value.empty() ? "" : of.value + " ") + of.what);
  return warnings;
}

namespace {

/// The recursion is as deep as parse_json() allows.
void leave_out_nulls(Json& value, const std::string& place, bool in_extension, LeftOut& left_out) {
  const auto inside = [&](const std::string& key) { return (place.empty() ? "" : place + ".") + one_line(key, 60); };
  if (value.is_object()) {
    for (auto it = value.begin(); it != value.end();) {
      if (in_extension && it->is_null()) {
        left_out.add(inside(it.key()), "null", "has no value");
        it = value.erase(it);
        continue;
      }
      if (it->is_structured())
        leave_out_nulls(*it, inside(it.key()), in_extension || it.key() == "extensions", left_out);
      ++it;
    }
  } else if (value.is_array() && !value.empty() && value.front().is_object()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      if (value[i].is_structured()) leave_out_nulls(value[i], place_of(place.c_str(), i), in_extension, left_out);
  }
}

}  // namespace

void leave_out_nulls(Json& document, LeftOut& left_out) { leave_out_nulls(document, "", false, left_out); }

void mend_cameras(Json& document, LeftOut& left_out) {
  if (!document.contains("cameras")) return;
  Json& cameras = document["cameras"];
  for (std::size_t i = 0; i < cameras.size(); ++i)
    mend_camera(cameras[i], place_of("cameras", i, cameras[i].value("name", "")), left_out);
}

void mend_lights(Json& document, LeftOut& left_out) {
  const Json::json_pointer place("/extensions/KHR_lights_punctual/lights");
  if (!document.contains(place)) return;
  Json& lights = document[place];
  for (std::size_t i = 0; i < lights.size(); ++i)
    mend_light(lights[i], place_of("extensions.KHR_lights_punctual.lights", i, lights[i].value("name", "")), left_out);
}

namespace {

// ---- pruning --------------------------------------------------------------------------------------------

constexpr std::size_t kMaxExtensionValues = 1'000'000;

std::size_t value_count(const Json& value) {
  std::size_t count = 1;
  if (value.is_structured())
    for (const Json& inside : value) count += value_count(inside);
  return count;
}

/// Removes extras and unknown extensions. Returns the number of values in known extensions. parse_json() has limited
/// the depth of the recursion.
std::size_t prune_value(Json& value, const std::set<std::string>& known, std::set<std::string>& unknown) {
  std::size_t kept = 0;
  if (value.is_object()) {
    value.erase("extras");
    if (const auto extensions = value.find("extensions"); extensions != value.end()) {
      for (auto it = extensions->begin(); it != extensions->end();) {
        if (known.contains(it.key())) {
          kept += value_count(*it++);
        } else {
          unknown.insert(it.key());
          it = extensions->erase(it);
        }
      }
    }
  }
  if (value.is_structured())
    for (Json& inside : value) kept += prune_value(inside, known, unknown);
  return kept;
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first != std::string_view::npos && text[first] != '{' && text[first] != '[')
    throw InputError(
        file + ": is neither a .glb nor a .gltf file; export the scene as glTF 2.0 (a .blend: docs/from-blender.md)");
  Counter counter;
  if (!Json::sax_parse(text.begin(), text.end(), &counter)) {
    const auto line =
        1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(std::min(counter.trouble_byte, text.size())), '\n');
    fail(file, counter.trouble_byte > 0 ? "line " + std::to_string(line) : "JSON", counter.trouble);
  }
  Json document = Json::parse(text.begin(), text.end());
  if (!document.is_object()) fail(file, "JSON", "is not an object; this is no glTF file");
  return document;
}

const Json& array_of(const Json& document, const char* key) {
  static const Json none = Json::array();
  const auto found = document.find(key);
  return found == document.end() ? none : *found;
}

void check_types(Json& document, const std::string& file, LeftOut& left_out) {
  try {
    Checker(left_out).object(document, kRoot, "");
  } catch (const Fault& fault) { fail(file, fault.place, fault.what); }
}

void check_draco(Json& extension, const std::string& place, const std::string& file) {
  check_extension(extension, kDraco, place, file);
}
void check_meshopt(Json& extension, const std::string& place, const std::string& file) {
  check_extension(extension, kMeshopt, place, file);
}
void check_image_source(Json& extension, const std::string& place, const std::string& file) {
  check_extension(extension, kImageSource, place, file);
}

void prune(Json& document, const std::set<std::string>& known, std::set<std::string>& unknown,
           const std::string& file) {
  if (prune_value(document, known, unknown) > kMaxExtensionValues)
    fail(file, "extensions", "hold more than " + std::to_string(kMaxExtensionValues) + " values");
}

}  // namespace tempolux::gltf
