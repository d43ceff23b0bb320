#include "lib/image/frame_identity.h"

namespace tempolux {
namespace {

std::string attribute_of(const formats::Concern& concern) { return std::string(kIdentityPrefix).append(concern.name); }

}  // namespace

void set_identity(Image& image, const formats::Identity& identity) {
  for (const formats::Concern& concern : formats::kSceneConcerns)
    image.text[attribute_of(concern)] = identity.*concern.hash;
}

formats::Identity identity_in(const Image& image) {
  formats::Identity identity;
  for (const formats::Concern& concern : formats::kSceneConcerns) {
    const auto found = image.text.find(attribute_of(concern));
    if (found != image.text.end()) identity.*concern.hash = found->second;
  }
  if (identity != formats::Identity{}) identity.first_frame = identity.last_frame = 0;
  return identity;
}

}  // namespace tempolux
