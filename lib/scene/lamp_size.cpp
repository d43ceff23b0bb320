#include "lib/scene/lamp_size.h"

#include <algorithm>
#include <initializer_list>
#include <numbers>

#include "lib/core/formatted.h"
#include "lib/core/json.h"

namespace tempolux {
namespace {

constexpr double kLargestRadius = 1e9;     ///< m; its square stays far inside the range of float
constexpr double kRounding = 1 + 0x1p-22;  ///< exporters write pi as a float, which is above pi

/// A number from 0 to `most` under the first of these keys that is there; 0 if none is.
float number_of(const nlohmann::json& object, std::initializer_list<const char*> keys, double most,
                const std::string& place, std::vector<std::string>& warnings) {
  for (const char* const key : keys) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) continue;
    const double number = found->is_number() ? found->get<double>() : -1;
    if (number >= 0 && number <= most * kRounding) return float(std::min(number, most));
    warnings.push_back(place + ".extras." + key + ": not read: must be a number from 0 to " + formatted("%g", most) +
                       "; the light has no size");
    return 0;
  }
  return 0;
}

}  // namespace

LampSize read_lamp_size(const std::string& extras, PunctualLight::Kind kind, const std::string& place,
                        std::vector<std::string>& warnings) {
  LampSize size;
  const nlohmann::json object = nlohmann::json::parse(extras, nullptr, false);
  if (!object.is_object()) return size;
  if (kind == PunctualLight::Kind::directional)
    size.angle_rad = number_of(object, {"angle", "angle_rad"}, std::numbers::pi, place, warnings);
  else size.radius_m = number_of(object, {"radius", "radius_m"}, kLargestRadius, place, warnings);
  return size;
}

}  // namespace tempolux
