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

struct Rule {
  std::string_view key;
  Type type;
  bool required = false;
  const std::vector<Rule>* inside = nullptr;  ///< rules for the object, or for each object of the array
};

constexpr bool kRequired = true;
using Rules = std::vector<Rule>;

// Properties of glTF 2.0 (section 5 of the specification) that tinygltf or this program reads.
const Rules kAsset{{"version", Type::string, kRequired}, {"minVersion", Type::string}};
const Rules kScene{{"name", Type::string}, {"nodes", Type::indices}};
const Rules kNode{{"name", Type::string},      {"children", Type::indices}, {"mesh", Type::index},
                  {"camera", Type::index},     {"skin", Type::index},       {"matrix", Type::numbers},
                  {"rotation", Type::numbers}, {"scale", Type::numbers},    {"translation", Type::numbers},
                  {"weights", Type::numbers}};
const Rules kTarget{};
const Rules kPrimitive{{"attributes", Type::index_map, kRequired},
                       {"indices", Type::index},
                       {"material", Type::index},
                       {"mode", Type::index},
                       {"targets", Type::objects, false, &kTarget}};
const Rules kMesh{
    {"name", Type::string}, {"primitives", Type::objects, kRequired, &kPrimitive}, {"weights", Type::numbers}};
const Rules kSparseIndices{
    {"bufferView", Type::index, kRequired}, {"byteOffset", Type::index}, {"componentType", Type::index, kRequired}};
const Rules kSparseValues{{"bufferView", Type::index, kRequired}, {"byteOffset", Type::index}};
const Rules kSparse{{"count", Type::index, kRequired},
                    {"indices", Type::object, kRequired, &kSparseIndices},
                    {"values", Type::object, kRequired, &kSparseValues}};
const Rules kAccessor{{"name", Type::string},
                      {"bufferView", Type::index},
                      {"byteOffset", Type::size},
                      {"componentType", Type::index, kRequired},
                      {"normalized", Type::boolean},
                      {"count", Type::size, kRequired},
                      {"type", Type::string, kRequired},
                      {"sparse", Type::object, false, &kSparse},
                      {"min", Type::numbers},
                      {"max", Type::numbers}};
const Rules kBufferView{{"name", Type::string},     {"buffer", Type::index, kRequired},
                        {"byteOffset", Type::size}, {"byteLength", Type::size, kRequired},
                        {"byteStride", Type::size}, {"target", Type::index}};
const Rules kBuffer{{"name", Type::string}, {"uri", Type::string}, {"byteLength", Type::size, kRequired}};
const Rules kTextureInfo{
    {"index", Type::index, kRequired}, {"texCoord", Type::index}, {"scale", Type::number}, {"strength", Type::number}};
const Rules kPbr{{"baseColorFactor", Type::numbers},
                 {"metallicFactor", Type::number},
                 {"roughnessFactor", Type::number},
                 {"baseColorTexture", Type::object, false, &kTextureInfo},
                 {"metallicRoughnessTexture", Type::object, false, &kTextureInfo}};
const Rules kMaterial{{"name", Type::string},
                      {"pbrMetallicRoughness", Type::object, false, &kPbr},
                      {"normalTexture", Type::object, false, &kTextureInfo},
                      {"occlusionTexture", Type::object, false, &kTextureInfo},
                      {"emissiveTexture", Type::object, false, &kTextureInfo},
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
const Rules kPerspective{{"aspectRatio", Type::number},
                         {"yfov", Type::number, kRequired},
                         {"zfar", Type::number},
                         {"znear", Type::number, kRequired}};
const Rules kOrthographic{{"xmag", Type::number, kRequired},
                          {"ymag", Type::number, kRequired},
                          {"zfar", Type::number, kRequired},
                          {"znear", Type::number, kRequired}};
const Rules kCamera{{"name", Type::string},
                    {"type", Type::string, kRequired},
                    {"perspective", Type::object, false, &kPerspective},
                    {"orthographic", Type::object, false, &kOrthographic}};
const Rules kChannelTarget{{"node", Type::index}, {"path", Type::string, kRequired}};
const Rules kChannel{{"sampler", Type::index, kRequired}, {"target", Type::object, kRequired, &kChannelTarget}};
const Rules kAnimationSampler{
    {"input", Type::index, kRequired}, {"output", Type::index, kRequired}, {"interpolation", Type::string}};
const Rules kAnimation{{"name", Type::string},
                       {"channels", Type::objects, kRequired, &kChannel},
                       {"samplers", Type::objects, kRequired, &kAnimationSampler}};
const Rules kSpot{{"innerConeAngle", Type::number}, {"outerConeAngle", Type::number}};
const Rules kLight{{"name", Type::string},   {"type", Type::string, kRequired},
                   {"color", Type::numbers}, {"intensity", Type::number},
                   {"range", Type::number},  {"spot", Type::object, false, &kSpot}};
const Rules kLights{{"lights", Type::objects, kRequired, &kLight}};
const Rules kDraco{{"bufferView", Type::index, kRequired}, {"attributes", Type::index_map, kRequired}};
const Rules kMeshopt{{"buffer", Type::index, kRequired},
                     {"byteOffset", Type::size},
                     {"byteLength", Type::size, kRequired},
                     {"byteStride", Type::size, kRequired},
                     {"mode", Type::string, kRequired},
                     {"count", Type::size, kRequired},
                     {"filter", Type::string}};
const Rules kWebp{{"source", Type::index, kRequired}};
const Rules kRootExtensions{{"KHR_lights_punctual", Type::object, false, &kLights}};
const Rules kRoot{{"asset", Type::object, kRequired, &kAsset},
                  {"extensionsUsed", Type::strings},
                  {"extensionsRequired", Type::strings},
                  {"scene", Type::index},
                  {"scenes", Type::objects, false, &kScene},
                  {"nodes", Type::objects, false, &kNode},
                  {"meshes", Type::objects, false, &kMesh},
                  {"accessors", Type::objects, false, &kAccessor},
                  {"bufferViews", Type::objects, false, &kBufferView},
                  {"buffers", Type::objects, false, &kBuffer},
                  {"materials", Type::objects, false, &kMaterial},
                  {"textures", Type::objects, false, &kTexture},
                  {"images", Type::objects, false, &kImage},
                  {"samplers", Type::objects, false, &kSampler},
                  {"skins", Type::objects, false, &kSkin},
                  {"cameras", Type::objects, false, &kCamera},
                  {"animations", Type::objects, false, &kAnimation},
                  {"extensions", Type::object, false, &kRootExtensions}};

void check_object(Json& object, const Rules& rules, const std::string& place, const std::string& file);

void check_property(Json& value, const Rule& rule, const std::string& place, const std::string& file) {
  const TypeRule& type = kTypes[std::size_t(rule.type)];
  if (!type.fits(value)) fail(file, place, std::string("must be ") + type.words);
  if (rule.type == Type::object && rule.inside) check_object(value, *rule.inside, place, file);
  if (rule.type == Type::objects && rule.inside)
    for (std::size_t i = 0; i < value.size(); ++i)
      check_object(value[i], *rule.inside, place + "[" + std::to_string(i) + "]", file);
}

/// Checks an object against the rules of its properties. The recursion is as deep as the rules, not as the file.
void check_object(Json& object, const Rules& rules, const std::string& place, const std::string& file) {
  const auto inside = [&](std::string_view key) { return (place.empty() ? "" : place + ".") + std::string(key); };
  for (const Rule& rule : rules) {
    const auto found = object.find(rule.key);
    if (found != object.end()) check_property(*found, rule, inside(rule.key), file);
    else if (rule.required)
      fail(file, inside(rule.key), std::string("is missing; it must be ") + kTypes[std::size_t(rule.type)].words);
  }
  const auto extensions = object.find("extensions");
  if (extensions == object.end()) return;
  if (!extensions->is_object()) fail(file, inside("extensions"), "must be an object");
  for (const auto& [name, value] : extensions->items())
    if (!value.is_object()) fail(file, inside("extensions." + name.substr(0, 60)), "must be an object");
}

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

void check_types(Json& document, const std::string& file) { check_object(document, kRoot, "", file); }

void check_draco(Json& extension, const std::string& place, const std::string& file) {
  check_object(extension, kDraco, place, file);
}
void check_meshopt(Json& extension, const std::string& place, const std::string& file) {
  check_object(extension, kMeshopt, place, file);
}
void check_webp(Json& extension, const std::string& place, const std::string& file) {
  check_object(extension, kWebp, place, file);
}

void prune(Json& document, const std::set<std::string>& known, std::set<std::string>& unknown,
           const std::string& file) {
  if (prune_value(document, known, unknown) > kMaxExtensionValues)
    fail(file, "extensions", "hold more than " + std::to_string(kMaxExtensionValues) + " values");
}

}  // namespace tempolux::gltf
