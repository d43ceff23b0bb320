#include "lib/image/frame_identity.h"

#include <algorithm>

namespace tempolux {
namespace {

bool is_other(const Image& image, const char* name, const std::array<double, 16>& matrix) {
  const auto found = image.matrices.find(name);
  const auto same = [](double a, double b) { return float(a) == float(b); };
  return found != image.matrices.end() && !std::ranges::equal(found->second, matrix, same);
}

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

void describe_frame(Image& image, const formats::Identity& identity, int frame, double fps, const std::string& history,
                    const CameraMatrices& camera) {
  set_identity(image, identity);
  image.text["tempolux:history"] = history;
  image.numbers["tempolux:frame"] = frame;
  image.numbers["framesPerSecond"] = fps;
  image.matrices["worldToCamera"] = camera.world_to_camera;
  image.matrices["worldToNDC"] = camera.world_to_ndc;
}

bool shows_other_camera(const Image& image, const CameraMatrices& camera) {
  return is_other(image, "worldToCamera", camera.world_to_camera) || is_other(image, "worldToNDC", camera.world_to_ndc);
}

}  // namespace tempolux
