// lib/render/path_tracer.h -- radiance along one camera ray, by layer.
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
  template <class U>
  LayersT& operator+=(const LayersT<U>& more) {
    for (std::size_t l = 0; l < kLayerCount; ++l) value[l] += RgbT<T>(more.value[l]);
    coverage += T(more.coverage);
    return *this;
  }
  LayersT operator+(const LayersT& more) const { return LayersT(*this) += more; }
};
using Layers = LayersT<float>;

/// Mean channel of the sum of all layers [W/m^2/sr].
template <class T>
double radiance_of(const LayersT<T>& layers) {
  double sum = 0;
  for (const RgbT<T>& radiance : layers.value) sum += channel_mean(Rgbd(radiance));
  return sum;
}

/// Noise of stored light, which all samples of a pixel share: numbers with a random sign whose mean squares are the
/// variances of the layers [W/m^2/sr].
template <class T>
struct StoredNoiseT {
  RgbT<T> caustic{T(0)};   ///< of the photons that layer caustic is read from (PhotonLight::caustic)
  RgbT<T> indirect{T(0)};  ///< of the records that layer indirect is read from (IrradianceRecord::noise)
  const RgbT<T>* of(Layer layer) const {
    return layer == Layer::caustic ? &caustic : layer == Layer::indirect ? &indirect : nullptr;
  }
  template <class U>
  StoredNoiseT& operator+=(const StoredNoiseT<U>& more) {
    caustic += RgbT<T>(more.caustic);
    indirect += RgbT<T>(more.indirect);
    return *this;
  }
};
using StoredNoise = StoredNoiseT<float>;

/// Decides which layer light belongs to, from the events of a camera path so far.
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
  /// Passes a pane straight. No event for light behind an event D; what the camera sees through panes is sorted as what
  /// other glass shows.
  void pass_straight() {
    if (sharp_) scatter(false);
  }
  /// Scatters in a medium. After an event S the light counts as part of what that event shows.
  void scatter_in_medium() {
    sharp_ = false;
    if (layer_ == Layer::emission) layer_ = Layer::volume;
    else if (layer_ != Layer::specular && layer_ != Layer::volume) layer_ = Layer::indirect;
  }
  /// True if the path has had no event D yet, so that the camera sees directly or by events S.
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

/// Random numbers of one pixel sample: scrambled Sobol points for the first bounces, hashed numbers afterwards.
class PixelRandom {
 public:
  PixelRandom(std::uint64_t seed, std::uint64_t pixel, std::uint32_t sample)
      : key_(mix64(mix64(seed ^ 0x8f14e45fceea167aull) + pixel * 0x9e3779b97f4a7c15ull)), sample_(sample) {}

  std::uint32_t sample() const { return sample_; }
  /// Random numbers of another sample of the pixel.
  PixelRandom of_sample(std::uint32_t sample) const { return {key_, sample}; }
  Vec2 get2(std::uint32_t bounce, Purpose purpose) const {
    return bounce < kSobolBounces ? sobol_owen_2d(sample_, key(bounce, purpose)) : plain().get2(bounce, purpose);
  }
  float get1(std::uint32_t bounce, Purpose purpose) const {
    return bounce < kSobolBounces ? sobol_owen_1d(sample_, key(bounce, purpose)) : plain().get1(bounce, purpose);
  }

  /// Hashed numbers of this sample alone, for consumers that need an unbounded amount.
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

/// Counters of one thread's work, for statistics.
struct RayCounts {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
  std::uint64_t lookups = 0;      ///< indirect light at the first Lambert lobe that records or photons answered
  std::uint64_t gathered = 0;     ///< indirect light at the first Lambert lobe that a gather ray had to estimate
  std::uint64_t points_read = 0;  ///< hits of such rays and of their continuations that a point represented
  std::uint64_t onward = 0;       ///< bounce and shadow rays that belong to PathParts::onward
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

/// Radiance along one camera ray, in three parts that may have different numbers of samples (docs/pixels.md). The
/// radiance is the sum of the parts. A first matte surface is the first Lambert lobe of a camera path, also after
/// events S.
struct PathParts {
  /// Everything that is in neither of the other two: light seen directly or by events S, and known light at the first
  /// matte surface.
  Layers own;
  Layers lit;                  ///< light sampled at the first matte surface
  Layers onward;               ///< light found by rays from the first matte surface's Lambert lobe
  StoredNoise stored_noise{};  ///< not included in `own`
  Layers sum() const { return own + (lit + onward); }
};

/// Numbers of samples of each part at a path's first matte surface, and the index of the first sample of each part in
/// the pixel's sequences. A part is the sum over its samples.
struct PathEffort {
  std::uint32_t lit = 1, onward = 1;
  std::uint32_t lit_first = 0, onward_first = 0;
};
/// One sample of each part, with the random numbers of the path itself.
inline PathEffort effort_of(std::uint32_t sample) { return {1, 1, sample, sample}; }

class KnownLight;

/// The scene for a renderer. All members must outlive it.
struct RenderScene {
  const Tracer& tracer;
  const Lights& lights;
  /// Send one ray to a directional light and another one to one of the other lights at each surface. With a single ray,
  /// the choice between the two is half of the noise.
  bool suns_apart = false;
  const SceneFrame& frame() const { return tracer.frame(); }
};

/// Radiance along a camera ray, by layer: path tracing with light sampling and scattering joined by the power
/// heuristic [Veach 1997, 9.2], Russian roulette after three bounces, no clamping and no depth limit. Unbiased
/// without `known`.
///
/// With `known`, a path ends where the light is known. The result has the bias of that light, and no light is counted
/// twice:
/// - At the first Lambert lobe x, caustic light is read from photons, if there are any. Light that the path meets by
/// events S after x is then not added.
/// - Indirect light at x is read from records. The path still continues from x to its next hit, because MIS joins the
/// emission of that hit with light sampling. If caustic light is not known, the path also continues by events S.
/// - If no record is valid at x, the path goes on. It ends at the first hit that a point represents.
///
/// An unlit material shows its base colour to the camera, directly and by events S; it lights and scatters nothing.
/// In media (SceneFrame::media) paths move by null collisions and take one light sample at each collision. With
/// `known`, the camera ray is attenuated exactly, and volume-compose adds the light that media scatter towards it;
/// after an event S media scatter as without `known`. Light that media scatter to a matte surface is part of its
/// indirect light.
///
/// `cone` is the pixel's cone, for the level of textures (CameraView::cone); the default reads the finest level.
Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const KnownLight* known, RayCounts& counts, RayCone cone = {});
/// Radiance by parts along a ray whose first hit is known (surface kNone: the ray meets no surface). MIS weights are
/// those of one sample of each part, whatever `effort` is, so each part divided by its number of samples is correct
/// alone.
PathParts trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const Hit& first, const PixelRandom& random,
                         const KnownLight* known, RayCounts& counts, RayCone cone, const PathEffort& effort);

}  // namespace tempolux
