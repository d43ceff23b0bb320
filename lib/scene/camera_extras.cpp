#include "lib/scene/camera_extras.h"

#include <algorithm>

#include "lib/core/json.h"

namespace tempolux {
namespace {

constexpr double kMost = 1e9;  ///< largest value that is read: millimetres, metres and frames beyond it are errors

using Json = nlohmann::json;

bool fits(const Json& value) { return value.is_number() && value.get<double>() >= 0 && value.get<double>() <= kMost; }

/// The value at a frame of a list that begins at `first`.
double at_frame(const std::vector<double>& list, int first, int frame) {
  return list[std::size_t(std::clamp<long>(long(frame) - first, 0, long(list.size()) - 1))];
}

}  // namespace

CameraExtras read_camera_extras(const std::string& extras, const std::string& place,
                                std::vector<std::string>& warnings) {
  CameraExtras read;
  const Json object = Json::parse(extras, nullptr, false);
  if (!object.is_object()) return read;
  const auto leave_out = [&](const char* key, const char* wanted) {
    warnings.push_back(place + ".extras." + key + ": not read: must be " + wanted);
  };
  const auto numbers = [&](const char* key, std::vector<double>& to) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return;
    const Json list = found->is_array() ? *found : Json::array({*found});
    if (list.empty() || !std::ranges::all_of(list, fits))
      return leave_out(key, "a number from 0 to 1e9, or a list of such numbers by frame");
    to = list.get<std::vector<double>>();
  };
  numbers("lens_mm", read.lens_mm);
  numbers("f_stop", read.f_stop);
  numbers("focus_m", read.focus_m);
  numbers("shutter_frames", read.shutter_frames);
  if (const auto first = object.find("first_frame"); first != object.end()) {
    if (first->is_number_integer() && std::abs(first->get<double>()) <= kMost) read.first_frame = first->get<int>();
    else leave_out("first_frame", "a whole number");
  }
  if (const auto position = object.find("shutter_position"); position != object.end()) {
    const std::string word = position->is_string() ? position->get<std::string>() : "";
    if (word == "start") read.shutter = Camera::Shutter::start;
    if (word == "end") read.shutter = Camera::Shutter::end;
    if (word != "center" && word != "start" && word != "end") leave_out("shutter_position", "center, start or end");
  }
  return read;
}

void CameraExtras::apply(int frame, Camera& camera) const {
  if (!lens_mm.empty() && !f_stop.empty() && camera.kind == Camera::Kind::perspective) {
    const double stop = at_frame(f_stop, first_frame, frame);
    camera.lens_radius_m = stop > 0 ? at_frame(lens_mm, first_frame, frame) / 1000 / (2 * stop) : 0;
  }
  if (!focus_m.empty()) camera.focus_m = at_frame(focus_m, first_frame, frame);
  if (!shutter_frames.empty()) {
    camera.shutter_frames = at_frame(shutter_frames, first_frame, frame);
    camera.shutter = shutter;
  }
}

}  // namespace tempolux
