// lib/render/pixel_light.h -- caustic and indirect light asked for once where a pixel's samples, or a tile's, would hear the same.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Caustic light where photons are few: stray ones, each a disc as wide as estimates may be. It changes by little over a fraction
/// of that width, and its estimate costs as much as all else a pixel asks for, so what was found nearby on the same surface,
/// facing the same way, is taken again: light moves by kSparseReach of the width at most. Which answers are kept follows from the
/// photons' number alone: were it from the answer, bright ones of a noisy estimate would be kept less often than dark ones.
/// One for each tile: what is known does not depend on threads.
class SparseCaustics {
 public:
  /// Light known for this place; nullptr: none.
  const Rgb* find(const SurfacePoint& surface, Vec3 geometric) const {
    if (next_ == 0) return nullptr;   // no photons, or none are sparse
    for (const Kept& kept : kept_)
      if (kept.surface == surface.surface && length2(kept.position - surface.position) < kept.reach2 &&
          dot(kept.normal, geometric) > kSameNormal)
        return &kept.caustic;
    return nullptr;
  }
  void keep(const SurfacePoint& surface, Vec3 geometric, const DiffuseLight::Irradiance& light) {
    const float reach = DiffuseLight::kSparseReach * light.sparse_radius;
    if (!(reach > 0)) return;
    kept_[next_++ % kept_.size()] = {surface.surface, surface.position, geometric, reach * reach, light.caustic};
  }

 private:
  static constexpr float kSameNormal = 0.9995f;   // 2 degrees
  struct Kept {
    std::uint32_t surface = kNone;
    Vec3 position, normal;
    float reach2 = 0;   ///< m^2
    Rgb caustic{0.0f};
  };
  std::array<Kept, 32> kept_;
  std::size_t next_ = 0;
};

/// A pixel's first sample on a surface asks for caustic and indirect light, later ones that meet it there with about the
/// same normal take its answer: that light is smooth, the first sample's place is random, and the others are there for the
/// direct light. What is seen in a mirror or gloss may be far away on the same surface: there answers hold for kPixels
/// pixels, as large as the camera would see them there without the mirror, and for a few centimetres (of a hall; kNearby).
class PixelLight : public DiffuseLight {
 public:
  struct Answer {
    std::uint32_t surface = kNone;
    Vec3 normal;
    Irradiance irradiance;
  };
  using Memory = std::array<Answer, 2>;   ///< of the pixel; surfaces beyond are asked for each time
  PixelLight(const DiffuseLight& light, Memory& memory, SparseCaustics& sparse, const CameraView& view, float scene_size)
      : light_(light), memory_(memory), sparse_(sparse), eye_(view.eye()), cone_(view.cone()),
        nearby2_(kNearby * scene_size * kNearby * scene_size) {}

  Irradiance at(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, bool direct_view, const Rgb* caustic) const override {
    if (!direct_view) return in_mirror(surface, geometric, shading, caustic);
    for (Answer& answer : memory_) {
      if (answer.surface == kNone) {
        answer = {surface.surface, shading, ask(surface, geometric, shading, true, caustic)};
        return answer.irradiance;
      }
      if (answer.surface == surface.surface && dot(answer.normal, shading) > kSameNormal) return answer.irradiance;
    }
    return ask(surface, geometric, shading, true, caustic);
  }

 private:
  static constexpr float kSameNormal = 0.9995f;      // 2 degrees
  static constexpr float kNearby = 1 / 256.0f;       // of the scene's diagonal
  static constexpr float kPixels = 4;
  struct PlacedAnswer : Answer {
    Vec3 position;
  };

  Irradiance ask(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, bool direct_view, const Rgb* caustic) const {
    if (!caustic) caustic = sparse_.find(surface, geometric);
    const Irradiance light = light_.at(surface, geometric, shading, direct_view, caustic);
    if (!caustic) sparse_.keep(surface, geometric, light);
    return light;
  }

  /// Square of a pixel's size where the camera is as far as a point; one of the cone's two numbers is 0.
  float pixel2(Vec3 point) const {
    return cone_.width * cone_.width + cone_.spread * cone_.spread * length2(point - eye_);
  }

  Irradiance in_mirror(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, const Rgb* caustic) const {
    const float reach2 = std::min(nearby2_, kPixels * kPixels * pixel2(surface.position));
    for (const PlacedAnswer& answer : mirrored_)
      if (answer.surface == surface.surface && dot(answer.normal, shading) > kSameNormal &&
          length2(answer.position - surface.position) < reach2)
        return answer.irradiance;
    PlacedAnswer& oldest = mirrored_[next_++ % mirrored_.size()];
    oldest = {{surface.surface, shading, ask(surface, geometric, shading, false, caustic)}, surface.position};
    return oldest.irradiance;
  }

  const DiffuseLight& light_;
  Memory& memory_;
  SparseCaustics& sparse_;
  Vec3 eye_;
  RayCone cone_;
  float nearby2_;
  mutable std::array<PlacedAnswer, 4> mirrored_;
  mutable std::size_t next_ = 0;
};

}  // namespace tempolux
