// lib/report/comparison_json.cpp -- writes comparison.md's JSON.
#include <cmath>

#include "lib/core/json.h"
#include "lib/report/comparison.h"

namespace tempolux {
namespace {

using Json = nlohmann::ordered_json;

Json number(std::optional<double> value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return *value;
}

/// Writes NAME and NAME_standard_error; null if the figure does not exist.
void put_estimate(Json& to, const std::string& name, const std::optional<Estimate>& estimate) {
  to[name] = estimate ? number(estimate->value) : Json(nullptr);
  to[name + "_standard_error"] = estimate ? number(estimate->standard_error) : Json(nullptr);
}

/// Writes a root mean square, its standard error, the mean square, and SquaredFigure::resolved().
void put_squared(Json& to, const std::string& root, const std::string& squared, const SquaredFigure& figure) {
  to[root] = number(figure.root());
  to[root + "_standard_error"] = number(figure.root_standard_error());
  put_estimate(to, squared, figure.squared);
  to[root + "_resolved"] = figure.resolved();
}

/// The object's id, and its name if it is known.
Json id_json(std::uint32_t id, const ObjectNames& names) {
  Json json = {{"id", id}};
  if (const auto name = names.find(id); name != names.end()) json["name"] = name->second;
  return json;
}

Json object_json(const ObjectError& object, const ObjectNames& names) {
  Json json = id_json(object.id, names);
  json["pixels"] = object.pixels;
  put_estimate(json, "bias", object.bias);
  json["share_of_squared_error"] = number(object.share_of_squared_error);
  json["few_pixels"] = object.few_pixels;
  return json;
}

Json error_json(const FrameError& error, const Comparison& comparison) {
  const ComparisonMode mode = comparison.mode;
  Json json = {{"pixels", error.pixels}};
  put_squared(json, "rmse", "mse", error.squared_error);
  if (mode == ComparisonMode::own_halves)
    put_squared(json, "noise_of_mean", "noise_of_mean_squared", noise_of_mean(error));
  put_estimate(json, "relmse", error.relative_squared_error);
  put_estimate(json, "bias", error.bias);
  json["psnr_db"] = number(error.psnr_db);
  json["mean_test"] = number(error.mean_test);
  json["mean_reference"] = number(error.mean_reference);
  put_estimate(json, "mean_difference", error.mean_difference);
  json["reference_noise"] = number(error.reference_noise);
  json["largest_difference"] = {{"value", number(error.largest.value)},
                                {"frame", error.largest.frame},
                                {"x", error.largest.x},
                                {"y", error.largest.y},
                                {"channel", error.largest.channel}};
  json["objects"] = Json::array();
  for (const ObjectError& object : error.objects)
    json["objects"].push_back(object_json(object, comparison.object_names));
  return json;
}

/// Share of pixels seen to differ, in percent.
Json share_json(const SeenShare& share) {
  return {{"percent", 100 * share.share()}, {"seen", share.seen}, {"pixels", share.pixels}};
}

Json quality_json(const AnimationQuality& quality, const ObjectNames& names) {
  Json json = share_json(quality.all);
  if (quality.adaptation_luminance > 0) json["adaptation_luminance"] = quality.adaptation_luminance;
  json["objects"] = Json::array();
  for (const auto& [id, share] : quality.objects) {
    Json object = id_json(id, names);
    object.update(share_json(share));
    json["objects"].push_back(std::move(object));
  }
  return json;
}

Json viewing_json(const VisionOptions& viewing, const std::string& flow) {
  const vision::Display& display = viewing.display;
  return {{"display", display.name},
          {"white", display.white},
          {"peak", display.peak},
          {"black", display.black},
          {"pixels_per_degree", display.pixels_per_degree},
          {"eye", viewing.gaze == vision::Gaze::track ? "track" : "fixed"},
          {"frames_per_second", viewing.frames_per_second},
          {"exposure_stops", viewing.exposure_stops},
          {"flow", flow.empty() ? Json(nullptr) : Json(flow)},
          {"seen_above", vision::kSeenProbability}};
}

const char* mode_name(ComparisonMode mode) {
  switch (mode) {
    case ComparisonMode::reference_halves: return "reference_halves";
    case ComparisonMode::own_halves: return "own_halves";
    default: return "one_reference";
  }
}

}  // namespace

std::string comparison_json(const Comparison& comparison) {
  Json json = {{"schema", "tempolux.comparison"},
               {"version", comparison.quality ? "1.1" : "1.0"},
               {"command", comparison.command},
               {"test", comparison.test},
               {"references", comparison.references},
               {"mode", mode_name(comparison.mode)},
               {"layer", comparison.layer.empty() ? "RGB" : comparison.layer},
               {"channels", comparison.channels},
               {"width", comparison.width},
               {"height", comparison.height}};
  if (!comparison.relative_to.empty()) json["relative_to"] = comparison.relative_to;
  if (comparison.viewing) json["viewing"] = viewing_json(*comparison.viewing, comparison.flow);
  json["total"] = error_json(comparison.total, comparison);
  if (comparison.flicker) put_squared(json["total"], "flicker", "flicker_squared", *comparison.flicker);
  if (comparison.quality) json["total"]["aqm"] = quality_json(*comparison.quality, comparison.object_names);
  json["frames"] = Json::array();
  for (const Comparison::Frame& frame : comparison.frames) {
    Json entry = {{"frame", frame.frame}};
    entry.update(error_json(frame.error, comparison));
    if (frame.quality) entry["aqm"] = quality_json(*frame.quality, comparison.object_names);
    json["frames"].push_back(std::move(entry));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tempolux
