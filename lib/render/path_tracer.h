// lib/render/path_tracer.h -- radiance along one camera ray, told apart by layer.
#pragma once

#include <array>
#include <cstdint>

#include "lib/core/random.h"
#include "lib/core/sobol.h"
#include "lib/light/lights.h"
#include "lib/material/surface_material.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Layers of a frame (formats/conventions.md); their sum, in this order, is the image.
enum class Layer : std::uint8_t { emission, specular, direct, caustic, indirect, volume };
inline constexpr std::size_t kLayerCount = 6;
inline constexpr std::array<const char*, kLayerCount> kLayerNames{"emission", "specular", "direct",
                                                                  "caustic",  "indirect", "volume"};

/// Radiance [W/m^2/sr] by layer.
template <class T>
struct LayersT {
  std::array<RgbT<T>, kLayerCount> value{};
  T coverage = 0;  ///< 1 if the camera ray met a surface or a medium: the alpha channel
  RgbT<T>& operator[](Layer layer) { return value[std::size_t(layer)]; }
  const RgbT<T>& operator[](Layer layer) const { return value[std::size_t(layer)]; }
};
using Layers = LayersT<float>;

/// Which layer light belongs to that is seen after the events of an eye path so far.
class EyePath {
 public:
  void scatter(bool diffuse) {
    sharp_ = sharp_ && !diffuse;
    switch (layer_) {
      case Layer::emission: layer_ = diffuse ? Layer::direct : Layer::specular; break;
      case Layer::specular: break;
      case Layer::direct: layer_ = diffuse ? Layer::indirect : Layer::caustic; break;
      case Layer::caustic: layer_ = diffuse ? Layer::indirect : Layer::caustic; break;
      case Layer::indirect: break;
      case Layer::volume: break;
    }
  }
  /// In a medium. What an S sent there is part of what is seen by it.
  void scatter_in_medium() {
    sharp_ = false;
    if (layer_ == Layer::emission) layer_ = Layer::volume;
    else if (layer_ != Layer::specular && layer_ != Layer::volume) layer_ = Layer::indirect;
  }
  /// Has the path no event D yet? Only then is it the eye that looks at what it meets.
  bool sharp() const { return sharp_; }
  EyePath after(bool diffuse) const {
    EyePath next = *this;
    next.scatter(diffuse);
    return next;
  }
  Layer layer() const { return layer_; }

 private:
  Layer layer_ = Layer::emission;
  bool sharp_ = true;
};

/// Random numbers of one pixel sample: scrambled Sobol points for the first bounces, hashed ones beyond.
class PixelRandom {
 public:
  PixelRandom(std::uint64_t seed, std::uint64_t pixel, std::uint32_t sample)
      : key_(mix64(mix64(seed ^ 0x8f14e45fceea167aull) + pixel * 0x9e3779b97f4a7c15ull)), sample_(sample) {}

  std::uint32_t sample() const { return sample_; }
  /// Those of another sample of the pixel.
  PixelRandom of_sample(std::uint32_t sample) const { return {key_, sample}; }
  Vec2 get2(std::uint32_t bounce, Purpose purpose) const {
    return bounce < kSobolBounces ? sobol_owen_2d(sample_, key(bounce, purpose)) : plain().get2(bounce, purpose);
  }
  float get1(std::uint32_t bounce, Purpose purpose) const {
    return bounce < kSobolBounces ? sobol_owen_1d(sample_, key(bounce, purpose)) : plain().get1(bounce, purpose);
  }

  /// Hashed numbers of this sample alone: for what takes as many as it comes to.
  PathRandom hashed() const { return plain(); }

 private:
  PixelRandom(std::uint64_t key, std::uint32_t sample) : key_(key), sample_(sample) {}
  PathRandom plain() const { return {key_, sample_}; }
  static constexpr std::uint32_t kSobolBounces = 4;
  std::uint64_t key(std::uint32_t bounce, Purpose purpose) const {
    return key_ + (std::uint64_t(bounce) * 64 + std::uint64_t(purpose)) * 0xd1342543de82ef95ull;
  }
  std::uint64_t key_;
  std::uint32_t sample_;
};

/// Counters of one thread's work, for stats.
struct RayCounts {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
  std::uint64_t lookups = 0;      ///< of indirect light where the eye looks: answered by records or photons
  std::uint64_t gathered = 0;     ///< and answered by none: a ray of the hemisphere was to find it
  std::uint64_t points_read = 0;  ///< ends of such rays, and of those that went on, that a point stood for
  std::uint64_t onward = 0;       ///< of bounce and shadow those of PathParts::onward
  RayCounts& operator+=(const RayCounts& o) {
    camera += o.camera;
    bounce += o.bounce;
    shadow += o.shadow;
    lookups += o.lookups;
    gathered += o.gathered;
    points_read += o.points_read;
    onward += o.onward;
    return *this;
  }
};

/// Radiance along one camera ray in the parts that may have sample numbers of their own (docs/pixels.md). Their sum is
/// the radiance. The first matte surfaces are those that the eye sees, also by way of events S.
struct PathParts {
  Layers own;     ///< all that the other two do not have: what is seen, also by events S, and what is known there
  Layers lit;     ///< by a place on a light, drawn at the first matte surfaces
  Layers onward;  ///< by the ray that goes on from their Lambert lobe
  Layers sum() const {
    Layers all = own;
    for (std::size_t l = 0; l < kLayerCount; ++l) all.value[l] += lit.value[l] + onward.value[l];
    return all;
  }
};

/// How many samples of each part a path takes at its first matte surfaces, and the numbers of the first of each: they
/// are drawn from the pixel's sequences of these parts. The parts are the sums of so many samples.
struct PathEffort {
  std::uint32_t lit = 1, onward = 1;
  std::uint32_t lit_first = 0, onward_first = 0;
};
/// One of each, of the numbers of the path itself.
inline PathEffort effort_of(std::uint32_t sample) { return {1, 1, sample, sample}; }

class KnownLight;

/// The scene as a renderer sees it; all must outlive it.
struct RenderScene {
  const Tracer& tracer;
  const Lights& lights;
  /// At each surface one ray goes to a sun and another to one of the other lights: which it is to be is half of the
  /// noise otherwise.
  bool suns_apart = false;
  const SceneFrame& frame() const { return tracer.frame(); }
};

/// Radiance along a camera ray, by layer: path tracing with light sampling and scattering joined by the power heuristic
/// [Veach 1997, 9.2], roulette after three bounces, nothing clamped, no depth limit. Unbiased without `known`.
///
/// With `known` paths end where their light is known (biased as that is), and nothing is counted twice:
/// - at the first Lambert lobe x caustic light is that of photons, if there are any; then no light counts that the path
/// meets
///   by way of events S beyond x;
/// - indirect light at x is that of records. The path still goes on to what its next ray meets, for that ray joins
/// light sampling,
///   and by events S, if caustic light is not known;
/// - where no record is near, that ray goes on: it ends where a point tells the light of all kinds, or goes on as a
/// path.
///
/// An unlit material shows its base colour as radiance to the eye, directly and through events S alone (layers emission
/// and specular); it lights nothing and scatters nothing, here and in photon-trace alike.
/// Media (SceneFrame::media): free flight by null collisions, lamps sampled at each collision. With `known` the camera
/// ray itself passes them attenuated, exactly, and what they scatter towards it is left to volume-compose; beyond an
/// event S they scatter as without. What they scatter to a matte surface is part of its indirect light. `cone` is the
/// pixel's, for the level of textures (CameraView::cone); the default reads their finest level.
Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const KnownLight* known, RayCounts& counts, RayCone cone = {});
/// The same of a ray whose first hit is known (surface kNone: nothing), by parts. The weights that join light sampling
/// and scattering are those of one sample of each part, whatever `effort` says: so each part divided by its number is
/// right by itself.
PathParts trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const Hit& first, const PixelRandom& random,
                         const KnownLight* known, RayCounts& counts, RayCone cone, const PathEffort& effort);

}  // namespace tempolux
