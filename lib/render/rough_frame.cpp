#include "lib/render/rough_frame.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "lib/core/parallel.h"
#include "lib/core/sobol.h"
#include "lib/gather/bright_points.h"
#include "lib/gather/final_gather.h"
#include "lib/gather/irradiance_points.h"
#include "lib/gather/place_records.h"
#include "lib/irradcache/points.h"
#include "lib/render/known_light.h"
#include "lib/render/pilot_photons.h"
#include "lib/render/pixel_noise.h"
#include "lib/render/places_seen.h"
#include "lib/render/see_photons.h"

namespace tempolux {
namespace {

constexpr int kPlaces = 2048, kSamples = 4, kRecords = 64;
constexpr int kColumns = 16, kRows = 9;            ///< of the picture, in whose parts the level of light is known
constexpr std::uint64_t kPaths = 1 << 15;          ///< of light
constexpr std::uint32_t kPoints = 500;   ///< of a side
constexpr int kRays = 62;                          ///< of a rough record
/// Records of a picture over those whose discs of validity would cover it without overlap: weights fall to 0 at a disc's border, and later records
/// narrow earlier ones. Of five scenes: docs/pixels.md.
constexpr double kOverlap = 20;
constexpr double kTell = 7;                        ///< records that tell the light of a pixel, likewise
constexpr double kSure = 3;                        ///< standard errors
constexpr double kMapError2 = 1.0 / PhotonLightOptions{}.caustic_neighbours;   ///< squared error of a density by k photons over its square

/// Light of one sample, mean of channels.
struct Sample {
  double other = 0, caustic = 0, indirect = 0;
  double sum() const { return other + caustic + indirect; }
};
using Samples = std::vector<std::array<Sample, kSamples>>;   ///< by place

Sample sample_of(const Layers& layers) {
  Sample sample;
  for (std::size_t l = 0; l < kLayerCount; ++l) {
    const double value = double(channel_mean(layers.value[l]));
    (Layer(l) == Layer::caustic ? sample.caustic : Layer(l) == Layer::indirect ? sample.indirect : sample.other) += value;
  }
  return sample;
}

struct Where {
  float x = 0, y = 0;   ///< pixel
  std::size_t part = 0;
};

Where where(int i, const CameraView& view, std::uint64_t seed) {
  const Vec2 at = sobol_owen_2d(std::uint32_t(i), seed ^ 0x7061746873ull);
  return {std::floor(at.x * float(view.width())), std::floor(at.y * float(view.height())),
          std::size_t(std::min(kRows - 1, int(at.y * kRows)) * kColumns + std::min(kColumns - 1, int(at.x * kColumns)))};
}

/// Samples of all places, and the work of one in the mean.
Samples take_samples(const RenderScene& scene, const CameraView& view, const KnownLight* known, std::uint64_t seed, RayCounts& counts) {
  Samples samples(kPlaces);
  std::vector<RayCounts> by_place(kPlaces);
  parallel_chunks(kPlaces, 32, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Where at = where(int(i), view, seed);
      for (std::uint32_t s = 0; s < kSamples; ++s) {
        const PixelRandom random(seed ^ 0x70696c6f74ull, i, s);
        const Vec2 in_pixel = random.get2(0, Purpose::pixel);
        samples[i][s] = sample_of(trace_eye_path(scene, view.ray(at.x + in_pixel.x, at.y + in_pixel.y), random, known, by_place[i], view.cone()));
      }
    }
  });
  for (const RayCounts& some : by_place) counts += some;
  return samples;
}

double work_of(const RayCounts& counts) {
  return (Work::kRay * double(counts.camera + counts.bounce) + double(counts.shadow) + double(counts.points_read)) / (kPlaces * kSamples);
}

/// What pixels show in the parts of the picture, and so what errors count there.
struct Levels {
  std::vector<std::size_t> part;   ///< by place
  std::vector<double> allowed;     ///< by part: of pixel error 1
  double picture = 0, white = 0;

  Levels(const Samples& samples, const CameraView& view, std::uint64_t seed) : allowed(kColumns * kRows) {
    std::vector<double> sum(kColumns * kRows, 0.0), count(kColumns * kRows, 0.0);
    for (int i = 0; i < kPlaces; ++i) {
      part.push_back(where(i, view, seed).part);
      for (const Sample& sample : samples[std::size_t(i)]) {
        sum[part.back()] += sample.sum(), ++count[part.back()];
        picture += sample.sum() / (kPlaces * kSamples);
      }
    }
    for (std::size_t p = 0; p < sum.size(); ++p) sum[p] = count[p] > 0 ? sum[p] / count[p] : picture;
    for (std::size_t p = 0; p < sum.size(); ++p) allowed[p] = allowed_error(sum[p], picture, 1);
    std::ranges::nth_element(sum, sum.begin() + std::ptrdiff_t(sum.size() / 2));
    white = std::max(sum[sum.size() / 2], 0.1 * picture) / 0.18;
  }
};

/// By part of the picture the variance of some of the light, over what a pixel may err by, squared. Of samples of which `times` make a pixel.
std::vector<double> variances(const Samples& samples, const Levels& levels, double times, const std::function<double(const Sample&)>& light) {
  std::vector<double> sum(kColumns * kRows, 0.0), count(kColumns * kRows, 0.0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double first = 0, square = 0;
    for (const Sample& sample : samples[i]) {
      const double value = std::min(light(sample), times * levels.white);
      first += value, square += value * value;
    }
    const std::size_t part = levels.part[i];
    if (levels.allowed[part] > 0) sum[part] += sample_variance(kSamples, first, square) / (levels.allowed[part] * levels.allowed[part]);
    ++count[part];
  }
  for (std::size_t part = 0; part < sum.size(); ++part) sum[part] /= std::max(1.0, count[part]);
  return sum;
}

/// Samples go where noise is: n a pixel in the mean, in proportion to the root of each part's variance, leave (mean root)^2 / n.
double adaptive(const std::vector<double>& variances) {
  double roots = 0;
  for (const double variance : variances) roots += std::sqrt(variance) / double(variances.size());
  return roots * roots;
}

SampleEffort effort_of(const Samples& samples, const Levels& levels, double times, double work) {
  const auto of = [&](const std::function<double(const Sample&)>& part) { return adaptive(variances(samples, levels, times, part)); };
  return {work, of([](const Sample& s) { return s.sum(); }), of([](const Sample& s) { return s.other + s.indirect; }),
          of([](const Sample& s) { return s.other + s.caustic; }), of([](const Sample& s) { return s.other; })};
}

/// Samples that the wish asks for, and the error that they leave of all light but layer indirect.
void ask(const Samples& samples, const Levels& levels, double pixel_error, RoughFrame& rough) {
  constexpr double kFirst = 4, kWholeSample = 4;   // of a pixel; shadow rays, as wanted_samples has it
  for (const double variance : variances(samples, levels, kFirst, [](const Sample& s) { return s.other + s.caustic; })) {
    const double wanted = std::max(kFirst, wanted_samples(std::sqrt(variance), kWholeSample, pixel_error));
    rough.samples += wanted / (kColumns * kRows);
    rough.wanted += variance / wanted / (kColumns * kRows);
  }
}

/// The files that a frame would read, made roughly.
class RoughLight {
 public:
  RoughLight(const RenderScene& scene, const Lights& aimed, const RoughOptions& options)
      : photons_(pilot_photons(scene.tracer, aimed, options.kinds, kPaths, options.seed ^ 0x61727269766564ull)) {
    PointOptions placing;
    placing.seed = options.seed;
    placing.count = kPoints;
    placing.seen.assign(options.seen.begin(), options.seen.end());
    placed_ = place_points(scene.frame(), placing);
    estimate_points(scene.tracer, scene.lights, photons_, {}, placing, placed_.points);
    lookup_.emplace(placed_.points, placed_.spacing, point_clearance(scene.tracer));
    lamps_ = note_lamps_beside(scene.tracer, scene.lights, *lookup_);
    if (!lamps_.empty()) bright_.emplace(scene.tracer, scene.lights, *lookup_, std::vector<float>{}, BrightOptions{.seed = options.seed, .beside_lamps = lamps_});
  }
  PhotonView photons() const { return photons_; }
  KnownLight known() const {
    KnownLight known;
    known.points = &*lookup_;
    known.bright = bright_ ? &*bright_ : nullptr;
    known.bright_samples = 1;
    return known;
  }
  /// near_factor: such that as many hits are near as with a map of `photons` paths, whose estimates are narrower.
  GatherOptions gathering(std::uint64_t photons, std::uint64_t seed) const {
    GatherOptions options;
    options.seed = seed;
    options.rays = kRays;
    options.near_factor *= float(std::sqrt(double(kPaths) / double(std::max(kPaths, photons))));
    options.bright = bright_ ? &*bright_ : nullptr;
    return options;
  }
  const PointLookup& lookup() const { return *lookup_; }

 private:
  formats::PhotonBlock photons_;
  PlacedPoints placed_;
  std::optional<PointLookup> lookup_;
  std::vector<LampPhoton> lamps_;
  std::optional<BrightPoints> bright_;
};

/// Two records at each of some places, of random numbers of their own: half of their squared difference is their variance.
void measure_records(const RenderScene& scene, const CameraView& view, const RoughLight& light, const Levels& levels, const RoughOptions& options, RoughFrame& rough) {
  const FinalGather one(scene.tracer, scene.lights, light.lookup(), light.gathering(options.photons, options.seed)),
      two(scene.tracer, scene.lights, light.lookup(), light.gathering(options.photons, ~options.seed));
  std::vector<std::array<double, 2>> found(kRecords);   // records for a pixel, squared error
  std::vector<GatherCounts> counts(kRecords);
  parallel_chunks(kRecords, 1, [&](std::size_t i, std::size_t) {
    const int place = int(i) * (kPlaces / kRecords);
    const Where at = where(place, view, options.seed);
    const Look look{at.x + 0.5f, at.y + 0.5f, {}};
    std::optional<SeenPoint> seen = seen_through(scene.tracer, view, look);
    if (!seen) return;
    const PlacementOptions placement;
    std::array<IrradianceRecord, 2> records{one.gather(seen->surface, seen->normal, counts[i]), two.gather(seen->surface, seen->normal, counts[i])};
    const SurfaceMaterial material(scene.frame(), seen->surface, seen->footprint);
    const Rgb reflected = Bsdf(material, dot(seen->surface.normal_geometric, seen->normal) > 0).diffuse_albedo() * kInvPi;
    const double difference = double(channel_mean(reflected * records[0].irradiance)) - double(channel_mean(reflected * records[1].irradiance));
    const double allowed = levels.allowed[at.part];
    if (allowed > 0) found[i][1] = difference * difference / 2 / (allowed * allowed);
    for (IrradianceRecord& record : records) {
      limit_radius(record, seen->footprint, placement);
      const double radius = double(record.radius) / double(seen->footprint);
      found[i][0] += 0.5 * kOverlap / (double(kPi) * radius * radius);
    }
  });
  GatherCounts all;
  double gathered = 0;
  for (std::size_t i = 0; i < kRecords; ++i) {
    rough.records += found[i][0] / kRecords * view.width() * view.height();
    rough.record_error += found[i][1] / kRecords * kRays / kTell;
    gathered += found[i][0] > 0 ? 2 : 0;
    all += counts[i];
  }
  if (gathered > 0) rough.record_ray = (Work::kGatherRay * double(all.rays) + double(all.shadow_rays)) / (gathered * kRays);
}

/// What paths surely miss of the light that photons show. n paths that miss light of radiance c have the variance n c^2 at least (docs/methods/caustics.md).
void compare(const SeenPhotons& photons, double found, double allowed2, double& square, double& variance) {
  const double missed = photons.mean - found, sure = missed > 0 ? std::max(0.0, missed * missed - kSure * kSure * photons.mean_error * photons.mean_error) : 0;
  if (!(sure > 0) || !(photons.mean > 0)) return;
  variance = kPlaces * kSamples * sure / allowed2;
  square = photons.square * sure / (photons.mean * photons.mean) / allowed2;
}

}  // namespace

RoughFrame rough_frame(const RenderScene& scene, const Lights& aimed, const CameraView& view, const RoughOptions& options) {
  RoughFrame rough;
  RayCounts counts;
  const Samples paths = take_samples(scene, view, nullptr, options.seed, counts);
  const Levels levels(paths, view, options.seed);
  const SeenPlaces seen = places_seen(scene, view, kPlaces, options.seed ^ 0x70696c6f74ull);
  int open = 0;
  for (const SeenPlace& place : seen.places) rough.places += place.exists(), open += place.exists() && place.open;
  rough.open_share = rough.places > 0 ? double(open) / rough.places : 0;
  double caustic = 0, indirect = 0;
  for (const auto& some : paths)
    for (const Sample& sample : some) caustic += sample.caustic / (kPlaces * kSamples), indirect += sample.indirect / (kPlaces * kSamples);
  rough.radiance = levels.picture;
  ask(paths, levels, options.pixel_error, rough);
  rough.path = effort_of(paths, levels, rough.samples, work_of(counts));
  if (rough.places == 0) return rough;

  const RoughLight light(scene, aimed, options);
  rough.photons_per_path = double(light.photons().photons.size()) / kPaths;
  const KnownLight known = light.known();
  counts = {};
  const Samples gathered = take_samples(scene, view, &known, options.seed, counts);
  rough.gather = effort_of(gathered, levels, rough.samples, work_of(counts));
  // Where a record is a ray still goes on from the Lambert lobe: it joins light sampling. It ends at the first thing that it meets.
  rough.record_sample = rough.gather.work + (Work::kRay * double(counts.gathered) - double(counts.onward) + Work::kRecordLookUp * double(counts.gathered)) / (kPlaces * kSamples);
  measure_records(scene, view, light, levels, options, rough);
  const double allowed2 = levels.picture * levels.picture;
  const SeenPhotons caustics = see_photons(scene, view, light.photons(), formats::PathKind::caustic), others = see_photons(scene, view, light.photons(), formats::PathKind::indirect);
  if (allowed2 > 0) {
    compare(caustics, caustic, allowed2, rough.missed_caustic_square, rough.missed_caustic_variance);
    compare(others, indirect, allowed2, rough.missed_square, rough.missed_variance);
    rough.map_error = kMapError2 * caustics.square / allowed2;
  }
  return rough;
}

}  // namespace tempolux
