#include "lib/render/data_channels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"
#include "lib/material/bsdf.h"
#include "lib/render/known_light.h"
#include "lib/transport/specular_chain.h"

namespace tempolux {
namespace {

/// Values of the channels of one pixel.
struct Shown {
  float depth = 0;
  Vec3 normal{};
  std::uint32_t id = kNone;
  Rgb albedo{1.0f};
};

/// The direction in which a mirror or smooth glass continues the ray; empty if the surface has no delta lobe.
std::optional<Scattered> sharp_way(const ShadingPoint& shading) {
  if (!shading.bsdf.has_specular() || !shading.bsdf.specular_is_delta()) return std::nullopt;
  // 0.5 chooses the lobe that has more than half of the light. If that is a Lambert lobe below a mirror, a number close
  // to 0 or 1 chooses the mirror.
  for (const float lobe : {0.5f, 0.0001f, 0.9999f}) {
    const Scattered next(shading, lobe, {0.5f, 0.5f});
    if (next.sample.delta && !next.sample.diffuse && !is_black(next.sample.weight)) return next;
  }
  return std::nullopt;
}

/// Hash of the objects on a path. `id`: hash of the objects so far, to which the next object is added.
std::uint32_t mixed(std::uint32_t id, std::uint32_t next) {
  const std::uint32_t hash = (id ^ (next + 0x9e3779b9u)) * 0x85ebca6bu;
  return hash ^ (hash >> 15);
}

/// Follows a camera ray through mirrors and glass to the first surface without a delta lobe.
Shown follow(const Tracer& tracer, const CameraView& view, const Ray& eye) {
  Shown shown;
  SpecularChain chain(tracer, eye);
  while (chain.meet()) {
    const bool mirrored = chain.events() > 0;
    const ShadingPoint& shading = chain.shade(view.pixel_size(chain.way()));
    shown.id = mirrored ? mixed(shown.id, chain.point().object) : chain.point().object;
    shown.depth = float(view.depth(eye.origin + eye.direction * chain.way()));
    shown.normal = shading.normal;
    const Vec3 wo{shading.wo_local.x, shading.wo_local.y, std::max(shading.wo_local.z, 1e-3f)};
    shown.albedo = shading.bsdf.has_specular() ? shading.bsdf.specular_albedo(wo) : Rgb(mirrored ? 0.0f : 1.0f);
    if (mirrored) shown.albedo += shading.bsdf.diffuse_reflectance(wo);
    if (mirrored && transmits_diffusely(chain.material()))
      shown.albedo += Bsdf(on_far_side(chain.material())).diffuse_reflectance(wo);
    const std::optional<Scattered> next = chain.events() < kMostMirrors ? sharp_way(shading) : std::nullopt;
    if (!next) return shown;
    chain.go_on(*next);
  }
  return {.id = chain.events() > 0 ? mixed(shown.id, kNone) : kNone};
}

}  // namespace

void add_seen_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       Image& image) {
  if (!asked(channels, "seen")) return;
  constexpr std::array<const char*, 7> kNames{"seen.Z",        "seen.N.X",      "seen.N.Y",     "seen.N.Z",
                                              "seen.albedo.R", "seen.albedo.G", "seen.albedo.B"};
  std::array<float*, kNames.size()> to{};
  for (std::size_t i = 0; i < kNames.size(); ++i) to[i] = image.add(kNames[i]).values.data();
  std::uint32_t* const ids = image.add_ids("seen.id").ids.data();
  parallel_pixels(view.width(), view.height(), [&](int x, int y, std::size_t p) {
    const Shown shown = follow(scene.tracer, view, view.middle(x, y));
    const std::array<float, kNames.size()> values{shown.depth,    shown.normal.x, shown.normal.y, shown.normal.z,
                                                  shown.albedo.r, shown.albedo.g, shown.albedo.b};
    for (std::size_t i = 0; i < values.size(); ++i) to[i][p] = values[i];
    ids[p] = shown.id;
  });
}

}  // namespace tempolux
