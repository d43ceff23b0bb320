// lib/plan/plan_files.cpp -- writes the files of formats/plan/plan.md.
#include "lib/plan/plan_files.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/json.h"

namespace tempolux {

using Json = nlohmann::ordered_json;

// The form of parts of Decisions in JSON: methods by their names, reasons as an object by stage.
void to_json(Json& json, IndirectMethod method) { json = kIndirectMethods[std::size_t(method)]; }
void to_json(Json& json, MovingMethod method) { json = kMovingMethods[std::size_t(method)]; }
void from_json(const Json& json, IndirectMethod& method) {
  method = named<IndirectMethod>(kIndirectMethods, json).value();
}
void from_json(const Json& json, MovingMethod& method) { method = named<MovingMethod>(kMovingMethods, json).value(); }
void to_json(Json& json, const std::vector<Reason>& reasons) {
  json = Json::object();
  for (const Reason& reason : reasons) json[reason.stage] = reason.because;
}
void from_json(const Json& json, std::vector<Reason>& reasons) {
  for (const auto& [stage, because] : json.items()) reasons.push_back({stage, because});
}

namespace {

/// Calls visit(name, value) for each decision, in the order of plan.json.
template <class AnyDecisions, class Visit>
void each_decision(AnyDecisions& d, const Visit& visit) {
  visit("photon_kinds", d.kinds);
  visit("indirect", d.indirect);
  visit("caustic_map", d.caustic_map);
  visit("paths", d.photon_paths);
  visit("rays", d.record_rays);
  visit("pixel_error", d.pixel_error);
  visit("texture_width", d.texture_width);
  visit("split", d.split);
  visit("moving", d.moving);
  visit("new_share", d.new_share);
  visit("pictures_together", d.together);
  visit("walkthrough", d.walk);
  visit("view", d.view);
  visit("looked_at", d.looked);
  visit("because", d.reasons);
}

Json decisions_json(const Decisions& decisions) {
  Json json;
  each_decision(decisions, [&](const char* name, const auto& value) { json[name] = value; });
  return json;
}

Json frame_json(const PlannedFrame& frame) {
  Json json = {{"frame", frame.frame}, {"lit_as", frame.lit_frame}, {"picture", frame.picture}};
  json["hashes"] = {
      {"moving_geometry", frame.moving_geometry}, {"lights", frame.lights}, {"materials", frame.materials}};
  if (!frame.media.empty()) json["hashes"]["media"] = frame.media;
  json["hashes"]["camera"] = frame.camera;
  return json;
}

Json segment_json(const PlannedSegment& segment) {
  Json json = {{"first", segment.first}, {"last", segment.last}, {"decisions", decisions_json(segment.decisions)}};
  json["moves"] = Json::array();
  for (const MovingNode& node : segment.moves)
    json["moves"].push_back({{"node", node.name}, {"carries", node.carries}, {"why", node.why}});
  json["hashes"] = {
      {"static_geometry", segment.static_geometry}, {"static_scene", segment.static_scene}, {"frozen", segment.frozen}};
  json["frames"] = Json::array();
  for (const PlannedFrame& frame : segment.frames) json["frames"].push_back(frame_json(frame));
  return json;
}

/// The stages of the pipeline: how many files each makes, and the first segment's reason.
Json stages_json(const Plan& plan, const Graph& graph) {
  std::map<std::string, std::size_t> files;
  for (const GraphFile& file : graph.files) ++files[file.stage];
  Json json = Json::array();
  for (const StageInfo& stage : kStages) {
    Json one = {{"stage", stage.name}, {"files", files[std::string(stage.name)]}};
    for (const Reason& reason : plan.segments.front().decisions.reasons)
      if (reason.stage == stage.name) one["because"] = reason.because;
    json.push_back(one);
  }
  return json;
}

std::string words_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += " " + name;
  return text;
}

std::string key_of_text(const std::string& text) { return key_of(hash_hex(text)); }

/// Rules for a file with a plain name, such as frames/0012.exr. The name of its marker, a file in shown/, stands for
/// the content that the plain file should show. If the marker is missing, the plain file is made anew; if the plain
/// file is missing, it is restored (stages.mk has both rules).
std::string shown_lines(const std::string& name, const std::string& marker, const std::string& inputs) {
  return "shown/" + marker + ": | " + inputs + "\n" + name + ": | shown/" + marker + " " + inputs + "\n";
}

/// Rules for frames, their previews, the contact sheet, and the log of a walkthrough.
std::string shown_rules(const Plan& plan, const Graph& graph, const ToolHash& tool_hash) {
  const std::string viewer = tool_hash("tempolux-info"), first = graph.pictures.at(plan.frames.front());
  const std::string stops = graph.exposure ? std::to_string(*graph.exposure) : "";
  const std::string exposure = "shown/exposure-" + key_of_text(stops.empty() ? first + viewer : stops);
  std::string text = (stops.empty() ? "" : "stops := " + stops + "\n") + exposure + ": | " + first + "\n", frames, previews, all = exposure + viewer;
  for (const int frame : plan.frames) {
    const std::string digits = frame_digits(frame), picture = graph.pictures.at(frame), name = "frames/" + digits;
    frames += " " + name + ".exr";
    previews += " " + name + ".png";
    all += picture;
    text += shown_lines(name + ".exr", digits + "-" + key_of_text(picture), picture);
    text +=
        shown_lines(name + ".png", digits + "-" + key_of_text(picture + exposure) + ".png", picture + " " + exposure);
  }
  if (!graph.intervals.empty()) {
    const std::string intervals = words_of(graph.intervals);
    text += "log := walk.log\n" + shown_lines("walk.log", "walk-" + key_of_text(intervals), intervals);
  }
  return "frames :=" + frames + "\npreviews :=" + previews + "\nviewer := tempolux-info-" + key_of_text(viewer) + "\n" +
         text + shown_lines("sheet.png", "sheet-" + key_of_text(all), exposure + " $(log) $(frames)");
}

std::string report_rules(const Graph& graph, const ToolHash& tool_hash) {
  if (graph.errors.empty()) return "";
  std::string runs, errors;
  for (const auto& [frame, error] : graph.errors) {
    std::string spent;
    for (const std::string& stats : graph.spent.at(error)) spent += (spent.empty() ? "" : "+") + stats;
    runs += " --run label=frame-" + frame_digits(frame) + ",curve=$(QUALITY) " + spent + " " + error;
    errors += " " + error;
  }
  return "report_runs :=" + runs + "\n" +
         shown_lines("report/index.html", "report-" + key_of_text(errors + tool_hash("error-report")), errors);
}

}  // namespace

std::string decisions_text(const Decisions& decisions) { return decisions_json(decisions).dump(1) + "\n"; }

Decisions read_decisions(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    Decisions d;
    each_decision(d, [&](const char* name, auto& value) { json.at(name).get_to(value); });
    return d;
  } catch (const std::exception& error) { throw InputError(std::string("decisions: ") + error.what()); }
}

std::string plan_json(const Plan& plan, const Graph& graph, const std::string& scene_name, const std::string& history) {
  Json json = {{"format", "tempolux plan"},
               {"version", "2.0"},
               {"history", history},
               {"scene", scene_name},
               {"camera", plan.camera},
               {"fps", plan.time.fps},
               {"segment_length", plan.time.segment_length},
               {"light_units", plan.time.light_units},
               {"frames", plan.frames}};
  if (!plan.environment.empty()) json["environment"] = std::filesystem::path(plan.environment).filename().string();
  json["stages"] = stages_json(plan, graph);
  json["segments"] = Json::array();
  for (const PlannedSegment& segment : plan.segments) json["segments"].push_back(segment_json(segment));
  json["pictures"] = Json::object();
  for (const auto& [frame, name] : graph.pictures) json["pictures"][frame_digits(frame)] = name;
  json["warnings"] = plan.warnings;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string plan_makefile(const Plan& plan, const Graph& graph, const ToolHash& tool_hash) {
  std::string text = "# Written by scene-plan; format: formats/plan/plan.md.\n";
  std::string passing;
  for (const GraphFile& file : graph.files) {
    const std::string made = file.name + words_of(file.beside);
    if (file.passing) passing += " " + file.name;
    text += made + ": words := " + file.words + "\n" + made + ": |" + words_of(file.inputs) + "\n";
  }
  if (!passing.empty()) text += "passing :=" + passing + "\n";
  return text + shown_rules(plan, graph, tool_hash) + report_rules(graph, tool_hash);
}

}  // namespace tempolux
