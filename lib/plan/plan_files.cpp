// lib/plan/plan_files.cpp -- formats/plan/plan.md, written.
#include "lib/plan/plan_files.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "formats/error.h"

namespace tempolux {
namespace {

using Json = nlohmann::ordered_json;

Json frame_json(const PlannedFrame& frame, bool photons) {
  Json json = {{"frame", frame.frame}, {"asked", frame.asked}};
  if (frame.evaluated != frame.frame) json["shows"] = frame.evaluated;
  if (photons) json["photons"] = frame.lit_frame;
  if (frame.asked) json["picture"] = frame.picture;
  json["hashes"] = {{"moving_geometry", frame.moving_geometry}, {"lights", frame.lights}};
  if (!frame.media.empty()) json["hashes"]["media"] = frame.media;
  if (frame.asked) json["hashes"]["camera"] = frame.camera;
  return json;
}

Json segment_json(const PlannedSegment& segment, bool photons) {
  Json json = {{"first", segment.first}, {"last", segment.last}, {"camera_moves", segment.camera_moves}};
  json["moves"] = Json::array();
  for (const MovingNode& node : segment.moves)
    json["moves"].push_back({{"node", node.name}, {"carries", node.carries}, {"why", node.why}});
  json["hashes"] = {{"static_geometry", segment.static_geometry},
                    {"materials", segment.materials},
                    {"standing", segment.standing},
                    {"frozen", segment.frozen}};
  json["frames"] = Json::array();
  for (const PlannedFrame& frame : segment.frames) json["frames"].push_back(frame_json(frame, photons));
  return json;
}

/// For each state of light transport among the frames asked for, by its first frame: the pictures that show it.
std::map<int, std::set<int>> pictures_by_light(const Plan& plan) {
  std::map<int, std::set<int>> pictures;
  for (const PlannedSegment& segment : plan.segments)
    for (const PlannedFrame& frame : segment.frames)
      if (frame.asked) pictures[frame.lit_frame].insert(frame.picture);
  return pictures;
}

template <class Frames>
std::string variable(const std::string& name, const Frames& frames) {
  std::string line = name + " :=";
  for (const int frame : frames) line.append(1, ' ').append(frame_digits(frame));
  return line.append(1, '\n');
}

/// The map before each in its segment: what it may be an update of.
std::string previous_maps(const Plan& plan, const std::set<int>& photon_frames) {
  std::string text = "\n# the photon map before, in the same segment\n";
  for (const PlannedSegment& segment : plan.segments) {
    int previous = 0;
    bool any = false;
    for (const int frame : photon_frames) {
      if (frame < segment.first || frame > segment.last) continue;
      if (any) text += "lit_before_" + frame_digits(frame) + " := " + frame_digits(previous) + "\n";
      previous = frame;
      any = true;
    }
  }
  return text;
}

/// A file name as a prerequisite.
std::string escaped_for_make(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (c == ' ' || c == '#' || c == '%' || c == ':') text += '\\';
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

/// Of segments whose light follows from that of what stands: stands_FFFF for each state of light, state_SSSS for the segment.
std::string standing_variables(const Plan& plan, const std::string& folder, const std::set<int>& photon_frames) {
  std::string text;
  for (const PlannedSegment& segment : plan.segments) {
    if (!segment.updated) continue;
    const std::string first = frame_digits(segment.first);
    std::string states = "static." + first + " materials." + first + " standing." + first + " frozen." + first;
    for (const PlannedFrame& frame : segment.frames) {
      const std::string digits = frame_digits(frame.frame);
      states += " moving." + digits + " lights." + digits;
      if (photon_frames.contains(frame.frame)) text += "stands_" + digits + " := " + first + "\n";
    }
    text += "state_" + first + " := $(addprefix " + folder + "/state/," + states + ")\n";
  }
  return text.empty() ? text : "\n# what stands while others move\n" + text;
}

}  // namespace

std::string frame_digits(int frame) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%04d", frame);
  return text.data();
}

std::string plan_json(const Plan& plan, const std::string& scene_name, const std::string& history,
                      const std::string& estimate) {
  const bool photons = !plan.photon_kinds.empty();
  Json json = {{"format", "tempolux plan"},
               {"version", "1.0"},
               {"history", history},
               {"scene", scene_name},
               {"camera", plan.camera},
               {"fps", plan.time.fps},
               {"segment_length", plan.time.segment_length},
               {"light_units", plan.time.light_units},
               {"frames", plan.frames},
               {"photon_kinds", plan.photon_kinds},
               {"indirect", photons ? plan.indirect : "paths"},
               {"paths", plan.photon_paths},
               {"rays", plan.record_rays},
               {"moving", photons ? plan.moving : "anew"},
               {"split", plan.split},
               {"learn_lights", plan.learn_lights}};
  if (!plan.environment.empty()) json["environment"] = std::filesystem::path(plan.environment).filename().string();
  json["stages"] = Json::array();
  for (const Stage& stage : plan.stages)
    json["stages"].push_back({{"stage", stage.name}, {"needed", stage.needed}, {"because", stage.because}});
  json["segments"] = Json::array();
  for (const PlannedSegment& segment : plan.segments)
    json["segments"].push_back(segment_json(segment, photons));
  json["warnings"] = plan.warnings;
  if (!estimate.empty()) json["estimate"] = Json::parse(estimate);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void check_folder_name(const std::string& folder) {
  if (folder.find_first_of(" \t\n#%:$\\*?[]|;&'\"()<>`~=") != std::string::npos)
    throw InputError(folder + ": make cannot use files in a folder of this name; choose another with -o");
}

std::string plan_makefile(const Plan& plan, const std::string& folder,
                          const std::vector<std::string>& scene_files) {
  check_folder_name(folder);
  const bool photons = !plan.photon_kinds.empty();
  std::string text = "# Written by scene-plan; formats/plan/plan.md says what each variable is.\n";
  const std::map<int, std::set<int>> lit = pictures_by_light(plan);
  std::set<int> pictures, photon_frames;
  for (const auto& [light, views] : lit) {
    pictures.insert(views.begin(), views.end());
    if (photons) photon_frames.insert(light);
  }
  text += variable("plan_frames", plan.frames) + variable("plan_pictures", pictures);
  text += variable("plan_photons", photon_frames) + "plan_kinds := " + plan.photon_kinds + "\n";
  text += "plan_indirect := " + (photons ? plan.indirect : "paths") + "\n";
  text += "plan_paths := " + std::to_string(plan.photon_paths) + "\n";
  text += "plan_rays := " + std::to_string(plan.record_rays) + "\n";
  text += "plan_moving := " + (photons ? plan.moving : "anew") + "\n";
  text += std::string("plan_method := ") + (plan.walkthrough ? "walkthrough" : "frames") + "\n";
  if (plan.split) text += "plan_split := 1\n";
  if (plan.learn_lights) text += "plan_lights := 1\n";
  if (plan.media) text += "plan_media := 1\n";
  for (const std::string& file : scene_files)  // the empty rule: a file that is gone asks for a new plan
    text += folder + "/plan.mk: " + escaped_for_make(file) + "\n" + escaped_for_make(file) + ":\n";
  for (const PlannedSegment& segment : plan.segments) {
    const std::string first = frame_digits(segment.first);
    text += "\n# frames " + std::to_string(segment.first) + " to " + std::to_string(segment.last) + "\n";
    std::string previous;   // frame asked for, of this segment
    for (const PlannedFrame& frame : segment.frames) {
      const std::string digits = frame_digits(frame.frame);
      text += "light_" + digits + " := $(addprefix " + folder + "/state/,static." + first +
              " materials." + first + " frozen." + first + " moving." + digits + " lights." + digits + (frame.media.empty() ? "" : " media." + digits) + ")\n";
      if (!frame.asked) continue;
      text += "camera_" + digits + " := " + folder + "/state/camera." + digits + "\n";
      text += "picture_" + digits + " := " + frame_digits(frame.picture) + "\n";
      if (plan.media) text += "majorants_" + digits + " := " + folder + "/state/majorants." + first + "\n";
      if (photons) text += "photons_" + digits + " := " + frame_digits(frame.lit_frame) + "\n";
      text += "segment_" + digits + " := " + first + "\n";
      text += "previous_" + digits + " :=" + previous + "\n";
      previous = " " + digits;
    }
  }
  if (photons && plan.media) text += previous_maps(plan, photon_frames);
  if (photons) text += "\n# photon maps, and the pictures they light\n";
  for (const int light : photon_frames) text += variable("views_" + frame_digits(light), lit.at(light));
  text += standing_variables(plan, folder, photon_frames);
  if (!plan.views.empty()) text += "\n# where the photons of sun and sky are aimed\n";
  for (const PlannedView& view : plan.views)
    for (const int light : view.photon_frames)
      text += "view_" + frame_digits(light) + " := " + folder + "/state/view." + frame_digits(view.first) + "\n";
  return text;
}

std::vector<PlanFile> state_files(const Plan& plan) {
  std::vector<PlanFile> files;
  const auto add = [&](const char* concern, int frame, const std::string& hash) {
    files.push_back({std::string("state/") + concern + "." + frame_digits(frame), hash + "\n"});
  };
  for (const PlannedSegment& segment : plan.segments) {
    add("static", segment.first, segment.static_geometry);
    add("materials", segment.first, segment.materials);
    add("standing", segment.first, segment.standing);
    add("frozen", segment.first, segment.frozen);
    for (const PlannedFrame& frame : segment.frames) {
      add("moving", frame.frame, frame.moving_geometry);
      add("lights", frame.frame, frame.lights);
      if (!frame.media.empty()) add("media", frame.frame, frame.media);
      if (frame.asked) add("camera", frame.frame, frame.camera);
    }
  }
  for (const PlannedView& view : plan.views) files.push_back({"state/view." + frame_digits(view.first), view.content});
  return files;
}

}  // namespace tempolux
