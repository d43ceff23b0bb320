#include "tools/info/info_facts.h"

#include <algorithm>

#include "formats/error.h"
#include "lib/core/formatted.h"
#include "lib/core/json.h"
#include "lib/image/exr_end.h"
#include "tools/common/file_head.h"

namespace tempolux::tools {
namespace {

constexpr std::size_t kMostItems = 12;  // items shown of a long list

bool is_leaf(const Facts& value) {
  if (!value.is_structured()) return true;
  const auto primitive = [](const Facts& item) { return item.is_primitive(); };
  return value.is_array() && std::ranges::all_of(value, primitive);
}

std::string leaf_text(const Facts& value) {
  if (value.is_null()) return "none";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return formatted("%.9g", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Facts& item : value) text += (text.empty() ? "" : "  ") + leaf_text(item);
  return text.empty() ? "none" : text;
}

std::string short_text(const Facts& value) { return is_leaf(value) ? leaf_text(value) : value.dump(); }

void print(const Facts& value, const std::string& indent, std::string& text);

void print_member(const std::string& key, const Facts& value, const std::string& indent, std::string& text) {
  const bool lines = value.is_array() && !value.empty() && key == "history";
  if (is_leaf(value) && !lines) {
    const std::string gap(key.size() < 20 ? 22 - key.size() : 2, ' ');
    text += indent + key + gap + leaf_text(value) + "\n";
    return;
  }
  text += indent + key + "\n";
  print(value, indent + "  ", text);
}

void print(const Facts& value, const std::string& indent, std::string& text) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items())  // manifests are long, and "mattes" sums them up
      if (!key.ends_with("/manifest")) print_member(key, member, indent, text);
    return;
  }
  std::size_t shown = 0;
  for (const Facts& item : value) {
    if (shown++ == kMostItems) {
      text += indent + "... and " + std::to_string(value.size() - kMostItems) + " more (all with --json)\n";
      return;
    }
    std::string line;
    if (item.is_object())
      for (const auto& [key, member] : item.items())
        line += (line.empty() ? "" : "   ") + key + " " + short_text(member);
    text += indent + (item.is_object() ? line : short_text(item)) + "\n";
  }
}

}  // namespace

Facts lines_of(const std::string& text) {
  Facts lines = Facts::array();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

Facts start_of(const std::string& path, const char* type, const std::string& history,
               const formats::Identity& identity) {
  Facts facts = {{"file", path}, {"type", type}, {"history", lines_of(history)}, {"identity", nullptr}};
  if (!identity.known()) return facts;
  facts["identity"]["frames"] = {identity.first_frame, identity.last_frame};
  for (const auto& [name, hash] : formats::kConcerns)
    if (!(identity.*hash).empty()) facts["identity"][std::string(name)] = identity.*hash;
  return facts;
}

Facts spread_facts(const formats::Spread& spread) {
  if (spread.count == 0) return nullptr;
  return {{"min", spread.min}, {"max", spread.max}, {"mean", spread.mean()}};
}

std::string column_names(std::initializer_list<std::pair<bool, const char*>> columns) {
  std::string names;
  for (const auto& [there, name] : columns)
    if (there) names += (names.empty() ? "" : ",") + std::string(name);
  return names.empty() ? "none" : names;
}

namespace {

/// What tempolux-info can do with a type of file. A file's type follows from its first bytes, not from its name.
struct FileType {
  const char* magic;
  Facts (*facts)(const std::string& path, bool allow_nan);
  /// Throws InputError if the file was cut off. Without: all of the file is read.
  void (*check_end)(const std::string& path) = nullptr;
  void (*export_as)(const std::string& path, const std::string& format, Output& output) = nullptr;
};

/// `totals`: bytes between the mark of the end block and its chain, by the page of the format.
template <std::size_t totals>
void container_end(const std::string& path) {
  check_container_end(path, totals);
}

template <Facts (*facts)(const std::string&)>
Facts always_valid(const std::string& path, bool) {
  return facts(path);
}

constexpr FileType kPhotons{"\x89TPHOT", always_valid<photon_facts>, container_end<104>, export_photons};
constexpr FileType kJson{"{", always_valid<json_facts>, check_json_end};
constexpr FileType kTypes[] = {kPhotons,
                               {"\x89TPATH", always_valid<paths_facts>, container_end<16>},
                               {"\x89TIRPT", always_valid<irradpoints_facts>, container_end<80>, export_irradpoints},
                               {"\x89TIRRC", always_valid<irradcache_facts>, container_end<32>, export_irradcache},
                               {"\x89TRADS", always_valid<radsamples_facts>, container_end<48>},
                               {"\x89TMESH", always_valid<meshirrad_facts>, container_end<16>},
                               {"\x76\x2f\x31\x01", image_facts, check_exr_end},
                               {"\x89PNG", image_facts, check_png_end},
                               {"\xff\xd8\xff", image_facts},
                               {"#?", image_facts},
                               {"II*", image_facts},
                               {"MM", image_facts}};

/// nullptr if the first bytes are of no type.
const FileType* type_of_bytes(const std::string& head) {
  for (const FileType& type : kTypes)
    if (head.starts_with(type.magic)) return &type;
  const std::size_t first = head.find_first_not_of(" \t\r\n");
  return first != std::string::npos && head.substr(first).starts_with(kJson.magic) ? &kJson : nullptr;
}

const FileType& type_of(const std::string& path) {
  const std::string head = head_of(path);
  if (const FileType* type = type_of_bytes(head)) return *type;
  if (path == "-") return kPhotons;  // the reader of photons reports any error
  if (head.starts_with("glTF"))
    throw InputError(
        path + ": a scene, which is not listed here; scene-plan SCENE -o FOLDER writes what moves to FOLDER/plan.json");
  throw InputError(path + ": not a file we know; it is none of our formats, no image and no JSON");
}

/// The facts that are not the same in both, by JSON Pointer, with both values; null: this file lacks the fact.
Facts differing_facts(const Facts& a, const Facts& b) {
  const Facts of_a = a.flatten(), of_b = b.flatten();
  Facts differing = Facts::object();
  const auto value_in = [](const Facts& facts, const std::string& place) {
    return facts.contains(place) ? facts[place] : Facts();
  };
  for (const Facts* either : {&of_a, &of_b})
    for (const auto& [place, unused] : either->items())
      if (value_in(of_a, place) != value_in(of_b, place))
        differing[place] = {value_in(of_a, place), value_in(of_b, place)};
  return differing;
}

}  // namespace

bool is_meshirrad(const std::string& path) { return type_of(path).facts == always_valid<meshirrad_facts>; }

Facts facts_of(const std::string& path, bool allow_nan) { return type_of(path).facts(path, allow_nan); }

void check_end(const std::string& path) {
  const std::string head = head_of(path);
  const auto begins = [&](const FileType& type) { return std::string_view(type.magic).starts_with(head); };
  const FileType* type = type_of_bytes(head);
  if (!type && (begins(kPhotons) || std::ranges::any_of(kTypes, begins)))
    throw InputError(path + ": byte " + std::to_string(head.size()) + ": the file is cut off; write it again");
  if (!type) return;
  type->check_end ? type->check_end(path) : void(type->facts(path, true));
}

Facts difference_of(const std::string& a, const std::string& b) {
  const auto type = type_of(a).facts;
  if (type != type_of(b).facts) throw InputError(b + ": of another type than " + a + "; nothing to compare");
  Facts of_a = type(a, true), of_b = type(b, true);
  const Facts digests = {of_a["digest"], of_b["digest"]};
  for (Facts* facts : {&of_a, &of_b})
    for (const char* key : {"file", "digest"}) facts->erase(key);
  Facts facts = {{"files", {a, b}}, {"type", of_a["type"]}, {"equal", digests[0] == digests[1]}};
  facts["differing"] = differing_facts(of_a, of_b);
  if (type == image_facts && of_a["width"] == of_b["width"] && of_a["height"] == of_b["height"])
    facts["channels_differing"] = channel_differences_of(a, b);
  facts["digests"] = digests;
  return facts;
}

void export_points(const std::string& path, const std::string& format, Output& output) {
  const FileType& type = type_of(path);
  if (!type.export_as) throw InputError(path + ": holds no points to export; use --png or --json");
  type.export_as(path, format, output);
}

std::string facts_as_text(const Facts& facts) {
  std::string text;
  print(facts, "", text);
  return text;
}

}  // namespace tempolux::tools
