#include "tools/info/info_facts.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/error.h"
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
  if (value.is_number_float()) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value.get<double>());
    return text;
  }
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
    for (const auto& [key, member] : value.items()) print_member(key, member, indent, text);
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

Facts identity_facts(const formats::Identity& identity) {
  if (!identity.known()) return nullptr;
  Facts facts = {{"frames", {identity.first_frame, identity.last_frame}}};
  for (const auto& [name, hash] : formats::kConcerns)
    if (!(identity.*hash).empty()) facts[std::string(name)] = identity.*hash;
  return facts;
}

FileType file_type(const std::string& path) {
  const std::string head = head_of(path);
  const std::size_t size = head.size();
  if (head.starts_with("\x89TPHOT")) return FileType::photons;
  if (head.starts_with("\x89TPATH")) return FileType::paths;
  if (head.starts_with("\x89TIRPT")) return FileType::irradpoints;
  if (head.starts_with("\x89TIRRC")) return FileType::irradcache;
  if (head.starts_with("\x89TRADS")) return FileType::radsamples;
  if (head.starts_with("\x89TMESH")) return FileType::meshirrad;
  if (path == "-") return FileType::photons;  // the reader of photons reports any error
  if (head.find_first_not_of(" \t\r\n") < size && head[head.find_first_not_of(" \t\r\n")] == '{') return FileType::json;
  for (const char* magic : {"\x76\x2f\x31\x01", "\x89PNG", "\xff\xd8\xff", "#?", "II*", "MM"})
    if (head.starts_with(magic)) return FileType::image;
  if (head.starts_with("glTF")) throw InputError(path + ": a scene; scene-plan says what is in it");
  throw InputError(path + ": not a file we know; it is none of our formats, no image and no JSON");
}

Facts facts_of(const std::string& path, bool allow_nan) {
  switch (file_type(path)) {
    case FileType::photons: return photon_facts(path);
    case FileType::paths: return paths_facts(path);
    case FileType::irradpoints: return irradpoints_facts(path);
    case FileType::irradcache: return irradcache_facts(path);
    case FileType::radsamples: return radsamples_facts(path);
    case FileType::meshirrad: return meshirrad_facts(path);
    case FileType::image: return image_facts(path, allow_nan);
    case FileType::json: break;
  }
  return json_facts(path);
}

Facts difference_of(const std::string& a, const std::string& b) {
  const FileType type = file_type(a);
  if (type != file_type(b)) throw InputError(b + ": of another type than " + a + "; nothing to compare");
  switch (type) {
    case FileType::photons: return photon_difference(a, b);
    case FileType::paths: return paths_difference(a, b);
    case FileType::irradpoints: return irradpoints_difference(a, b);
    case FileType::irradcache: return irradcache_difference(a, b);
    case FileType::radsamples: return radsamples_difference(a, b);
    case FileType::meshirrad: return meshirrad_difference(a, b);
    case FileType::image: return image_difference(a, b);
    case FileType::json: break;
  }
  return json_difference(a, b);
}

void export_points(const std::string& path, const std::string& format, Output& output) {
  switch (file_type(path)) {
    case FileType::photons: return export_photons(path, format, output);
    case FileType::irradpoints: return export_irradpoints(path, format, output);
    case FileType::irradcache: return export_irradcache(path, format, output);
    case FileType::paths:
    case FileType::radsamples:
    case FileType::meshirrad:
    case FileType::image:
    case FileType::json: break;
  }
  throw InputError(path + ": holds no points to export; use --png or --json");
}

std::string facts_as_text(const Facts& facts) {
  std::string text;
  print(facts, "", text);
  return text;
}

}  // namespace tempolux::tools
