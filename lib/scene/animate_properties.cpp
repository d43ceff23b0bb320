// lib/scene/animate_properties.cpp -- evaluates materials, lights and cameras at a time (KHR_animation_pointer).
#include <algorithm>
#include <numbers>

#include "formats/error.h"
#include "lib/scene/animate.h"
#include "lib/scene/material_properties.h"

namespace tempolux {
namespace {

using Path = AnimationTrack::Path;

float limited(double value, double lower, double upper = 3e38) { return float(std::clamp(value, lower, upper)); }

Rgb limited_colour(const std::array<double, 4>& v, double upper = 3e38) {
  return {limited(v[0], 0, upper), limited(v[1], 0, upper), limited(v[2], 0, upper)};
}

void check_product(const Scene& scene, const char* array, int index, const Rgb& product) {
  if (!is_finite(product))
    throw InputError(scene.path + ": " + array + "[" + std::to_string(index) +
                     "]: its animation takes colour times strength beyond float32");
}

}  // namespace

const char* kind_of(Path path) {
  return path <= Path::visible      ? "node"
         : path == Path::material   ? "material"
         : path <= Path::outer_cone ? "light"
                                    : "camera";
}

std::vector<Material> Animator::materials(double time_s) const {
  std::vector<Material> materials = scene_->materials;
  for (const AnimationTrack* track : property_tracks_) {
    if (track->path != Path::material) continue;
    const std::size_t target = std::size_t(track->target);
    ColorFactors emission = scene_->emission_factors[target];
    // The emission is a product of factors that may have separate tracks, so all of these tracks are evaluated.
    const bool emits = changes_emission(*track);
    for (const AnimationTrack* other : property_tracks_)
      if (other == track || (emits && other->target == track->target && changes_emission(*other)))
        set_property(material_properties()[other->property], evaluate(*other, time_s), materials[target], emission);
    if (emits) finish_emission(emission, materials[target]);
    check_product(*scene_, "materials", track->target, materials[target].emission);
  }
  return materials;
}

PunctualLight Animator::light(std::size_t index, double time_s) const {
  PunctualLight light = scene_->lights[index];
  ColorFactors factors = index < scene_->light_factors.size() ? scene_->light_factors[index] : ColorFactors{};
  bool product = false;
  double inner = light.inner_cone_rad, outer = light.outer_cone_rad;
  for (const AnimationTrack* track : property_tracks_) {
    if (std::size_t(track->target) != index) continue;
    if (track->path < Path::light_color || track->path > Path::outer_cone) continue;
    const std::array<double, 4> v = evaluate(*track, time_s);
    switch (track->path) {
      case Path::light_color:
        factors.color = limited_colour(v);
        product = true;
        break;
      case Path::light_intensity:
        factors.strength = limited(v[0], 0);
        product = true;
        break;
      case Path::inner_cone: inner = v[0]; break;
      default: outer = v[0]; break;
    }
    outer = std::clamp(outer, kNarrowestSpot, kWidestSpot);
    light.outer_cone_rad = float(outer);
    light.inner_cone_rad = float(std::clamp(inner, 0.0, outer * kSharpestSpot));
  }
  if (product) light.intensity = factors.color * factors.strength;
  check_product(*scene_, "extensions.KHR_lights_punctual.lights", int(index), light.intensity);
  return light;
}

Camera Animator::camera(std::size_t index, double time_s) const {
  Camera camera = scene_->cameras[index];
  for (const AnimationTrack* track : property_tracks_) {
    if (std::size_t(track->target) != index) continue;
    if (track->path == Path::yfov) camera.yfov_rad = std::clamp(evaluate(*track, time_s)[0], 1e-4, 3.14159);
    if (track->path == Path::ymag) camera.ymag_m = std::max(evaluate(*track, time_s)[0], 1e-9);
  }
  return camera;
}

}  // namespace tempolux
