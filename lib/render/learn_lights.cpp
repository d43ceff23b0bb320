#include "lib/render/learn_lights.h"

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/parallel.h"
#include "lib/core/sampling.h"
#include "lib/render/places_seen.h"

namespace tempolux {
namespace {

constexpr std::size_t kMostCells = 4096;  ///< a grid of 9 MB
constexpr std::size_t kMostPlaces = 16;   ///< per cell
/// Cells along the longest extent of the visible places: 15 are as good, 60 are too many to learn (S8)
constexpr float kAcrossSeen = 20;
/// Pixels of the picture per ray of a cell: learning shall stay a small part of the cost of a small picture.
constexpr int kPixelsPerRay = 450;
constexpr double kLearned = 0.8;  ///< share of the samples that follow the learned shares; the rest ignore them
/// Share of the second pass's rays that follow the shares learned by the first pass.
constexpr double kFromFirst = 0.6;
constexpr int kBlur = 2;        ///< distance in parts of the sky over which learned light is blurred
constexpr double kPrior = 0.5;  ///< weight of the whole sky's mean, in rays
/// Weight of each of the six neighbouring cells, and of neighbouring parts of the sky.
constexpr double kBeside = 0.5;

/// Light of one kind or from one part of the sky: sums over rays [W/m^2, mean channel].
struct Light {
  double arrived = 0;  ///< light that reached the place, times the cosine
  double sent = 0;     ///< light that would reach the place if nothing blocked it, at normal incidence

  void add(const Light& more, double times) {
    arrived += times * more.arrived;
    sent += times * more.sent;
  }
  /// Root of the share of light that arrives, sqrt(arrived / sent). Some places of a cell get the light and others do
  /// not. The error over all places is least if a light's share of the samples is proportional to the root of its mean
  /// square, and that root is proportional to this value. [1]
  double reach() const { return sent > 0 ? std::sqrt(arrived / sent) : 0; }
};

/// Light that rays have found in a cell.
struct Found {
  std::array<Light, LightGrid::kParts> sky{};
  Light suns, lamps;
  double rays = 0;
};

/// A visible place at which light will be sampled, with the cell that holds it.
struct Place : SeenPlace {
  std::uint64_t cell = 0;
};

/// The longest extent of the places, without 2 % of them at either end [m].
float extent_of(const std::vector<SeenPlace>& places) {
  float extent = 0;
  for (float Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    std::vector<float> along;
    for (const SeenPlace& place : places)
      if (place.exists()) along.push_back(place.surface.position.*axis);
    if (along.empty()) return 0;
    std::sort(along.begin(), along.end());
    extent = std::max(extent, along[(along.size() - 1) * 49 / 50] - along[along.size() / 50]);
  }
  return extent;
}

/// The places by cell, at most kMostPlaces each, for the cells that hold most places; sorted by key.
std::vector<std::vector<Place>> by_cell(std::vector<Place> places) {
  std::erase_if(places, [](const Place& place) { return place.cell == 0; });
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.cell < b.cell; });
  std::vector<std::pair<std::size_t, std::size_t>> runs;  // first place and number of places of each cell
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 0 || places[i].cell != places[i - 1].cell) runs.push_back({i, 0});
    ++runs.back().second;
  }
  std::stable_sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  runs.resize(std::min(runs.size(), kMostCells));
  std::sort(runs.begin(), runs.end());
  std::vector<std::vector<Place>> cells;
  for (const auto& [first, count] : runs)
    cells.emplace_back(places.begin() + std::ptrdiff_t(first),
                       places.begin() + std::ptrdiff_t(first + std::min(count, kMostPlaces)));
  return cells;
}

class Learner {
 public:
  Learner(const RenderScene& scene, const LearnOptions& options, int rays, const LightGrid& grid)
      : scene_(scene), options_(options), rays_(rays), grid_(grid), suns_(scene.lights.suns()) {}

  /// One pass over a cell. `before`: the shares learned so far, or nullptr.
  void look(const std::vector<Place>& places, const LightGrid::Cell* before, int pass, Found& found) const {
    const int rays = rays_;
    for (int i = 0; i < rays; ++i) {
      const Place& place = places[std::size_t(i) % places.size()];
      const PathRandom random(options_.seed + std::uint64_t(pass) * 0x9e3779b97f4a7c15ull,
                              place.cell * 1024 + std::uint64_t(i));
      if (grid_.sky()) add_sky(place, before, random, found);
      add_other(place, random, found);
    }
    found.rays = rays;
  }

 private:
  /// Sends one ray to the sky. The direction is drawn by learned shares, by the sky's light and area, or by the cosine,
  /// and weighted by the sum of the three densities.
  void add_sky(const Place& place, const LightGrid::Cell* before, const PathRandom& random, Found& found) const {
    const double known = before ? kFromFirst : 0, even = 0.5 * (1 - known);
    const double choice = double(random.get1(0, Purpose::light_choice));
    const Vec2 u = random.get2(0, Purpose::light_point);
    EnvironmentLight::Sample sample;
    Vec3 wi;
    if (choice < known + even) {
      double density;
      if (choice < known ? !grid_.sample_sky(*before, u.x, u.y, sample, density)
                         : !grid_.sky()->sample(double(u.x), double(u.y), sample))
        return;
      wi = sample.direction;
    } else {
      wi = Frame(place.normal).to_world(sample_hemisphere_cos(u));
    }
    const double cosine = double(dot(wi, place.normal));
    const double density = (known > 0 ? known * grid_.sky_density(*before, wi) : 0) +
                           even * grid_.sky()->pdf_solid_angle(wi) +
                           (1 - known - even) * std::max(0.0, cosine) / double(kPi);
    if (!(density > 0)) return;
    note(
        place, wi, double(channel_mean(scene_.lights.environment(wi))) / density,
        [&] { return scene_.tracer.occluded(spawn_ray(place.surface, wi)); }, found.sky[grid_.part_of(wi)]);
  }

  /// Takes one sample of each other kind of light: one of the lights with a position, and one of every directional
  /// light.
  void add_other(const Place& place, const PathRandom& random, Found& found) const {
    for (const Lights::Sun& sun : suns_)
      note(
          place, sun.wi, double(channel_mean(sun.irradiance)),
          [&] { return scene_.tracer.occluded(spawn_ray(place.surface, sun.wi)); }, found.suns);
    LightSample light;
    if (!scene_.lights.sample(place.surface.position, place.normal, random.get1(1, Purpose::light_choice),
                              random.get2(1, Purpose::light_point), light) ||
        light.distant)
      return;
    note(
        place, light.wi, double(channel_mean(light.facing_irradiance)),
        [&] { return scene_.tracer.occluded(spawn_shadow_ray(place.surface, light.position, light.position_offset)); },
        found.lamps);
  }

  template <class Occluded>
  void note(const Place& place, Vec3 wi, double sent, const Occluded& occluded, Light& light) const {
    light.sent += sent;
    if (sent > 0 && place.sees(wi) && !occluded()) light.arrived += sent * double(dot(wi, place.normal));
  }

  const RenderScene& scene_;
  const LearnOptions& options_;
  int rays_;
  const LightGrid& grid_;
  std::vector<Lights::Sun> suns_;
};

/// Light of a part of the sky, blurred over the parts at most kBlur away, because few rays must not decide on single
/// parts. Adds a little of the whole sky's mean, for parts without a ray.
Light blurred(const std::array<Light, LightGrid::kParts>& sky, const Light& all, std::uint32_t part) {
  constexpr int w = LightGrid::kAcross, h = LightGrid::kDown;
  Light sum;
  sum.add(all, kPrior / LightGrid::kParts);
  const int row = int(part) / w, column = int(part) % w;
  for (int r = std::max(0, row - kBlur); r <= std::min(h - 1, row + kBlur); ++r)
    for (int c = column - kBlur; c <= column + kBlur; ++c)
      sum.add(sky[std::size_t(r * w + (c + w) % w)],
              r == row && c == column ? 1 : kBeside / (1 + std::abs(r - row) + std::abs(c - column)));
  return sum;
}

/// Light that each part of the sky sends [W/m^2, mean channel].
std::vector<double> light_of_parts(const LightGrid& grid) {
  constexpr std::uint32_t kSide = 4;  // squared: number of directions sampled in a part
  std::vector<double> light(LightGrid::kParts);
  if (grid.sky())
    for (std::uint32_t k = 0; k < LightGrid::kParts; ++k)
      for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        EnvironmentLight::Sample sample;
        const double u1 = (k / LightGrid::kAcross + (i / kSide + 0.5) / kSide) / LightGrid::kDown,
                     u2 = (k % LightGrid::kAcross + (i % kSide + 0.5) / kSide) / LightGrid::kAcross;
        if (grid.sky()->sample(u1, u2, sample))
          light[k] +=
              double(channel_mean(sample.radiance)) / sample.pdf_solid_angle / (kSide * kSide * LightGrid::kParts);
      }
  return light;
}

/// Shares of samples for a cell: most follow the light that reaches the cell; the rest is uniform over the kinds of
/// light and over the sky.
LightGrid::Cell cell_of(const Found& found, const std::vector<double>& parts, const Lights& lights, bool suns,
                        bool lamps) {
  const bool sky = lights.has_environment();
  std::array<double, LightGrid::kParts> weights;
  double skylight = 0;
  Light all_sky;
  for (const Light& part : found.sky) all_sky.add(part, 1);
  for (std::uint32_t k = 0; k < LightGrid::kParts; ++k)
    skylight += weights[k] = parts[k] * blurred(found.sky, all_sky, k).reach();
  const double sunlight = found.suns.sent / found.rays * found.suns.reach(),
               lamplight = found.lamps.sent / found.rays * found.lamps.reach();
  const double kinds = double(sky) + double(suns) + double(lamps), all = skylight + sunlight + lamplight;
  const auto share = [&](bool exists, double of) {
    return exists ? float((all > 0 ? kLearned * of / all : kLearned / kinds) + (1 - kLearned) / kinds) : 0;
  };
  LightGrid::Cell cell;
  cell.sky = share(sky, skylight);
  cell.suns = share(suns, sunlight);
  if (!lamps) cell.suns = suns ? 1 - cell.sky : 0;  // the shares shall add up to 1 without a rounding error
  double sum = 0;
  for (std::uint32_t k = 0; k < LightGrid::kParts; ++k) {
    sum += (skylight > 0 ? kLearned * weights[k] / skylight : kLearned / LightGrid::kParts) +
           (1 - kLearned) / LightGrid::kParts;
    cell.end[k] = float(sum);
  }
  cell.end.back() = 1;
  return cell;
}

/// Adds to each cell's light half of the light of those neighbouring cells that face the same way.
std::vector<Found> joined(const std::vector<std::uint64_t>& keys, const std::vector<Found>& found) {
  std::vector<Found> result(found.size());
  parallel_chunks(found.size(), 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto add = [&](std::size_t from, double times) {
        for (std::uint32_t k = 0; k < LightGrid::kParts; ++k) result[i].sky[k].add(found[from].sky[k], times);
        result[i].suns.add(found[from].suns, times);
        result[i].lamps.add(found[from].lamps, times);
        result[i].rays += times * found[from].rays;
      };
      add(i, 1);
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          const auto at = std::lower_bound(keys.begin(), keys.end(), LightGrid::beside(keys[i], axis, step));
          if (at != keys.end() && *at == LightGrid::beside(keys[i], axis, step))
            add(std::size_t(at - keys.begin()), kBeside);
        }
    }
  });
  return result;
}

}  // namespace

std::unique_ptr<LightGrid> learn_lights(const RenderScene& scene, std::span<const CameraView> views,
                                        const LearnOptions& options) {
  if (!scene.lights.has_distant()) return nullptr;
  SeenPlaces seen;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const SeenPlaces more = places_seen(scene, views[v], options.looks / int(views.size()), options.seed ^ v << 32);
    seen.places.insert(seen.places.end(), more.places.begin(), more.places.end());
    seen.next_places.insert(seen.next_places.end(), more.next_places.begin(), more.next_places.end());
  }
  const float extent = extent_of(seen.places);
  const auto exist = std::ranges::count_if(seen.places, &SeenPlace::exists);
  if (!(extent > 0) || double(std::ranges::count_if(seen.places, &SeenPlace::open)) > kMostOpen * double(exist))
    return nullptr;
  auto grid = std::make_unique<LightGrid>(extent / kAcrossSeen,
                                          scene.lights.has_environment() ? scene.frame().environment : nullptr);
  std::vector<Place> places;
  for (const std::vector<SeenPlace>* from : {&seen.places, &seen.next_places})
    for (const SeenPlace& place : *from)
      if (place.exists()) places.push_back({place, grid->key(place.surface.position, place.normal)});
  const std::vector<std::vector<Place>> cells = by_cell(std::move(places));
  std::vector<std::uint64_t> keys;
  for (const std::vector<Place>& cell : cells) keys.push_back(cell.front().cell);

  const int rays = int(std::clamp(std::int64_t(views[0].width()) * views[0].height() / kPixelsPerRay, std::int64_t(1),
                                  std::int64_t(options.rays)));  // 65536 x 65536 is no int
  const Learner learner(scene, options, rays, *grid);
  const bool suns = !scene.lights.suns().empty(), lamps = scene.lights.has_placed();
  const std::vector<double> parts = light_of_parts(*grid);
  std::vector<LightGrid::Cell> known(cells.size());
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Found> found(cells.size());
    parallel_chunks(cells.size(), 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) learner.look(cells[i], pass > 0 ? &known[i] : nullptr, pass, found[i]);
    });
    found = joined(keys, found);
    for (std::size_t i = 0; i < cells.size(); ++i) known[i] = cell_of(found[i], parts, scene.lights, suns, lamps);
  }
  grid->set(std::move(keys), std::move(known));
  return grid;
}

}  // namespace tempolux
