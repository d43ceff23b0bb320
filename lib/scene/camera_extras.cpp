#include "lib/scene/camera_extras.h"

#include <algorithm>

#include "lib/core/formatted.h"
#include "lib/core/json.h"
#include "lib/scene/camera_properties.h"

namespace tempolux {
namespace {

constexpr double kMost = 1e9;  ///< largest first frame that is read

using Json = nlohmann::json;

/// The value at a frame of a list that begins at `first`.
double at_frame(const std::vector<double>& list, int first, int frame) {
  return list[std::size_t(std::clamp<long>(long(frame) - first, 0, long(list.size()) - 1))];
}

/// The numbers of a property; empty if the value is none that the property can have.
std::vector<double> numbers_of(const CameraProperty& property, const Json& value) {
  if (property.role == CameraRole::position) {
    const std::string word = value.is_string() ? value.get<std::string>() : "";
    const auto found = std::ranges::find(kShutterPositions, word);
    if (found == kShutterPositions.end()) return {};
    return {double(found - kShutterPositions.begin())};
  }
  const Json list = value.is_array() ? value : Json::array({value});
  const auto fits = [&](const Json& number) {
    return number.is_number() && number.get<double>() >= 0 && number.get<double>() <= property.upper;
  };
  return std::ranges::all_of(list, fits) ? list.get<std::vector<double>>() : std::vector<double>();
}

std::string wanted(const CameraProperty& property) {
  return property.role == CameraRole::position
             ? "center, start or end"
             : "a number from 0 to " + formatted("%g", property.upper) + ", or a list of such numbers by frame";
}

}  // namespace

CameraExtras read_camera_extras(const std::string& extras, const std::string& place,
                                std::vector<std::string>& warnings) {
  CameraExtras read;
  const Json object = Json::parse(extras, nullptr, false);
  if (!object.is_object()) return read;
  const auto leave_out = [&](std::string_view key, const std::string& wanted) {
    warnings.push_back(place + ".extras." + std::string(key) + ": not read: must be " + wanted);
  };
  for (const CameraProperty& property : camera_properties()) {
    std::vector<double>& list = read.lists.emplace_back();
    const auto found = property.key.empty() ? object.end() : object.find(property.key);
    if (found == object.end() || found->is_null()) continue;
    list = numbers_of(property, *found);
    if (list.empty()) leave_out(property.key, wanted(property));
  }
  if (const auto first = object.find("first_frame"); first != object.end()) {
    if (first->is_number_integer() && std::abs(first->get<double>()) <= kMost) read.first_frame = first->get<int>();
    else leave_out("first_frame", "a whole number");
  }
  return read;
}

void CameraExtras::apply(int frame, Camera& camera) const {
  for (std::size_t row = 0; row < lists.size(); ++row) {
    if (lists[row].empty()) continue;
    const CameraProperty& property = camera_properties()[row];
    const double number = at_frame(lists[row], first_frame, frame);
    if (const auto* shutter = std::get_if<Camera::Shutter Camera::*>(&property.member))
      camera.** shutter = Camera::Shutter(int(number));
    else camera.*std::get<double Camera::*>(property.member) = number;
  }
}

bool CameraExtras::changes() const {
  return std::ranges::any_of(
      lists, [](const auto& list) { return std::ranges::any_of(list, [&](double n) { return n != list.front(); }); });
}

void CameraExtras::set(double Camera::*member, double number) {
  lists.resize(camera_properties().size());
  for (std::size_t row = 0; row < lists.size(); ++row)
    if (const auto* own = std::get_if<double Camera::*>(&camera_properties()[row].member); own && *own == member)
      lists[row] = {number};
}

void set_shutter_position(CameraExtras& extras, Camera::Shutter position) {
  extras.lists.resize(camera_properties().size());
  for (std::size_t row = 0; row < extras.lists.size(); ++row)
    if (camera_properties()[row].role == CameraRole::position) extras.lists[row] = {double(position)};
}

}  // namespace tempolux
