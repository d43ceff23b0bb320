// lib/report/report_input.cpp -- reads and checks stats, comparisons and manifests.
#include "lib/report/report_input.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "formats/error.h"
#include "lib/core/json.h"
#include "lib/core/json_file.h"
#include "lib/core/statistics.h"

namespace tempolux {
namespace {

using Json = nlohmann::ordered_json;

/// A value in a document, with its place for messages, such as "run.json: runs[2].x".
struct Place {
  const Json& json;
  std::string name;

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(name + (name.ends_with(": ") ? "" : ": ") + what);
  }

  std::optional<Place> find(const std::string& key) const {
    if (!json.is_object()) refuse("not an object");
    const auto found = json.find(key);
    if (found == json.end() || found->is_null()) return std::nullopt;
    return Place{*found, name + (name.ends_with(": ") ? "" : ".") + key};
  }
  Place at(const std::string& key) const {
    if (const auto found = find(key)) return *found;
    refuse("has no \"" + key + "\"");
  }
  std::vector<Place> items() const {
    if (!json.is_array()) refuse("not an array");
    std::vector<Place> all;
    for (std::size_t i = 0; i < json.size(); ++i) all.push_back({json[i], name + "[" + std::to_string(i) + "]"});
    return all;
  }
  std::vector<std::pair<std::string, Place>> members() const {
    if (!json.is_object()) refuse("not an object");
    std::vector<std::pair<std::string, Place>> all;
    for (const auto& [key, value] : json.items()) all.emplace_back(key, Place{value, name + "." + key});
    return all;
  }
  double number() const {
    if (!json.is_number() || !std::isfinite(json.get<double>())) refuse("not a finite number");
    return json.get<double>();
  }
  double number_from_0() const {
    if (number() < 0) refuse("is negative");
    return number();
  }
  std::string string() const {
    if (!json.is_string()) refuse("not a string");
    return json.get<std::string>();
  }
};

std::optional<double> number_of(const Place& place, const std::string& key) {
  const auto found = place.find(key);
  return found ? std::optional(found->number()) : std::nullopt;
}

std::string string_of(const Place& place, const std::string& key, const std::string& otherwise = "") {
  const auto found = place.find(key);
  return found ? found->string() : otherwise;
}

/// Opens a document and checks its schema and major version. `keep` owns it.
Place open_document(const std::string& path, const std::string& schema, Json& keep) {
  keep = read_json(path);
  const Place top{keep, path + ": "};
  if (!keep.is_object() || string_of(top, "schema") != schema)
    throw InputError(path + ": not a " + schema + " file: its \"schema\" is another");
  const std::string version = top.at("version").string();
  if (version != "1" && !version.starts_with("1."))
    throw InputError(path + ": version " +
                     Json(version.substr(0, 20)).dump(-1, ' ', true, Json::error_handler_t::replace) + " of " + schema +
                     "; this program reads 1.x");
  return top;
}

std::optional<WorstObject> worst_object(const Place& total) {
  std::optional<WorstObject> worst;
  const auto objects = total.find("objects");
  if (!objects) return worst;
  for (const Place& object : objects->items()) {
    const auto few = object.find("few_pixels");
    const std::optional<double> bias = number_of(object, "bias");
    if (!bias || (few && few->json == true)) continue;
    const double id = object.at("id").number_from_0();
    if (id > UINT32_MAX) object.refuse("id is above 2^32 - 1");
    if (worst && std::abs(*bias) <= std::abs(worst->bias)) continue;
    const auto name = object.find("name");
    worst = {std::uint32_t(id), name ? name->string() : "", *bias};
  }
  return worst;
}

double number_from_text(const std::string& text, const std::string& where) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw InputError(where + ": '" + text + "' is not a number");
  return value;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(at, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// Resolves the names in a manifest relative to the manifest's folder.
struct Folder {
  std::filesystem::path folder;
  std::vector<std::string>& files;

  std::string file(const std::string& name) const {
    files.push_back((folder / name).lexically_normal().string());
    return files.back();
  }
};

MeasuredRun run_of(const Place& entry, const Folder& folder) {
  MeasuredRun run;
  run.scene = string_of(entry, "scene", "scene");
  run.curve = entry.at("curve").string();
  run.x = number_of(entry, "x");
  run.label = string_of(entry, "label", run.curve);
  if (const auto parameters = entry.find("parameters"))
    for (const auto& [key, value] : parameters->members())
      run.parameters[key] = value.json.is_string() ? value.string() : value.json.dump();
  for (const Place& stats : entry.at("stats").items()) run.stages.push_back(read_stats(folder.file(stats.string())));
  if (const auto comparison = entry.find("comparison")) run.error = read_comparison(folder.file(comparison->string()));
  return run;
}

}  // namespace

double ErrorRecord::rmse() const { return mse > 0 ? std::sqrt(mse) : 0; }

bool ErrorRecord::usable() const { return mse > 0 && (!mse_standard_error || *mse_standard_error * kCertain < mse); }

double MeasuredRun::cpu_s() const {
  double sum = 0;
  for (const StatsRecord& stage : stages) sum += stage.cpu_s;
  return sum;
}

double MeasuredRun::wall_s() const {
  double sum = 0;
  for (const StatsRecord& stage : stages) sum += stage.wall_s;
  return sum;
}

double MeasuredRun::peak_memory_bytes() const {
  double peak = 0;
  for (const StatsRecord& stage : stages) peak = std::max(peak, stage.peak_memory_bytes);
  return peak;
}

StatsRecord read_stats(const std::string& path) {
  Json keep;
  const Place top = open_document(path, "tempolux.stats", keep);
  StatsRecord record;
  record.cpu_s = top.at("cpu_s").number_from_0();
  record.wall_s = top.at("wall_s").number_from_0();
  if (const auto peak = top.find("peak_memory_bytes")) record.peak_memory_bytes = peak->number_from_0();
  return record;
}

ErrorRecord read_comparison(const std::string& path) {
  Json keep;
  const Place top = open_document(path, "tempolux.comparison", keep);
  const Place total = top.at("total");
  ErrorRecord record;
  const std::string mode = top.at("mode").string();
  if (mode == "own_halves") top.refuse("compares two halves of one image: its noise, not its error");
  record.halves = mode == "reference_halves";
  record.mse = total.at("mse").number();
  record.mse_standard_error = number_of(total, "mse_standard_error");
  record.relmse = number_of(total, "relmse");
  record.bias = number_of(total, "bias");
  record.bias_standard_error = number_of(total, "bias_standard_error");
  record.flicker = number_of(total, "flicker");
  record.worst_object = worst_object(total);
  return record;
}

ReportInput read_manifest(const std::string& path) {
  Json keep;
  const Place top = open_document(path, "tempolux.report", keep);
  ReportInput input;
  input.files.push_back(path);
  const Folder folder{std::filesystem::path(path).parent_path(), input.files};
  input.title = string_of(top, "title", input.title);
  input.baseline = string_of(top, "baseline");
  for (const Place& entry : top.at("runs").items()) input.runs.push_back(run_of(entry, folder));
  if (const auto points = top.find("points"))
    for (const Place& entry : points->items()) {
      GivenPoint point{string_of(entry, "scene", "scene"), entry.at("label").string(), string_of(entry, "note"),
                       entry.at("cpu_s").number(), entry.at("rmse").number()};
      if (point.cpu_s <= 0 || point.rmse <= 0) entry.refuse("cpu_s and rmse must be above 0");
      input.points.push_back(std::move(point));
    }
  return input;
}

void add_run(ReportInput& input, const std::string& what, const std::string& stats, const std::string& comparison) {
  MeasuredRun run;
  run.scene = "scene";
  for (const std::string& pair : split(what, ',')) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError("--run '" + what + "': '" + pair + "' is not KEY=VALUE");
    const std::string key = pair.substr(0, equals), value = pair.substr(equals + 1);
    if (key == "scene") run.scene = value;
    else if (key == "curve") run.curve = value;
    else if (key == "label") run.label = value;
    else if (key == "x") run.x = number_from_text(value, "--run: x");
    else run.parameters[key] = value;
  }
  if (run.curve.empty()) throw InputError("--run '" + what + "': has no curve=NAME");
  if (run.label.empty()) run.label = run.curve;
  for (const std::string& file : split(stats, '+')) {
    run.stages.push_back(read_stats(file));
    input.files.push_back(file);
  }
  run.error = read_comparison(comparison);
  input.files.push_back(comparison);
  input.runs.push_back(std::move(run));
}

}  // namespace tempolux
