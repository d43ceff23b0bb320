// lib/aqm/identity_check.cpp -- identity attributes side by side.
#include "lib/aqm/identity_check.h"

namespace tempolux {
namespace {

/// Empty if the image does not say.
std::string hash_of(const Image& image, const std::string& key) {
  const auto found = image.text.find(key);
  return found == image.text.end() ? "" : found->second;
}

}  // namespace

IdentityMatch match_identities(const Image& a, const Image& b) {
  IdentityMatch match;
  bool a_known = false, b_known = false;
  for (const char* concern : {"static_geometry", "moving_geometry", "materials", "lights", "media"}) {
    const std::string key = std::string("tempolux:identity.") + concern;
    const std::string in_a = hash_of(a, key), in_b = hash_of(b, key);
    a_known = a_known || !in_a.empty();
    b_known = b_known || !in_b.empty();
    if (in_a.empty() || in_b.empty() || in_a == in_b) continue;
    match.different += (match.different.empty() ? "" : ", ") + std::string(concern);
  }
  match.known = a_known && b_known;
  return match;
}

}  // namespace tempolux
