#include "lib/scene/camera_properties.h"

#include <algorithm>

#include "lib/core/member_count.h"

namespace tempolux {
namespace {

using enum CameraRole;

constexpr std::array kProperties{CameraProperty{"", &Camera::kind, kind},
                                 CameraProperty{"", &Camera::yfov_rad, perspective},
                                 CameraProperty{"", &Camera::ymag_m, orthographic},
                                 CameraProperty{"", &Camera::lens_shift, shift},
                                 CameraProperty{"lens_radius_m", &Camera::lens_radius_m, lens},
                                 CameraProperty{"f_stop", &Camera::f_stop, lens},
                                 CameraProperty{"lens_mm", &Camera::lens_mm, lens},
                                 CameraProperty{"sensor_width_mm", &Camera::sensor_width_mm, lens},
                                 CameraProperty{"focus_m", &Camera::focus_m, lens},
                                 CameraProperty{"shutter_frames", &Camera::shutter_frames},
                                 CameraProperty{"shutter_position", &Camera::shutter, position}};

/// Number of different members that the table names.
consteval std::size_t members_in_table() {
  std::size_t count = 0;
  for (auto row = kProperties.begin(); row != kProperties.end(); ++row)
    count += std::none_of(kProperties.begin(), row, [&](const auto& before) { return before.member == row->member; });
  return count;
}
static_assert(member_count<Camera>() == 1 + members_in_table(), "a member of Camera has no row; the name needs none");

}  // namespace

std::span<const CameraProperty> camera_properties() { return kProperties; }

}  // namespace tempolux
