// lib/aqm/identity_check.h -- whether two frames show the same state of the same scene.
#pragma once

#include <string>

#include "lib/image/image.h"

namespace tempolux {

struct IdentityMatch {
  bool known = false;        ///< both frames carry at least one hash
  std::string different;     ///< concerns whose hashes differ, "lights, materials"; empty if none do
};

/// Compares the string attributes "tempolux:identity.CONCERN" of two frames (static_geometry,
/// moving_geometry, materials, lights, media). A concern that one of them leaves out or empty never differs.
IdentityMatch match_identities(const Image& a, const Image& b);

}  // namespace tempolux
