#include "lib/compose/compose.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "formats/octahedral.h"
#include "lib/core/arrays.h"
#include "lib/core/parallel.h"
#include "lib/core/sampling.h"
#include "lib/transport/media.h"
#include "lib/volume/phase.h"

namespace tempolux {
namespace {

constexpr std::size_t kChunk = 256;  ///< pixels
constexpr float kMostSlices = 4096;  ///< in a piece of a ray
/// Largest weight extinction / linear extinction of a sampled place. The linear extinction of a slice can be almost 0
/// at one end.
constexpr float kMostAbove = 8;
/// Slices behind this transmittance are left out: their light adds nothing to a float. Also prevents a division by 0.
constexpr float kLeastTransmittance = 1e-30f;

/// A piece of a ray in which extinction counts as linear.
struct Slice {
  float begin, length;  ///< m
  float tau;
  float transmittance;  ///< between the slice's start and the eye
  float slope;          ///< extinction at its end minus extinction at its start, 1/m
  float extinction(float t) const { return tau / length + slope * (t - 0.5f); }
  /// The place t in the slice, from 0 to 1, at which the optical depth from its start is `depth`. Solves
  /// depth = length (extinction(0) t + slope t^2 / 2).
  float place_of(float depth) const {
    const float first = std::max(0.0f, extinction(0)), wanted = depth / length;
    const float root = first + std::sqrt(std::max(0.0f, first * first + 2 * slope * wanted));
    return root > 0 ? std::min(1.0f, 2 * wanted / root) : 1;
  }
};

double finest_voxel(const Media& media) {
  double finest = INFINITY;
  for (const Medium& medium : media.all()) finest = std::min(finest, medium.voxel_size());
  return finest;
}

/// (1 - exp(-x)) / x.
float mean_transmittance(float x) { return x < 1e-4f ? 1 - x / 2 : -std::expm1(-x) / x; }

/// Cuts the parts of the ray with a majorant above 0 into slices. The optical depth of a slice is computed by
/// Gauss-Legendre quadrature with two points.
void cut(const Media& media, const Ray& ray, float end, float step, std::vector<Slice>& slices) {
  slices.clear();
  constexpr float kGauss = 0.21132487f;
  MajorantWalk walk(media.majorants(), ray.origin, ray.direction, end);
  double tau = 0;
  float from = 0, to = 0;
  const auto cut_piece = [&] {
    const float size = to - from;
    const int n = int(std::clamp(std::ceil(size / step), 1.0f, kMostSlices));
    const float each = size / float(n);
    for (int i = 0; i < n && size > 0; ++i) {
      const float begin = from + float(i) * each;
      const float a = media.extinction(ray.origin + ray.direction * (begin + kGauss * each));
      const float b = media.extinction(ray.origin + ray.direction * (begin + (1 - kGauss) * each));
      const float depth = 0.5f * each * (a + b);
      const auto transmittance = float(std::exp(-tau));
      if (transmittance < kLeastTransmittance) return;
      if (depth > 0) slices.push_back({begin, each, depth, transmittance, (b - a) / (1 - 2 * kGauss)});
      tau += double(depth);
    }
  };
  for (MajorantWalk::Piece piece; walk.next(piece);) {
    if (!(piece.majorant > 0)) continue;
    if (piece.begin != to) {
      cut_piece();
      from = piece.begin;
    }
    to = piece.end;
  }
  cut_piece();
}

/// A ray from a place in the medium, in a direction drawn from the phase function.
struct ScatteredRay {
  Ray ray;
  std::uint64_t key;
  Rgb weight;  ///< factor of the radiance along the ray
};

/// Follows the camera rays of one pixel after another through the media of a frame.
struct Marcher {
  const RenderScene& scene;
  const Media& media;
  const MediaLight& light;
  const ComposeOptions& options;
  float step;  ///< m: longest slice
  RayCounts counts{};
  std::vector<Slice> slices{};            ///< of the ray
  std::vector<ScatteredRay> scattered{};  ///< rays whose radiance the pixel still needs

  SmokePixel march(const Ray& ray, float end, const PixelRandom& random);

 private:
  void add_ray(const MediumPoint& point, std::uint32_t bounce, float weight, const PixelRandom& random);
  Rgb sampled_light(const Ray& ray, float whole, const PixelRandom& random);
};

/// Adds a ray from a place in the medium, if rays estimate a share of its light.
void Marcher::add_ray(const MediumPoint& point, std::uint32_t bounce, float weight, const PixelRandom& random) {
  const PhaseShare& share = light.share(point.g);
  if (!share.has_rays()) return;
  const Vec3 travel = sample_hg(point.g, point.travel, random.get2(bounce, Purpose::phase));
  const float q = 4 * kPi * pdf_hg(point.g, point.travel, travel);
  scattered.push_back({{point.position, travel, 0, INFINITY},
                       random.hashed().bits(bounce, Purpose::gather),
                       point.albedo * (weight * share.of_rays(q))});
}

/// Radiance that comes directly from lights and that the medium scatters towards the eye. Places on the ray are drawn
/// in proportion to linear extinction x transmittance. The weight of a place is the medium's extinction divided by the
/// linear extinction of its slice. `whole`: 1 - transmittance of all slices.
Rgb Marcher::sampled_light(const Ray& ray, float whole, const PixelRandom& random) {
  const int samples = options.light_samples;
  const std::size_t before = scattered.size();
  Rgb sum{0.0f};
  std::size_t at = 0;
  float passed = 0;  // sum over the slices before slice `at`
  for (int k = 0; k < samples; ++k) {
    const float wanted = (float(k) + random.get1(0, Purpose::place)) / float(samples) * whole;
    // Samples ascend along the ray. The last slice takes the remainder that rounding leaves.
    while (at + 1 < slices.size() && passed + slices[at].transmittance * -std::expm1(-slices[at].tau) <= wanted) {
      passed += slices[at].transmittance * -std::expm1(-slices[at].tau);
      ++at;
    }
    const Slice& slice = slices[at];
    const float share = std::clamp((wanted - passed) / slice.transmittance, 0.0f, -std::expm1(-slice.tau));
    const float within = slice.place_of(-std::log1p(-share));
    const Vec3 position = ray.origin + ray.direction * (slice.begin + within * slice.length);
    const float linear = slice.extinction(within),
                weight = linear > 0 ? std::min(kMostAbove, media.extinction(position) / linear) : 0;
    const auto bounce = std::uint32_t(k);
    const MediumOptions& medium = media.collided(position, random.hashed().get1(bounce, Purpose::medium)).options();
    const MediumPoint point{position, ray.direction, medium.albedo, medium.g};
    sum += medium.albedo * weight *
           scattered_lamp_light(
               scene.tracer, scene.lights, point,
               {random.get2(bounce, Purpose::light_point), false, {random.hashed(), bounce, way_shadow_of_medium}},
               counts.shadow);
    add_ray(point, bounce, weight, random);
  }
  for (std::size_t i = before; i < scattered.size(); ++i) scattered[i].weight *= whole / float(samples);
  return sum * (whole / float(samples));
}

SmokePixel Marcher::march(const Ray& ray, float end, const PixelRandom& random) {
  SmokePixel pixel;
  cut(media, ray, end, step, slices);
  if (slices.empty()) return pixel;
  double tau = 0;
  for (const Slice& slice : slices) {
    const Vec3 middle = ray.origin + ray.direction * (slice.begin + 0.5f * slice.length);
    pixel.light += light.scattered(middle) * (slice.transmittance * slice.length * mean_transmittance(slice.tau));
    tau += double(slice.tau);
  }
  pixel.transmittance = float(std::exp(-tau));
  const auto whole = float(-std::expm1(-tau));  // In float32 1 - transmittance has only two digits if tau is 1e-6.
  if (options.sample_lights && whole > 0) pixel.light += sampled_light(ray, whole, random);
  return pixel;
}

/// Weighted sum of the radiance that arrives along the rays.
Rgb radiance_of(const IncomingRadiance& incoming, const std::vector<ScatteredRay>& scattered, RayCounts& counts) {
  thread_local std::vector<Ray> rays;
  thread_local std::vector<std::uint64_t> keys;
  thread_local std::vector<Rgb> radiance;
  thread_local std::vector<float> distance;
  rays.clear();
  keys.clear();
  for (const ScatteredRay& each : scattered) rays.push_back(each.ray), keys.push_back(each.key);
  radiance.resize(rays.size());
  distance.resize(rays.size());
  GatherCounts gathered;
  incoming(rays, keys, radiance, distance, gathered, {}, IncomingRadiance::Start::medium);
  counts.bounce += gathered.rays;
  counts.shadow += gathered.shadow_rays;
  counts.points_read += gathered.points_read;
  Rgb sum{0.0f};
  for (std::size_t i = 0; i < scattered.size(); ++i) sum += scattered[i].weight * radiance[i];
  return sum;
}

}  // namespace

MediaLight::MediaLight(const Media& media, const MajorantGrid& majorants, Vec3 eye, double emitted_flux,
                       const Options& options)
    : media_(media), eye_(eye), options_(options) {
  if (!(options_.cell > 0)) options_.cell = finest_voxel(media);
  for (const Medium& medium : media.all()) {
    const float g = medium.options().g;
    const auto found = std::find(gs_.begin(), gs_.end(), g);
    g_of_.push_back(std::size_t(found - gs_.begin()));
    if (found == gs_.end()) {
      gs_.push_back(g);
      shares_.emplace_back(g, options.rays);
    }
  }
  sums_.assign(gs_.size(), FluenceSums(majorants, options_.cell, emitted_flux));
}

void MediaLight::add(const formats::PhotonBlock& block, Vec3 offset, int times) {
  for (std::size_t i = 0; i < block.photons.size(); ++i) {
    const formats::Photon& photon = block.photons[i];
    if (photon.kind != formats::PathKind::tentative || (photon.bounce == 0 && !options_.direct)) continue;
    const Vec3 position = vec_of(photon.position) + offset;
    const Rgb contribution = rgb_of(photon.flux);
    for (std::size_t g = 0; g < gs_.size(); ++g) {
      float factor = 1;
      if (gs_[g] != 0 && !block.directions.empty()) {
        const Vec3 travel = -vec_of(formats::decode_normal(block.directions[i]));
        factor = 4 * kPi * pdf_hg(gs_[g], travel, normalize(eye_ - position));
        factor *= shares_[g].of_photons(factor);
      }
      sums_[g].add(position, contribution * factor, times);
    }
  }
}

const PhaseShare& MediaLight::share(float g) const {
  return shares_[std::size_t(std::find(gs_.begin(), gs_.end(), g) - gs_.begin())];
}

bool MediaLight::has_rays() const {
  return std::any_of(shares_.begin(), shares_.end(), [](const PhaseShare& share) { return share.has_rays(); });
}

void MediaLight::finish() {
  volumes_.clear();
  for (const FluenceSums& sums : sums_) volumes_.emplace_back(sums, options_.filter_width);
}

Rgb MediaLight::scattered(Vec3 point) const {
  Rgb sum{0.0f};
  const std::span<const Medium> media = media_.all();
  for (std::size_t m = 0; m < media.size(); ++m) {
    const float extinction = media[m].extinction(point);
    if (extinction > 0) sum += media[m].options().albedo * volumes_[g_of_[m]].at(point) * (extinction / (4 * kPi));
  }
  return sum;
}

Vec3 eye_for_phase(const CameraView& view, const Box3& bounds) {
  if (!view.orthographic()) return view.eye();
  const Ray middle = view.pinhole({0.5f * float(view.width()), 0.5f * float(view.height())});
  return middle.origin - middle.direction * (1e4f * std::max(1.0f, bounds.diagonal()));
}

std::vector<SmokePixel> compose_media(const RenderScene& scene, const CameraView& view, const MediaLight& light,
                                      const std::vector<float>& depth, const ComposeOptions& options,
                                      RayCounts& counts) {
  std::vector<SmokePixel> pixels(std::size_t(view.width()) * std::size_t(view.height()));
  const Media* const media = scene.frame().media.get();
  if (!media) return pixels;
  if (light.has_rays() && !(options.incoming && options.sample_lights))
    throw std::invalid_argument("compose_media: rays estimate a part of the light, but options.incoming is missing");
  const auto step = float(finest_voxel(*media) / 2);
  std::mutex joining;
  std::size_t done = 0;
  parallel_chunks(pixels.size(), kChunk, [&](std::size_t first, std::size_t last) {
    Marcher marcher{scene, *media, light, options, step};
    for (std::size_t p = first; p < last; ++p) {
      const auto x = int(p % std::size_t(view.width())), y = int(p / std::size_t(view.width()));
      SmokePixel sum{Rgb(0.0f), 0};
      marcher.scattered.clear();
      for (int s = 0; s < options.samples; ++s) {
        const PixelRandom random(options.seed, p, std::uint32_t(s));
        const Ray ray = options.surfaces_by_depth ? view.middle(x, y) : view.ray(sample_of_pixel(view, x, y, random));
        float end = INFINITY;
        if (options.surfaces_by_depth) {
          // Converts distance along the ray to Z, which runs along the view axis.
          const double along = view.depth(ray.origin + ray.direction) - view.depth(ray.origin);
          end = float(double(depth[p]) / along);
        } else {
          Hit hit;
          if (scene.tracer.intersect(ray, hit)) end = hit.t;
          ++marcher.counts.camera;
        }
        const SmokePixel one = marcher.march(ray, end, random);
        sum.light += one.light;
        sum.transmittance += one.transmittance;
      }
      if (!marcher.scattered.empty()) sum.light += radiance_of(*options.incoming, marcher.scattered, marcher.counts);
      pixels[p] = {sum.light * (1 / float(options.samples)), sum.transmittance / float(options.samples)};
    }
    const std::scoped_lock lock(joining);
    counts += marcher.counts;
    if (options.progress) options.progress(double(done += last - first) / double(pixels.size()));
  });
  return pixels;
}

}  // namespace tempolux
