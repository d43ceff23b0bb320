// tools/info/info_json.cpp -- tempolux-info on JSON files: statistics, comparisons, plans.
#include <string>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/json.h"
#include "lib/core/json_file.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

[[noreturn]] void bad(const std::string& path, const std::string& why) { throw InputError(path + ": " + why); }

/// The name of the format, such as "tempolux.stats"; a plan has its name in `format`.
std::string schema_of(const Facts& document) {
  for (const char* key : {"schema", "format"})
    if (document.is_object() && document.contains(key) && document[key].is_string()) {
      const std::string name = document[key];
      if (name.starts_with("tempolux")) return name;
    }
  return "";
}

void check_stats(const std::string& path, const Facts& document) {
  for (const char* key : {"cpu_s", "wall_s"})
    if (!document.value(key, Facts()).is_number()) bad(path, std::string(key) + ": is no number");
  if (!document.value("tool", Facts()).is_string()) bad(path, "tool: is no text");
}

/// Checks the parts of a comparison that error-report needs.
void check_comparison(const std::string& path, const Facts& document) {
  const Facts total = document.value("total", Facts());
  if (!total.is_object()) bad(path, "total: is missing, or no object");
  for (const char* key : {"pixels", "mse"})
    if (!total.value(key, Facts()).is_number()) bad(path, std::string("total: ") + key + ": is no number");
}

Facts load(const std::string& path) {
  Facts document = read_json(path);
  const std::string schema = schema_of(document);
  if (schema.empty()) bad(path, "JSON, but not of ours: it has no \"schema\": \"tempolux...\"");
  const Facts version = document.value("version", Facts());
  const std::string text = version.is_string() ? version.get<std::string>() : version.dump();
  if (text != "1" && !text.starts_with("1.")) bad(path, "version " + text + " is not known; use a newer tempolux");
  if (schema == "tempolux.stats") check_stats(path, document);
  if (schema == "tempolux.comparison") check_comparison(path, document);
  return document;
}

std::string digest_of_document(Facts document) {
  for (const char* key : {"command", "history", "tool_version"}) document.erase(key);
  return hash_hex(nlohmann::json(document).dump());  // keys sorted
}

}  // namespace

Facts json_facts(const std::string& path) {
  const Facts document = load(path);
  Facts facts = {{"file", path}, {"type", schema_of(document)}};
  facts["content"] = document;
  facts["digest"] = digest_of_document(document);
  return facts;
}

}  // namespace tempolux::tools
