#include "lib/material/diffuse_transmission.h"
#include "lib/pilot/rough_frame.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "lib/core/parallel_each.h"
#include "lib/core/sobol.h"
#include "lib/core/statistics.h"
#include "lib/gather/bright_points.h"
#include "lib/gather/final_gather.h"
#include "lib/points/irradiance_points.h"
#include "lib/gather/place_records.h"
#include "lib/image/srgb.h"
#include "lib/irradcache/points.h"
#include "lib/audit/audit.h"
#include "lib/pilot/hidden_light.h"
#include "lib/render/known_light.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/render/pixel_noise.h"
#include "lib/pilot/places_seen.h"
#include "lib/pilot/rough_light.h"
#include "lib/pilot/see_photons.h"

namespace tempolux {
namespace {

constexpr int kSamples = 4;          ///< samples of a place, as many as the first samples of a pixel (FrameOptions)
constexpr double kFirst = kSamples;  ///< fewest samples of a pixel of a frame
constexpr int kRecords = 64;         ///< places with two records each: the variance errs by sqrt(2 / 64) = 18 %
/// Largest number of pixels at which the need for records is tested. The test then takes a tenth of a second. In a
/// picture with more pixels the tested pixels form a lattice.
constexpr double kLooks = 320 * 180;

/// Radiance of one sample [W/m^2/sr], mean of the channels, by layer. `other`: all layers but caustic and indirect.
struct Sample {
  double other = 0, caustic = 0, indirect = 0;
  double seen = 0;  ///< the part of `other` in the layers emission and specular
  double sum() const { return other + caustic + indirect; }
};
using Samples = std::vector<std::array<Sample, kSamples>>;  ///< by place
using PartOfLight = std::function<double(const Sample&)>;

Sample sample_of(const Layers& layers) {
  Sample sample;
  for (std::size_t l = 0; l < kLayerCount; ++l) {
    const double value = double(channel_mean(layers.value[l]));
    (Layer(l) == Layer::caustic    ? sample.caustic
     : Layer(l) == Layer::indirect ? sample.indirect
                                   : sample.other) += value;
    if (Layer(l) == Layer::emission || Layer(l) == Layer::specular) sample.seen += value;
  }
  return sample;
}

/// A measured place of the picture.
struct Where {
  int x = 0, y = 0;      ///< pixel
  std::size_t part = 0;  ///< pilot_part
};

Where where(int i, const CameraView& view, std::uint64_t seed) {
  const Vec2 at = sobol_owen_2d(std::uint32_t(i), seed ^ 0x7061746873ull);
  return {int(at.x * float(view.width())), int(at.y * float(view.height())), pilot_part(double(at.x), double(at.y))};
}

/// Takes kSamples samples at each of options.places places. Adds their rays to `counts`.
Samples samples_of(const RenderScene& scene, const CameraView& view, const KnownLight* known,
                   const RoughOptions& options, RayCounts& counts) {
  const std::uint64_t seed = options.seed;
  Samples samples(std::size_t(options.places));
  counts += parallel_sum<RayCounts>(samples.size(), 32, [&](std::size_t i, RayCounts& rays) {
    const Where at = where(int(i), view, seed);
    for (std::uint32_t s = 0; s < kSamples; ++s) {
      const PixelRandom random(seed ^ 0x70696c6f74ull, i, s);
      const Ray ray = view.ray(sample_of_pixel(view, at.x, at.y, random));
      samples[i][s] = sample_of(trace_eye_path(scene, ray, random, known, rays, view.cone()));
    }
  });
  return samples;
}

/// Work of one sample, in shadow rays.
double work_of(const RayCounts& counts, const Samples& samples) {
  return (Work::kRay * double(counts.camera + counts.bounce + counts.points_read) + double(counts.shadow)) /
         (kSamples * double(samples.size()));
}

double mean_of(const Samples& samples, const PartOfLight& light) {
  double sum = 0;
  for (const auto& some : samples)
    for (const Sample& sample : some) sum += light(sample);
  return sum / (kSamples * double(samples.size()));
}

/// Mean radiances [W/m^2/sr] of the picture and the allowed errors that follow from them.
struct Levels {
  std::vector<std::size_t> part;  ///< part of each place
  /// Mean of the picture. Radiance of the layers emission and specular counts at most as much as white, because a flame
  /// in a lantern is a thousand times as bright as the walls that it lights. Direct light does so, too, because a bulb
  /// close to a wall makes a very bright spot. The other light is at least what photons show, because paths may find
  /// none of it.
  double picture = 0;
  double white = 0;             ///< radiance that the exposure of the median part shows as white
  std::vector<double> allowed;  ///< by part: the allowed error at pixel error 1

  Levels(const Samples& samples, const SeenLight& photons, const CameraView& view, std::uint64_t seed)
      : allowed(kPilotParts) {
    std::vector<double> sum(kPilotParts, 0.0), count(kPilotParts, 0.0);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      part.push_back(where(int(i), view, seed).part);
      for (const Sample& sample : samples[i]) sum[part.back()] += sample.sum(), ++count[part.back()];
    }
    const double mean = mean_of(samples, [](const Sample& s) { return s.sum(); });
    for (std::size_t p = 0; p < sum.size(); ++p) sum[p] = count[p] > 0 ? sum[p] / count[p] : mean;
    std::vector<double> sorted = sum;
    const double shown = photons.caustic.mean + photons.indirect.mean,
                 found = mean_of(samples, [](const Sample&s) { return s.caustic + s.indirect; }),
                 lit = 1 / exposure_of(sum),
                 others = mean_of(samples, [lit](const Sample&s) { return std::min(s.other - s.seen, lit); });
    const double least = std::max(shown, found) + others;
    white = std::max(upper_median(sorted), 0.1 * (least > 0 ? least : mean)) / 0.18;
    // Light behind mirrors and glass is in `shown` of photons and in `seen` of paths. It must count once.
    const double seen = mean_of(samples, [&](const Sample& s) { return std::min(s.seen, white); });
    picture = std::max(shown, found + seen) + others;
    for (std::size_t p = 0; p < sum.size(); ++p) allowed[p] = allowed_error(sum[p], picture, 1);
  }
};

/// For each part of the picture, the variance of one sample of this light over the square of the allowed error. The
/// value of a sample is cut where it alone makes a pixel of `times` samples white.
std::vector<double> variances(const Samples& samples, const Levels& levels, double times, const PartOfLight& light) {
  std::vector<double> sum(kPilotParts, 0.0), count(kPilotParts, 0.0);
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

/// Variance of one sample of the whole picture. A frame takes samples in proportion to the root of each part's
/// variance, so a mean of n samples per pixel leaves (mean root)^2 / n.
double adaptive(const std::vector<double>& variances) {
  double roots = 0;
  for (const double variance : variances) roots += std::sqrt(variance) / double(variances.size());
  return roots * roots;
}

/// Variance of one sample by part of the picture, as variances() has it, of light that paths find as lone samples
/// (lone_light): E x^2 of samples that are cut at the value c is c times their mean. Few of the pilot's samples meet
/// such light, so their own variance says little. Empty if paths find no caustic light, or if all lights have an
/// extent.
std::vector<double> lone_variances(const RenderScene& scene, const Lights& aimed, const CameraView& view,
                                   const RoughOptions& options, const SeenPhotons& caustics, const Levels& levels,
                                   double times) {
  if (!(caustics.mean > 0) || scene.frame().lights.empty()) return {};
  const double cut = times * levels.white;
  // The rough frame's own photons have no directions: with directions their flux has another meaning (PhotonView).
  const formats::PhotonBlock photons =
      pilot_photons(scene.tracer, aimed, "caustic", kPilotPaths, options.seed ^ 0x6c6f6e65ull, true);
  std::vector<double> lone = lone_light(scene, view, photons, cut);
  for (std::size_t part = 0; part < lone.size(); ++part) {
    const double allowed = levels.allowed[part];
    lone[part] = allowed > 0 ? lone[part] * cut / (allowed * allowed) : 0;
  }
  return lone;
}

/// lone: lone_variances().
SampleEffort effort_of(const Samples& samples, const Levels& levels, double times, double work,
                       const std::vector<double>& lone) {
  const auto of = [&](const PartOfLight& part) { return variances(samples, levels, times, part); };
  // At least the variance of the other light and of the lone samples.
  const auto with_lone = [&](std::vector<double> found, const std::vector<double>& without_caustic) {
    for (std::size_t i = 0; i < lone.size(); ++i) found[i] = std::max(found[i], without_caustic[i] + lone[i]);
    return adaptive(found);
  };
  const std::vector<double> without_caustic = of([](const Sample&s) { return s.other + s.indirect; }),
                            other = of([](const Sample&s) { return s.other; });
  const auto lost = [&](double Sample::*layer) {
    double above = 0;
    for (std::array<Sample, kSamples> some : samples) {
      std::ranges::sort(some, std::greater(), layer);
      above += std::max(0.0, some[0].*layer - std::max(some[1].*layer, times * levels.white));
    }
    return above > 0 ? above / (kSamples * double(samples.size()) * levels.picture) : 0;
  };
  return {.work = work,
          .all = with_lone(of([](const Sample& s) { return s.sum(); }), without_caustic),
          .without_caustic = adaptive(without_caustic),
          .other = with_lone(of([](const Sample& s) { return s.other + s.caustic; }), other),
          .other_without_caustic = adaptive(other),
          .missed_caustic = {.lone = lost(&Sample::caustic)},
          .missed_indirect = {.lone = lost(&Sample::indirect)}};
}

/// Sets rough.samples and rough.wanted: the number of samples for this pixel error, and the squared error that they
/// leave in all light but layer indirect.
void ask(const Samples& samples, const Levels& levels, double pixel_error, RoughFrame& rough) {
  constexpr double kWholeSample = 4;  // shadow rays: cost of a sample of all parts
  for (const double variance :
       variances(samples, levels, kFirst, [](const Sample& s) { return s.other + s.caustic; })) {
    const double wanted = std::max(kFirst, wanted_samples(std::sqrt(variance), kWholeSample, pixel_error));
    rough.samples += wanted / kPilotParts;
    rough.wanted += variance / wanted / kPilotParts;
  }
  rough.wanted = std::max(rough.wanted, pixel_error * pixel_error);
}

/// Inputs of all measurements of a rough frame.
struct Picture {
  const RenderScene& scene;
  const CameraView& view;
  const RoughOptions& options;
  const Levels levels;
};

/// Two records at one place.
struct Pair {
  bool gathered = false;  ///< false: there is no Lambert lobe at the place
  double error2 = 0;      ///< squared error of light that is interpolated there, over the square of the allowed error
  GatherCounts counts;
};

/// Places records where the picture needs them. Only distances are measured, no light is gathered.
RecordStore place_roughly(const Picture& picture, const FinalGather& gather) {
  const PlacementOptions options;
  RecordStore store;
  const RecordSource source{[&](const SeenPoint& seen, std::size_t, GatherCounts& counts) {
    IrradianceRecord record;
    record.position = seen.surface.position;
    record.normal = seen.normal;
    record.object = seen.surface.object;
    record.radius_unclamped = gather.distance(seen.surface, seen.normal, counts);
    limit_radius(record, seen.footprint, options);
    gather.look_around(seen.surface, record);
    return record;
  }};
  const double pixels = double(picture.view.width()) * picture.view.height();
  const int step = std::max(1, int(std::ceil(std::sqrt(pixels / kLooks))));
  const auto view = [&](const Look& look) {
    return seen_through(picture.scene.tracer, picture.view, {look.x * float(step), look.y * float(step), look.random});
  };
  const auto steps = [step](int size) { return std::max(1, size / step); };
  GatherCounts counts;
  place_records(gather, {view, steps(picture.view.width()), steps(picture.view.height()), {}, &source}, options, store,
                counts);
  return store;
}

/// Number of records whose plain mean has the same variance as the weighted mean of `records` valid ones: (sum w)^2 /
/// sum w^2 = 2/3 of them. For a place anywhere in the disc of a record, the weight w = 1 - d / r has the mean 1/3 and
/// w^2 has the mean 1/6.
double independent(int records) { return std::max(1.0, 2.0 / 3 * records); }

/// Gathers at a place with two gathers of different seeds. Half of the squared difference is the variance of one
/// record.
Pair gather_pair(const Picture& picture, const std::array<FinalGather, 2>& gathers, const RecordStore& placed,
                 int place) {
  Pair pair;
  const Where at = where(place, picture.view, picture.options.seed);
  std::optional<SeenPoint> seen =
      seen_through(picture.scene.tracer, picture.view, {float(at.x) + 0.5f, float(at.y) + 0.5f, {}});
  if (!seen) return pair;
  const SurfaceMaterial material(picture.scene.frame(), seen->surface, seen->footprint);
  const Rgb reflected = diffuse_albedo_of_both(material) * kInvPi;
  double difference = 0;
  for (const FinalGather& gather : gathers) {
    const IrradianceRecord record = gather.gather(seen->surface, seen->normal, pair.counts);
    difference = std::min(double(channel_mean(reflected * record.irradiance)), picture.levels.white) - difference;
  }
  pair.gathered = true;
  const double allowed = picture.levels.allowed[at.part],
               records = independent(placed.interpolate(seen->surface.position, seen->normal).count);
  if (allowed > 0) pair.error2 = difference * difference / 2 / records / (allowed * allowed);
  return pair;
}

/// Sets the values of `rough` that concern records.
void measure_records(const Picture& picture, const RoughLight& light, RoughFrame& rough) {
  const auto gather = [&](std::uint64_t seed) {
    return FinalGather(picture.scene.tracer, picture.scene.lights, light.lookup(), light.gathering(seed));
  };
  const std::array<FinalGather, 2> gathers{gather(picture.options.seed), gather(~picture.options.seed)};
  const RecordStore placed = place_roughly(picture, gathers[0]);
  rough.recorded = true;
  rough.records = double(placed.records().size());
  std::vector<Pair> pairs(kRecords);
  parallel_each(pairs.size(), 1, [&](std::size_t i) { pairs[i] = gather_pair(picture, gathers, placed, int(i)); });
  GatherCounts all;
  double gathered = 0;
  for (const Pair& pair : pairs) {
    rough.record_error += pair.error2 / double(pairs.size()) * RoughLight::kRays;
    gathered += pair.gathered ? 2 : 0;
    all += pair.counts;
  }
  if (gathered > 0)
    rough.record_ray = (double(all.rays) + double(all.shadow_rays) + Work::kRay * double(all.distance_rays)) /
                       (gathered * RoughLight::kRays);
}

/// Adds light that photons show and that paths miss with certainty. found: mean radiance that `samples` paths found.
/// Paths that find light of radiance c once in n samples have at least the variance n c^2 (docs/methods/caustics.md).
/// If paths find no light at all, a single photon proves that they miss some, and the mean of the photons is the best
/// estimate.
void add_shown(const SeenPhotons& photons, double found, double samples, double allowed2, MissedLight& light) {
  const double missed = std::max(0.0, photons.mean - found), error = found > 0 ? kCertain * photons.mean_error : 0;
  const double sure = std::max(0.0, missed * missed - error * error);
  if (!(sure > 0)) return;
  light.square = photons.square * sure / (photons.mean * photons.mean) / allowed2;
  light.variance = samples * sure / allowed2;
}

/// The samples' indirect light as a share of the picture's light, if the share is above kAuditLimit and the mean of the
/// light is below kCertain of its standard errors; else 0. So few samples hold the light then that their variances say
/// nothing about other pixels. For mean and error, a sample counts at most as much as makes its pixel white: one very
/// bright sample among many does not make the light doubtful. Also 0 if all samples at the `places` with a Lambert lobe
/// are fewer than kCertain^2 per part of the picture: then they would not suffice even if each of them held the light.
double uncertain_share(const Samples& samples, const Levels& levels, int places) {
  if (kSamples * places < kCertain * kCertain * kPilotParts) return 0;
  double sum = 0, seen = 0, squares = 0;
  for (const auto& some : samples)
    for (const Sample& sample : some) {
      const double value = std::min(sample.indirect, kFirst * levels.white);
      sum += sample.indirect, seen += value, squares += value * value;
    }
  const double share = levels.picture > 0 ? sum / (kSamples * double(samples.size()) * levels.picture) : 0;
  return share > kAuditLimit && seen < kCertain * std::sqrt(squares) ? share : 0;
}

/// Compares the light of paths with that of photons. Sets the light that paths miss, and the error of a caustic map.
void compare(const Picture& picture, const SeenLight& photons, const Samples& paths, RoughFrame& rough) {
  const auto& [caustics, indirect] = photons;
  const double level = picture.levels.picture, allowed2 = level * level;
  if (!(allowed2 > 0)) return;
  const double samples = kSamples * double(paths.size());
  MissedLight &caustic = rough.path.missed_caustic, &others = rough.path.missed_indirect;
  add_shown(caustics, mean_of(paths, [](const Sample& s) { return s.caustic; }), samples, allowed2, caustic);
  add_shown(indirect, mean_of(paths, [](const Sample& s) { return s.indirect; }), samples, allowed2, others);
  others.uncertain = uncertain_share(paths, picture.levels, rough.places);
  for (std::size_t part = 0; part < caustics.light.size(); ++part) {
    const double light2 = caustics.light[part] * caustics.light[part] / kPilotParts,
                 allowed = picture.levels.allowed[part];
    rough.caustic.push_back({light2 / allowed2, allowed > 0 ? light2 / (allowed * allowed) : 0,
                             caustics.photons[part] / double(kPilotPaths)});
  }
  if (picture.options.without_extent && caustics.mean > picture.options.least_hidden * level)
    caustic.never =
        hidden_share(picture.scene, *picture.options.without_extent, picture.view, level, picture.options.least_hidden);
}

/// Sets lower bounds of work and error for gathering and records, before they are measured. Work: a camera ray, and one
/// ray from each Lambert lobe. Error: that of all light but layer indirect.
void bound_by_paths(const RoughOptions& options, RoughFrame& rough) {
  const double seen = double(rough.places) / options.places;
  rough.gather = rough.path;
  rough.gather.work = Work::kRay * (1 + seen);
  rough.gather.all = rough.path.other;
  rough.gather.without_caustic = rough.path.other_without_caustic;
  rough.gather.missed_caustic.lone = 0;
  rough.gather.missed_indirect = {};
  rough.record_sample = rough.gather.work + seen;
}

/// Sets the values of `rough` that concern gathering.
void measure_gathering(const Picture& picture, const RoughLight& light, const std::vector<double>& lone_light,
                       RoughFrame& rough) {
  const KnownLight known = light.known();
  RayCounts counts;
  const Samples gathered = samples_of(picture.scene, picture.view, &known, picture.options, counts);
  rough.gathered = true;
  rough.gather = effort_of(gathered, picture.levels, rough.samples, work_of(counts, gathered), lone_light);
  const double lone = rough.gather.missed_caustic.lone;
  rough.gather.missed_caustic = rough.path.missed_caustic;  // camera paths find caustic light
  rough.gather.missed_caustic.lone = lone;
  // In place of a gather ray with its continuation (onward), a sample with a record takes the look-up, which is a unit
  // of work, and one ray. MIS needs this ray, which ends at its first hit.
  const double onward_shadow = double(counts.onward) - 2 * double(counts.onward_bounce),
               onward = Work::kRay * double(counts.onward_bounce + counts.points_read) + onward_shadow,
               at_records = (Work::kRay + 1) * double(counts.gathered) - onward;
  rough.record_sample = rough.gather.work + at_records / (kSamples * double(gathered.size()));
}

}  // namespace

RoughFrame rough_frame(const RenderScene& scene, const Lights& aimed, const CameraView& view,
                       const RoughOptions& options) {
  RoughFrame rough;
  rough.paths_of_light = options.photons;
  const SeenPlaces seen = places_seen(scene, view, options.places, options.seed ^ 0x70696c6f74ull);
  rough.places = int(std::ranges::count_if(seen.places, &SeenPlace::exists));
  formats::PhotonBlock photons;
  if (rough.places > 0) {
    photons = pilot_photons(scene.tracer, aimed, options.kinds, kPilotPaths, options.seed ^ 0x61727269766564ull);
    rough.photons_per_path = double(photons.photons.size()) / double(kPilotPaths);
    if (scene.lights.has_distant()) rough.paths_of_light = photon_paths(rough.photons_per_path, options.photons);
  }
  const SeenLight shown = rough.places > 0 ? see_photons(scene, view, photons) : SeenLight{};
  RayCounts counts;
  const Samples paths = samples_of(scene, view, nullptr, options, counts);
  const Picture picture{scene, view, options, Levels(paths, shown, view, options.seed)};
  rough.radiance = mean_of(paths, [](const Sample& s) { return s.sum(); });
  ask(paths, picture.levels, options.pixel_error, rough);
  const std::vector<double> lone =
      lone_variances(scene, aimed, view, options, shown.caustic, picture.levels, rough.samples);
  rough.path = effort_of(paths, picture.levels, rough.samples, work_of(counts, paths), lone);
  rough.wanted_of = std::max(rough.path.other, kFirst * options.pixel_error * options.pixel_error);
  if (rough.places == 0) return rough;
  compare(picture, shown, paths, rough);
  bound_by_paths(options, rough);
  const auto enough = [&] { return options.enough && options.enough(rough); };
  if (enough()) return rough;
  const RoughLight light(scene, photons, rough.paths_of_light, options.seed, options.seen);
  measure_gathering(picture, light, lone, rough);
  if (!enough()) measure_records(picture, light, rough);
  return rough;
}

}  // namespace tempolux
