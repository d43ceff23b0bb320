// lib/render/path_tracer.h -- radiance along one camera ray, told apart by layer.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/core/sobol.h"
#include "lib/light/lights.h"
#include "lib/material/surface_material.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Layers of a frame (architecture.md 3); their sum, in this order, is the image.
enum class Layer : std::uint8_t { emission, specular, direct, caustic, indirect, volume };
inline constexpr std::size_t kLayerCount = 6;
inline constexpr std::array<const char*, kLayerCount> kLayerNames{"emission", "specular", "direct", "caustic", "indirect", "volume"};

/// Radiance [W/m^2/sr] by layer.
template <class T>
struct LayersT {
  std::array<RgbT<T>, kLayerCount> value{};
  T coverage = 0;                  ///< 1 if the camera ray met a surface or a medium: the alpha channel
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
  std::uint64_t camera = 0, bounce = 0, shadow = 0, lookups = 0;
  RayCounts& operator+=(const RayCounts& o) {
    camera += o.camera; bounce += o.bounce; shadow += o.shadow; lookups += o.lookups;
    return *this;
  }
};

/// What replaces the path beyond its first Lambert scattering, if anything: irradiance [W/m^2] by kind.
class DiffuseLight {
 public:
  static constexpr float kSparseReach = 1 / 16.0f;
  struct Irradiance {
    Rgb caustic{0.0f}, indirect{0.0f};
    float sparse_radius = 0;  ///< m: over which caustic light is averaged, where photons are few within kSparseReach of it; else 0
  };
  virtual ~DiffuseLight() = default;
  /// Light arriving at the point; both normals are unit and on the side seen. `direct_view`: the camera ray itself met it,
  /// no mirror, glass or gloss sent the path there. `caustic`: if not null, known already. Thread-safe.
  virtual Irradiance at(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, bool direct_view, const Rgb* caustic) const = 0;
};

/// Samples of the large lights (Lights::has_large) at the ends of eye paths, shadows left out, less what they are in the mean,
/// which is known: the noise of sampling but for its shadows. Sums over samples of a pixel.
struct LightControl {
  Rgb direct{0.0f}, specular{0.0f};   ///< by layer: sampled less exact [W/m^2/sr]; 0 in the mean
  float sampled = 0, seen = 0;        ///< samples without and with shadows, mean of the channels
  int seen_matte = 0;                 ///< paths that ended at the camera ray's own hit
  LightControl& operator+=(const LightControl& o) {
    direct += o.direct; specular += o.specular; sampled += o.sampled; seen += o.seen; seen_matte += o.seen_matte;
    return *this;
  }
};

/// The scene as a renderer sees it; all must outlive it.
struct RenderScene {
  const Tracer& tracer;
  const Lights& lights;
  const SceneFrame& frame() const { return tracer.frame(); }
};

/// Radiance along a camera ray, by layer: unbiased path tracing with light sampling and scattering joined by
/// the power heuristic [Veach 1997, 9.2], roulette after three bounces, nothing clamped, no depth limit.
///
/// With `diffuse_light` the path ends at its first Lambert lobe x: direct light there by light sampling alone,
/// caustic and indirect light = rho/pi times the irradiance given (biased as that irradiance is).
///
/// An unlit material shows its base colour as radiance to the eye, directly and through events S alone (layers emission
/// and specular); it lights nothing and scatters nothing, here and in photon-trace alike.
/// Media (SceneFrame::media): free flight by null collisions, lamps sampled at each collision. With `diffuse_light` the camera
/// ray itself passes them attenuated, exactly, and what they scatter towards it is left to volume-compose; beyond an event S
/// they scatter as without.
/// `control`, with `diffuse_light` and where Lights::has_large(): at matte ends the large lights and the others get a sample
/// each, and `control` is told what shadows have no part in.
/// `cone` is the pixel's, for the level of textures (CameraView::cone); the default reads their finest level.
Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const DiffuseLight* diffuse_light, RayCounts& counts, RayCone cone = {});

/// A camera ray and what it meets first; surface kNone: nothing.
struct EyeRay {
  Ray ray;
  Hit hit;
  RayCone cone;
  std::uint32_t first_light = 0, lights = 1;   ///< with a control: which samples' light a matte end takes the mean of
};
/// Several samples of a pixel, at most kPathsTogether: layers[i] of eyes[i], by the numbers of sample first + i. `controls`:
/// empty, or one for each (several may be the same); then their matte ends sample the lights together.
inline constexpr std::size_t kPathsTogether = 8;
void trace_eye_paths(const RenderScene& scene, std::span<const EyeRay> eyes, const PixelRandom& random, std::uint32_t first,
                     const DiffuseLight* diffuse_light, RayCounts& counts, std::span<LightControl* const> controls, Layers* layers);

}  // namespace tempolux
