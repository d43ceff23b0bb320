// lib/image/frame_identity.h -- attributes that identify the scene and the state that a frame shows
// (formats/frames/frames.md 3).
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "formats/identity.h"
#include "lib/image/image.h"

namespace tempolux {

inline constexpr std::string_view kIdentityPrefix = "tempolux:identity.";  ///< prefix of a concern's name

/// Writes the attributes tempolux:identity.CONCERN for all concerns of the scene. An unknown hash becomes an empty
/// text.
void set_identity(Image& image, const formats::Identity& identity);

/// Reads what set_identity() wrote. The hash of a missing attribute is unknown. The result is valid for frame 0 alone,
/// whatever tempolux:frame contains. Without any hash it is not known().
formats::Identity identity_in(const Image& image);

/// The camera of a picture, in the form of its attributes (formats/frames/frames.md 3).
struct CameraMatrices {
  std::array<double, 16> world_to_camera{}, world_to_ndc{};
};
/// Writes the attributes of a rendered frame: identity, tempolux:frame, framesPerSecond, history and camera.
void describe_frame(Image& image, const formats::Identity& identity, int frame, double fps, const std::string& history,
                    const CameraMatrices& camera);

/// True if the image has camera attributes and they differ from `camera` after rounding to float32, as files store
/// them.
bool shows_other_camera(const Image& image, const CameraMatrices& camera);

}  // namespace tempolux
