// lib/scene/camera_properties.h -- the table of camera properties. The reader of extras and the hash of cameras go
// through its rows. A member of Camera that has no row does not compile (camera_properties.cpp counts the members).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

#include "lib/scene/scene.h"

namespace tempolux {

/// What a property's number means for its member.
enum class CameraRole : std::uint8_t {
  kind,          ///< the kind of projection
  perspective,   ///< counts in perspective cameras only
  orthographic,  ///< counts in orthographic cameras only
  shift,         ///< two numbers, which count where one of them is not 0
  value,         ///< the member is the number
  lens,          ///< the member is the number; counts where the lens is open
  position,      ///< a word: center, start or end
};

/// A row of the table.
struct CameraProperty {
  std::string_view key;  ///< in the `extras` of the camera's node; empty: glTF's camera has it (read_camera)
  std::variant<Camera::Kind Camera::*, Camera::Shutter Camera::*, std::array<double, 2> Camera::*, double Camera::*>
      member;
  CameraRole role = CameraRole::value;
  double upper = 1e9;  ///< largest number that is read: millimetres, metres and frames beyond it are errors; the least
                       ///< is 0

  /// True if the property says what part of the scene the picture shows when everything stands still.
  bool projects() const { return role <= CameraRole::orthographic; }
};

/// The words of CameraRole::position, in the order of Camera::Shutter.
inline constexpr std::array<std::string_view, 3> kShutterPositions{"center", "start", "end"};

std::span<const CameraProperty> camera_properties();

}  // namespace tempolux
