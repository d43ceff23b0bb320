// lib/render/path_tracer.h -- radiance along one camera ray, by layer.
#pragma once

#include <array>
#include <cstdint>

#include "lib/core/random.h"
#include "lib/core/sobol.h"
#include "lib/light/lights.h"
#include "lib/material/inside.h"
#include "lib/material/surface_material.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Layers of a frame (formats/conventions.md). Their sum, in this order, is the picture.
enum class Layer : std::uint8_t { emission, specular, direct, caustic, indirect, volume };
inline constexpr std::size_t kLayerCount = 6;
inline constexpr std::array<const char*, kLayerCount> kLayerNames{"emission", "specular", "direct",
                                                                  "caustic",  "indirect", "volume"};

/// Radiance [W/m^2/sr] by layer.
template <class T>
struct LayersT {
  std::array<RgbT<T>, kLayerCount> value{};
  T coverage = 0;  ///< 1 if the camera ray met a surface or a medium: the alpha channel
  T mirrored = 0;  ///< mean channel of the lamps and sky in layer specular, which the camera sees by events S alone
  RgbT<T>& operator[](Layer layer) { return value[std::size_t(layer)]; }
  const RgbT<T>& operator[](Layer layer) const { return value[std::size_t(layer)]; }
  template <class U>
  LayersT& operator+=(const LayersT<U>& more) {
    for (std::size_t l = 0; l < kLayerCount; ++l) value[l] += RgbT<T>(more.value[l]);
    coverage += T(more.coverage);
    mirrored += T(more.mirrored);
    return *this;
  }
  LayersT operator+(const LayersT& more) const { return LayersT(*this) += more; }
};
using Layers = LayersT<float>;

/// Sum of all layers [W/m^2/sr], in the precision T.
template <class T>
RgbT<T> sum_of_layers(const Layers& layers) {
  RgbT<T> sum(T(0));
  for (const Rgb& radiance : layers.value) sum += RgbT<T>(radiance);
  return sum;
}
/// The same, mean of the channels.
template <class T>
double radiance_of(const LayersT<T>& layers) {
  double sum = 0;
  for (const RgbT<T>& radiance : layers.value) sum += channel_mean(Rgbd(radiance));
  return sum;
}

/// Noise of the records and photons that all samples of a pixel read [W/m^2/sr]: numbers with a random sign whose mean
/// squares are the variances of the layers.
template <class T>
struct StoredNoiseT {
  RgbT<T> caustic{T(0)};   ///< of the photons in layer caustic (FootprintLight::noise)
  RgbT<T> indirect{T(0)};  ///< of the records in layer indirect (IrradianceRecord::noise)
  /// null: the layer has no such noise.
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

/// The layer of the light that a camera path finds, by the events of the path so far.
class EyePath {
 public:
  /// Adds an event D (diffuse) or S at a surface.
  void scatter(bool diffuse) {
    sharp_ = sharp_ && !diffuse;
    if (layer_ == Layer::emission) layer_ = diffuse ? Layer::direct : Layer::specular;
    else if (layer_ == Layer::direct || layer_ == Layer::caustic) layer_ = diffuse ? Layer::indirect : Layer::caustic;
  }
  /// Passes a pane straight. After an event D this is no event. Before it, this is an event S, as for other glass.
  void pass_straight() {
    if (sharp_) scatter(false);
  }
  /// Adds an event in a medium. The layer specular stays: it holds all light that mirrors and glass show.
  void scatter_in_medium() {
    sharp_ = false;
    if (layer_ == Layer::emission) layer_ = Layer::volume;
    else if (layer_ != Layer::specular && layer_ != Layer::volume) layer_ = Layer::indirect;
  }
  /// True if the path has had no event D and no event in a medium: the camera sees directly or by events S.
  bool sharp() const { return sharp_; }
  /// True after events S alone, at least one: the camera sees lamps and sky in mirrors and glass (Layers::mirrored).
  bool only_specular() const { return sharp_ && layer_ == Layer::specular; }
  /// The path with one more event.
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

/// Random numbers of one sample of a pixel. The first bounces draw points of scrambled Sobol sequences, one sequence
/// for each bounce and purpose; later bounces draw hashed numbers.
class PixelRandom {
 public:
  PixelRandom(std::uint64_t seed, std::uint64_t pixel, std::uint32_t sample)
      : key_(mix64(mix64(seed ^ 0x8f14e45fceea167aull) + pixel * 0x9e3779b97f4a7c15ull)), sample_(sample) {}

  std::uint32_t sample() const { return sample_; }
  /// Random numbers of another sample of the pixel.
  PixelRandom of_sample(std::uint32_t sample) const { return {key_, sample}; }
  /// Two numbers in [0, 1).
  Vec2 get2(std::uint32_t bounce, Purpose purpose) const {
    return bounce < kSobolBounces ? sobol_owen_2d(sample_, key(bounce, purpose)) : hashed().get2(bounce, purpose);
  }
  /// One number in [0, 1).
  float get1(std::uint32_t bounce, Purpose purpose) const {
    return bounce < kSobolBounces ? sobol_owen_1d(sample_, key(bounce, purpose)) : hashed().get1(bounce, purpose);
  }

  /// Hashed numbers of this sample, for decisions whose number has no bound.
  PathRandom hashed() const { return {key_, sample_}; }

 private:
  /// Sobol points for all bounces change neither error nor CPU time (docs/notebook/constants.md).
  static constexpr std::uint32_t kSobolBounces = 4;

  PixelRandom(std::uint64_t key, std::uint32_t sample) : key_(key), sample_(sample) {}
  std::uint64_t key(std::uint32_t bounce, Purpose purpose) const {
    return key_ + (std::uint64_t(bounce) * 64 + std::uint64_t(purpose)) * 0xd1342543de82ef95ull;
  }
  std::uint64_t key_;
  std::uint32_t sample_;
};

/// Numbers of rays and look-ups, for statistics and for costs.
struct RayCounts {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
  std::uint64_t lookups = 0;      ///< first Lambert lobes whose indirect light was known (KnownLight::indirect)
  std::uint64_t gathered = 0;     ///< first Lambert lobes whose indirect light a gather ray had to estimate
  std::uint64_t points_read = 0;  ///< hits whose light was read from a point (KnownLight::point_light)
  std::uint64_t onward = 0;       ///< cost of the rays of PathParts::onward: 2 for each of onward_bounce, 1 for others
  std::uint64_t onward_bounce = 0;  ///< nearest hits of PathParts::onward
  RayCounts& operator+=(const RayCounts& o) {
    camera += o.camera;
    bounce += o.bounce;
    shadow += o.shadow;
    lookups += o.lookups;
    gathered += o.gathered;
    points_read += o.points_read;
    onward += o.onward;
    onward_bounce += o.onward_bounce;
    return *this;
  }
};

/// Radiance along one camera ray, as the sum of three parts that may have different numbers of samples
/// (docs/pixels.md). The first matte surface is the first Lambert lobe of a camera path, also after events S.
struct PathParts {
  /// All other light: light seen directly or by events S, sampled suns, and known light at the first matte surface.
  Layers own;
  Layers lit;                  ///< light sampled at the first matte surface
  Layers onward;               ///< light found by rays from the first matte surface's Lambert lobe
  StoredNoise stored_noise{};  ///< not included in `own`
  Layers sum() const { return own + (lit + onward); }
};

/// Numbers of samples of two parts at a path's first matte surface, and the indices of the first of them in the pixel's
/// Sobol sequences. A part of PathParts is the sum over its samples.
struct PathEffort {
  std::uint32_t lit = 1, onward = 1;
  std::uint32_t lit_first = 0, onward_first = 0;
};
/// One sample of each part, with this index.
inline PathEffort effort_of(std::uint32_t sample) { return {1, 1, sample, sample}; }

class KnownLight;
class StoredPlaces;

/// The scene for a renderer. Both references must outlive this object.
struct RenderScene {
  const Tracer& tracer;
  const Lights& lights;
  /// At each surface, sample a directional light and also one of the other lights. With one sample for both, the choice
  /// between them is half of the noise.
  bool suns_apart = false;
  Inside camera_inside{};  ///< the absorbing solid in which camera paths start
  /// At a moment of a shutter: finds the place of a hit in the scene that stored light belongs to. Null: the scene
  /// itself holds the stored light.
  const StoredPlaces* stored = nullptr;
  /// Camera paths leave out light of lamps (not of the sky) that mirrors and smooth glass send on to a matte surface or
  /// a medium in the layers caustic and indirect. add_hidden_light() adds this light by light paths.
  bool without_hidden_light = false;
  const SceneFrame& frame() const { return tracer.frame(); }
};

/// Radiance [W/m^2/sr] along a camera ray (unit direction, scene space), by layer. Path tracing: MIS by the power
/// heuristic joins light samples and scattering [Veach 1997, 9.2]; Russian roulette after three bounces; no clamping
/// and no depth limit. Unbiased without `known` (null).
///
/// With `known`, a path ends where the light is known. The result has the bias of that light, and no light is counted
/// twice:
/// - At the first Lambert lobe x, caustic light comes from photons, if there are any. Lights that the path meets by
/// events S after x then add nothing.
/// - Indirect light at x comes from records. The path still continues from x to its next hit, because MIS joins the
/// emission of that hit with light samples. If caustic light is not known, the path also continues by events S.
/// - If no record is valid at x, the path continues and ends at the first hit that a point represents.
///
/// An unlit material shows its base colour to the camera, directly and by events S; it neither lights nor scatters. In
/// media (SceneFrame::media) paths move by null collisions and take one light sample at each collision. With `known`,
/// media attenuate the camera ray exactly, and volume-compose adds the light that they scatter towards the camera;
/// after an event S media scatter as without `known`. Light that media scatter to a matte surface is part of its
/// indirect light.
///
/// `cone`: the pixel's cone (CameraView::cone), for the level of textures; the default reads the finest level.
/// Thread-safe if each thread has its own `counts`.
Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const KnownLight* known, RayCounts& counts, RayCone cone = {});
/// A camera ray with its pixel's cone and what it meets first (surface kNone: no surface).
struct EyeRay {
  Ray ray;
  Hit first;
  RayCone cone;
};
/// The same by parts. MIS weighs samples as if each part had one sample, whatever `effort` is, so the mean of each part
/// over its samples has no bias.
PathParts trace_eye_parts(const RenderScene& scene, const EyeRay& eye, const PixelRandom& random,
                          const KnownLight* known, RayCounts& counts, const PathEffort& effort);

}  // namespace tempolux
