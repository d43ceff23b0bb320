// lib/plan/plan_files.cpp -- writes the files of formats/plan/plan.md.
#include "lib/plan/plan_files.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/formatted.h"
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
  visit("static_ray_factor", d.static_ray_factor);
  visit("pixel_error", d.pixel_error);
  visit("texture_width", d.texture_width);
  visit("split", d.split);
  visit("moving", d.moving);
  visit("new_share", d.new_share);
  visit("pictures_together", d.together);
  visit("walkthrough", d.walk);
  visit("still", d.still);
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

/// All stages: what they are, how many files each makes here, and the first segment's reason.
Json stages_json(const Plan& plan, const Graph& graph, const StageCosts& costs) {
  std::map<const StageInfo*, std::size_t> files;
  for (const GraphFile& file : graph.files) ++files[file.stage];
  Json json = Json::array();
  for (const StageInfo& stage : kStages) {
    Json one = {{"stage", stage.name},
                {"folder", stage.folder},
                {"tool", stage.command},
                {"extensions", stage.extensions},
                {"part", kParts[std::size_t(stage.part)]},
                {"words", stage.words},
                {"cpu_s", costs.at(std::string(stage.folder)).cpu_s},
                {"files", files[&stage]}};
    for (const Reason& reason : plan.segments.front().decisions.reasons)
      if (reason.stage == stage.name) one["because"] = reason.because;
    json.push_back(one);
  }
  return json;
}

/// A string of JSON. A name that is no UTF-8 has its bytes from 128 on as \udc80 to \udcff: so Python's os.fsencode()
/// gives the name back.
std::string json_text(const std::string& text) {
  try {
    return Json(text).dump();
  } catch (const Json::type_error&) {
    std::string all = "\"";
    for (const unsigned char c : text) {
      const std::string one = c < 128 ? Json(std::string(1, char(c))).dump() : formatted("\"\\udc%02x\"", c);
      all += one.substr(1, one.size() - 2);
    }
    return all + "\"";
  }
}

/// A line for each file: its command, and the files that must exist first.
std::string files_json(const Graph& graph, const PlanContext& context) {
  std::string text;
  for (const GraphFile& file : graph.files) {
    std::string argv;
    for (const std::string& word : command_of(file, context)) argv += (argv.empty() ? "" : ", ") + json_text(word);
    const StageCost& cost = context.costs.find(file.stage->folder)->second;
    text += (text.empty() ? "" : ",\n  ") + ("{\"file\": " + Json(file.name).dump());
    if (!file.beside.empty()) text += ", \"beside\": " + Json(file.beside).dump();
    text += ", \"stage\": " + Json(file.stage->name).dump() + ", \"argv\": [" + argv +
            "], \"inputs\": " + Json(file.inputs).dump() +
            formatted(", \"cpu_s\": %.3g, \"memory\": %.0f}", cost.cpu_s, cost.memory);
  }
  return "[\n  " + text + "\n ]";
}

std::string all_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += " " + name;
  return text;
}

/// The options that name what a command writes: its files, and its statistics.
std::string outputs_of(const StageInfo& stage, const std::string& stem) {
  std::string text;
  for (const char c : stage.outputs)
    text += c == '@' ? stem : c == '%' ? stem + words_of(stage.extensions).front() : std::string(1, c);
  return text;
}

/// A rule for each stage that makes files of the plan, in words of stages.mk; and the folders of pictures.
std::string stage_rules(const Graph& graph) {
  static constexpr const char* kSeen[] = {"$(words)", "$(scene)", "$(drawn)", "$(seen)"};
  std::string rules, pictures;
  for (const StageInfo& stage : kStages) {
    if (std::ranges::find(graph.files, &stage, &GraphFile::stage) == graph.files.end()) continue;
    const std::string folder(stage.folder);
    if (stage.makes_pictures()) pictures += " " + folder;
    if (stage.outputs.empty()) continue;
    std::string targets, made;
    for (const std::string& extension : words_of(stage.extensions)) {
      targets += (targets.empty() ? "" : " ") + folder + "/%" + extension;
      made += " " + folder + "/$*" + extension;
    }
    rules += targets + ":\n\t$(run)" + made + " $(tool)" + std::string(stage.command) + " " +
             kSeen[std::size_t(stage.sees)] + " " + outputs_of(stage, folder + "/$*") + "; }\n";
    if (stage.makes_pictures()) rules += "\t$(follow)\n";
  }
  return "pictures :=" + pictures + "\n" + rules;
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
  std::string text = (stops.empty() ? "" : "stops := " + stops + "\n") + exposure + ": | " + first + "\n";
  std::string frames, previews, all = exposure + viewer;
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
    const std::string intervals = all_of(graph.intervals);
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

std::vector<std::string> command_of(const GraphFile& file, const PlanContext& context) {
  const StageInfo& stage = *file.stage;
  if (stage.outputs.empty()) return {};
  std::vector<std::string> words = words_of(stage.command);
  if (stage.sees >= Sees::scene) words.push_back(context.scene);
  std::ranges::copy(words_of(file.words), std::back_inserter(words));
  if (stage.sees >= Sees::scene) {
    std::ranges::copy(context.options, std::back_inserter(words));
    words.insert(words.end(), {"--camera", context.camera});
  }
  if (stage.sees >= Sees::camera) std::ranges::copy(context.lens, std::back_inserter(words));
  std::ranges::copy(words_of(outputs_of(stage, stem_of(file.name))), std::back_inserter(words));
  return words;
}

std::string plan_json(const Plan& plan, const Graph& graph, const PlanContext& context) {
  Json json = {{"format", "tempolux plan"},
               {"version", "2.2"},
               {"history", context.history},
               {"scene", std::filesystem::path(context.scene).filename().string()},
               {"camera", plan.camera},
               {"fps", plan.time.fps},
               {"segment_length", plan.time.segment_length},
               {"light_units", plan.time.light_units},
               {"shot", plan.shot_frames},
               {"frames", plan.frames}};
  if (!plan.environment.empty()) json["environment"] = std::filesystem::path(plan.environment).filename().string();
  json["stages"] = stages_json(plan, graph, context.costs);
  json["segments"] = Json::array();
  for (const PlannedSegment& segment : plan.segments) json["segments"].push_back(segment_json(segment));
  json["pictures"] = Json::object();
  for (const auto& [frame, name] : graph.pictures) json["pictures"][frame_digits(frame)] = name;
  json["warnings"] = plan.warnings;
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  return text.substr(0, text.size() - 2) + ",\n \"files\": " + files_json(graph, context) + "\n}\n";
}

std::string plan_makefile(const Plan& plan, const Graph& graph, const ToolHash& tool_hash) {
  std::string text = "# Written by scene-plan; format: formats/plan/plan.md.\n" + stage_rules(graph), passing;
  for (const GraphFile& file : graph.files) {
    const std::string made = file.name + all_of(file.beside);
    if (file.passing) passing += " " + file.name;
    text += made + ": words := " + file.words + "\n" + made + ": |" + all_of(file.inputs) + "\n";
  }
  if (!passing.empty()) text += "passing :=" + passing + "\n";
  return text + shown_rules(plan, graph, tool_hash) + report_rules(graph, tool_hash);
}

}  // namespace tempolux
