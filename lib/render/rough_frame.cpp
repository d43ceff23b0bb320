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
constexpr int kColumns = 16, kRows = 9;    ///< of the picture, in whose parts the level of light is known
constexpr std::uint64_t kPaths = 1 << 15;  ///< of light
constexpr std::uint32_t kPoints = 500;     ///< of a side
constexpr int kRays = 62;                  ///< of a rough record
/// Records of a picture over those whose discs of validity would cover it without overlap: weights fall to 0 at a
/// disc's border. Of five scenes: docs/pixels.md.
constexpr double kOverlap = 20;
constexpr double kTell = 7;  ///< records that tell the light of a pixel, likewise
constexpr double kSure = 3;  ///< standard errors
constexpr double kMapError2 =
    1.0 / PhotonLightOptions{}.caustic_neighbours;  ///< squared error of a density by k photons over its square

/// Light of one sample, mean of channels.
struct Sample {
  double other = 0, caustic = 0, indirect = 0;
  double sum() const { return other + caustic + indirect; }
};
using Samples = std::vector<std::array<Sample, kSamples>>;  ///< by place

Sample sample_of(const Layers& layers) {
  Sample sample;
  for (std::size_t l = 0; l < kLayerCount; ++l) {
    const double value = double(channel_mean(layers.value[l]));
    (Layer(l) == Layer::caustic    ? sample.caustic
     : Layer(l) == Layer::indirect ? sample.indirect
                                   : sample.other) += value;
  }
  return sample;
}

struct Where {
  float x = 0, y = 0;  ///< pixel
  std::size_t part = 0;
};

Where where(int i, const CameraView& view, std::uint64_t seed) {
  const Vec2 at = sobol_owen_2d(std::uint32_t(i), seed ^ 0x7061746873ull);
  return {
      std::floor(at.x * float(view.width())), std::floor(at.y * float(view.height())),
      std::size_t(std::min(kRows - 1, int(at.y * kRows)) * kColumns + std::min(kColumns - 1, int(at.x * kColumns)))};
}

/// Samples of all places, and the work of one in the mean.
Samples take_samples(const RenderScene& scene, const CameraView& view, const KnownLight* known, std::uint64_t seed,
                     RayCounts& counts) {
  Samples samples(kPlaces);
  std::vector<RayCounts> by_place(kPlaces);
  parallel_chunks(kPlaces, 32, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Where at = where(int(i), view, seed);
      for (std::uint32_t s = 0; s < kSamples; ++s) {
        const PixelRandom random(seed ^ 0x70696c6f74ull, i, s);
        const Vec2 in_pixel = random.get2(0, Purpose::pixel);
        const Ray ray = view.ray(at.x + in_pixel.x, at.y + in_pixel.y);
        samples[i][s] = sample_of(trace_eye_path(scene, ray, random, known, by_place[i], view.cone()));
      }
    }
  });
  for (const RayCounts& some : by_place) counts += some;
  return samples;
}

double work_of(const RayCounts& counts) {
  return (Work::kRay * double(counts.camera + counts.bounce) + double(counts.shadow) + double(counts.points_read)) /
         (kPlaces * kSamples);
}

/// What pixels show in the parts of the picture, and so what errors count there.
struct Levels {
  std::vector<std::size_t> part;  ///< by place
  std::vector<double> allowed;    ///< by part: of pixel error 1
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

using PartOfLight = std::function<double(const Sample&)>;

/// By part of the picture the variance of some of the light, over what a pixel may err by, squared. Of samples of which
/// `times` make a pixel.
std::vector<double> variances(const Samples& samples, const Levels& levels, double times, const PartOfLight& light) {
  std::vector<double> sum(kColumns * kRows, 0.0), count(kColumns * kRows, 0.0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double first = 0, square = 0;
    for (const Sample& sample : samples[i]) {
      const double value = std::min(light(sample), times * levels.white);
      first += value, square += value * value;
    }
    const std::size_t part = levels.part[i];
    if (levels.allowed[part] > 0)
      sum[part] += sample_variance(kSamples, first, square) / (levels.allowed[part] * levels.allowed[part]);
    ++count[part];
  }
  for (std::size_t part = 0; part < sum.size(); ++part) sum[part] /= std::max(1.0, count[part]);
  return sum;
}

/// Samples go where noise is: n a pixel in the mean, in proportion to the root of each part's variance, leave (mean
/// root)^2 / n.
double adaptive(const std::vector<double>& variances) {
  double roots = 0;
  for (const double variance : variances) roots += std::sqrt(variance) / double(variances.size());
  return roots * roots;
}

SampleEffort effort_of(const Samples& samples, const Levels& levels, double times, double work) {
  const auto of = [&](const PartOfLight& part) { return adaptive(variances(samples, levels, times, part)); };
  return {work, of([](const Sample& s) { return s.sum(); }), of([](const Sample& s) { return s.other + s.indirect; }),
          of([](const Sample& s) { return s.other + s.caustic; }), of([](const Sample& s) { return s.other; })};
}

/// Samples that the wish asks for, and the error that they leave of all light but layer indirect.
void ask(const Samples& samples, const Levels& levels, double pixel_error, RoughFrame& rough) {
  constexpr double kFirst = 4, kWholeSample = 4;  // of a pixel; shadow rays, as wanted_samples has it
  for (const double variance :
       variances(samples, levels, kFirst, [](const Sample& s) { return s.other + s.caustic; })) {
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
    const BrightOptions bright{.seed = options.seed, .beside_lamps = lamps_};
    if (!lamps_.empty()) bright_.emplace(scene.tracer, scene.lights, *lookup_, std::vector<float>{}, bright);
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

/// What is looked at.
struct Picture {
  const RenderScene& scene;
  const CameraView& view;
  const RoughOptions& options;
  const Levels levels;
};

/// Two records at one place.
struct Pair {
  double for_a_pixel = 0;  ///< records
  double error2 = 0;       ///< squared error of one
  GatherCounts counts;
};

/// The two have random numbers of their own: half of their squared difference is the variance of one.
Pair gather_pair(const Picture& picture, const std::array<FinalGather, 2>& gathers, int place) {
  Pair pair;
  const Where at = where(place, picture.view, picture.options.seed);
  std::optional<SeenPoint> seen = seen_through(picture.scene.tracer, picture.view, {at.x + 0.5f, at.y + 0.5f, {}});
  if (!seen) return pair;
  const SurfaceMaterial material(picture.scene.frame(), seen->surface, seen->footprint);
  const Rgb reflected = Bsdf(material, dot(seen->surface.normal_geometric, seen->normal) > 0).diffuse_albedo() * kInvPi;
  double difference = 0;
  for (const FinalGather& gather : gathers) {
    IrradianceRecord record = gather.gather(seen->surface, seen->normal, pair.counts);
    difference = double(channel_mean(reflected * record.irradiance)) - difference;
    limit_radius(record, seen->footprint, {});
    const double radius = double(record.radius) / double(seen->footprint);
    pair.for_a_pixel += 0.5 * kOverlap / (double(kPi) * radius * radius);
  }
  const double allowed = picture.levels.allowed[at.part];
  if (allowed > 0) pair.error2 = difference * difference / 2 / (allowed * allowed);
  return pair;
}

void measure_records(const Picture& picture, const RoughLight& light, RoughFrame& rough) {
  const auto gather = [&](std::uint64_t seed) {
    return FinalGather(picture.scene.tracer, picture.scene.lights, light.lookup(),
                       light.gathering(picture.options.photons, seed));
  };
  const std::array<FinalGather, 2> gathers{gather(picture.options.seed), gather(~picture.options.seed)};
  std::vector<Pair> pairs(kRecords);
  constexpr int kApart = kPlaces / kRecords;
  parallel_chunks(kRecords, 1,
                  [&](std::size_t i, std::size_t) { pairs[i] = gather_pair(picture, gathers, int(i) * kApart); });
  GatherCounts all;
  double gathered = 0;
  for (const Pair& pair : pairs) {
    rough.records += pair.for_a_pixel / kRecords * picture.view.width() * picture.view.height();
    rough.record_error += pair.error2 / kRecords * kRays / kTell;
    gathered += pair.for_a_pixel > 0 ? 2 : 0;
    all += pair.counts;
  }
  if (gathered > 0)
    rough.record_ray = (Work::kGatherRay * double(all.rays) + double(all.shadow_rays)) / (gathered * kRays);
}

/// What paths surely miss of the light that photons show. n paths that miss light of radiance c have the variance n c^2
/// at least (docs/methods/caustics.md).
MissedLight missed_light(const SeenPhotons& photons, double found, double allowed2) {
  const double missed = std::max(0.0, photons.mean - found), error = kSure * photons.mean_error;
  const double sure = std::max(0.0, missed * missed - error * error);
  if (!(sure > 0)) return {};
  return {photons.square * sure / (photons.mean * photons.mean) / allowed2, kPlaces * kSamples * sure / allowed2};
}

/// Places that are seen, and how many of their rays leave the scene.
void look_at_places(const RenderScene& scene, const CameraView& view, std::uint64_t seed, RoughFrame& rough) {
  int open = 0;
  for (const SeenPlace& place : places_seen(scene, view, kPlaces, seed ^ 0x70696c6f74ull).places) {
    rough.places += place.exists();
    open += place.exists() && place.open;
  }
  rough.open_share = rough.places > 0 ? double(open) / rough.places : 0;
}

double mean_of(const Samples& samples, const PartOfLight& light) {
  double sum = 0;
  for (const auto& some : samples)
    for (const Sample& sample : some) sum += light(sample);
  return sum / (kPlaces * kSamples);
}

/// By photons: what paths miss, and what a map of caustics would err by.
void compare(const Picture& picture, const RoughLight& light, const Samples& paths, RoughFrame& rough) {
  const double allowed2 = picture.levels.picture * picture.levels.picture;
  if (!(allowed2 > 0)) return;
  const auto seen = [&](formats::PathKind kind) {
    return see_photons(picture.scene, picture.view, light.photons(), kind);
  };
  const SeenPhotons caustics = seen(formats::PathKind::caustic);
  rough.missed_caustic = missed_light(caustics, mean_of(paths, [](const Sample& s) { return s.caustic; }), allowed2);
  rough.missed = missed_light(seen(formats::PathKind::indirect),
                              mean_of(paths, [](const Sample& s) { return s.indirect; }), allowed2);
  rough.map_error = kMapError2 * caustics.square / allowed2;
}

}  // namespace

RoughFrame rough_frame(const RenderScene& scene, const Lights& aimed, const CameraView& view,
                       const RoughOptions& options) {
  RoughFrame rough;
  look_at_places(scene, view, options.seed, rough);
  RayCounts counts;
  const Samples paths = take_samples(scene, view, nullptr, options.seed, counts);
  const Picture picture{scene, view, options, Levels(paths, view, options.seed)};
  rough.radiance = picture.levels.picture;
  ask(paths, picture.levels, options.pixel_error, rough);
  rough.path = effort_of(paths, picture.levels, rough.samples, work_of(counts));
  if (rough.places == 0) return rough;

  const RoughLight light(scene, aimed, options);
  rough.photons_per_path = double(light.photons().photons.size()) / kPaths;
  const KnownLight known = light.known();
  counts = {};
  const Samples gathered = take_samples(scene, view, &known, options.seed, counts);
  rough.gather = effort_of(gathered, picture.levels, rough.samples, work_of(counts));
  // Where a record is a ray still goes on from the Lambert lobe: it joins light sampling. It ends at the first thing
  // that it meets.
  const double at_records = (Work::kRay + Work::kRecordLookUp) * double(counts.gathered) - double(counts.onward);
  rough.record_sample = rough.gather.work + at_records / (kPlaces * kSamples);
  measure_records(picture, light, rough);
  compare(picture, light, paths, rough);
  return rough;
}

}  // namespace tempolux
