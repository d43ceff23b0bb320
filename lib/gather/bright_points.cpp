#include "lib/gather/bright_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "lib/core/frame.h"
#include "lib/core/parallel_each.h"
#include "lib/core/sampling.h"
#include "lib/points/irradiance_points.h"
#include "lib/points/reachable_area.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"
#include "lib/transport/media.h"
#include "lib/transport/shading.h"

namespace tempolux {
namespace {

/// Sorts `values`. Sorts their indices first, because a site holds a Bsdf and is slow to move. Equal values keep their
/// order.
template <class T, class Before>
void sort_stably(std::vector<T>& values, const Before& before) {
  std::vector<std::uint32_t> order(values.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return before(values[a], values[b]); });
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::uint32_t i : order) sorted.push_back(std::move(values[i]));
  values = std::move(sorted);
}

/// Sites per point. Sites of a spot are drawn at random; the mean over 16 sites has an error of a few per cent of the
/// point's light.
constexpr double kSitesPerPoint = 16;
/// Light of a spot of radius R is explicit if the spot is farther away than this many R. At this distance a disc of
/// radius R fills 1/17 of what a Lambert lobe sees: at smaller distances many rays meet the spot.
constexpr float kExplicitFrom = 4;

}  // namespace

BrightPoints::BrightPoints(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                           std::vector<float> high_shares, const BrightOptions& options)
    : tracer_(tracer),
      points_(points),
      high_(std::move(high_shares)),
      radius_(points.spacing() * std::sqrt(kInvPi)),
      lamp_reach_(kBesideLamp * points.spacing()) {
  high_.resize(points.size(), 0.0f);
  // If indirect light around a point is not uniform, the gather ray continues and finds light that the point does not
  // store. No share of that light may be sampled explicitly, so the high share becomes 0. Direct light of lamps close
  // to a surface is divided separately (has_lamp_light).
  for (std::uint32_t i = 0; i < high_.size(); ++i)
    if (high_[i] > 0 && (points.light(i).beside_lamp || !points.is_uniform_indirect(points.light(i)))) high_[i] = 0;
  if (std::ranges::any_of(high_, [](float share) { return share > 0; })) place_high(lights, options);
  place_lamp_light(options.beside_lamps);
  gather_spots();
}

/// Places sites of the points that have a high part.
void BrightPoints::place_high(const Lights& lights, const BrightOptions& options) {
  const PointLookup& points = points_;
  std::vector<formats::Photon> bright;  // the points as photons, to find them by place
  std::vector<std::uint32_t> objects;
  Box3 box;
  for (std::uint32_t i = 0; i < high_.size(); ++i) {
    if (!(high_[i] > 0)) continue;
    const Vec3 position = points.points()[i].position;
    bright.emplace_back().position = array_of(position);
    box.add(position);
    objects.push_back(points.points()[i].object);
  }
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  const double spacing = double(points.spacing());
  // A point represents places up to kReach spacings away. The reach is doubled, because a site lies slightly above or
  // below its surface. place_sites() covers all surface within 3/4 of the sphere's radius.
  const PhotonIndex index(bright);
  const float reach = 2 * PointLookup::kReach * points.spacing();
  const AimSphere around{
      Vec3d(box.lower + box.upper) * 0.5,
      (0.5 * double(length(box.upper - box.lower)) + 4 * double(PointLookup::kReach) * spacing) / 0.75, 1};
  const std::vector<PlacedSite> placed = place_sites(
      tracer_.frame(), objects, around, spacing * spacing / kSitesPerPoint, options.seed, [&](Vec3 position) {
        thread_local NeighbourList near;
        index.find_nearest({.point = position, .max_radius = reach}, 1, near);
        return near.count() > 0;
      });
  std::vector<std::optional<Site>> found(placed.size());
  parallel_each(placed.size(), 256, [&](std::size_t i) { found[i] = site_at(placed[i].place, placed[i].area); });
  for (std::optional<Site>& site : found)
    if (site) sites_.push_back(std::move(*site));
  sort_stably(sites_, [](const Site& a, const Site& b) { return a.spot < b.spot; });
  std::vector<std::uint32_t> uneven;
  for (std::uint32_t i = 0; i < sites_.size(); ++i)
    if (!points.is_uniform(*points.find(sites_[i].place.position, sites_[i].normal))) uneven.push_back(i);
  sample_uneven(lights, uneven, options);
}

/// Places sites at photons of lamps.
void BrightPoints::place_lamp_light(std::span<const LampPhoton> photons) {
  sites_.reserve(sites_.size() + photons.size());
  std::unordered_map<std::uint64_t, std::uint32_t> cells;  // number of each cell with photons that have no point
  for (const LampPhoton& photon : photons) {
    std::uint32_t spot = photon.point;
    if (spot == kNone)
      spot = std::uint32_t(high_.size()) +
             cells.emplace(points_.ask(photon.place.position, photon.normal).cell, std::uint32_t(cells.size()))
                 .first->second;
    sites_.push_back({photon.place, photon.normal, photon.flux, photon.bsdf, 0, 1, spot, photon.lamp_distance,
                      photon.arriving, photon.wi});
  }
}

/// Joins the sites of each point, or cell, into a spot.
void BrightPoints::gather_spots() {
  sort_stably(sites_, [](const Site& a, const Site& b) {
    const bool lamp_a = a.lamp_distance > 0, lamp_b = b.lamp_distance > 0;
    return lamp_a != lamp_b ? lamp_b : a.spot < b.spot;
  });
  std::vector<LightBounds> spots;
  for (std::size_t i = 0, end = 0; i < sites_.size(); i = end) {
    LightBounds spot;
    spot.axis = sites_[i].spot < high_.size() ? points_.points()[sites_[i].spot].normal : sites_[i].normal;
    for (end = i; end < sites_.size() && sites_[end].spot == sites_[i].spot; ++end) {
      const Site& site = sites_[end];
      spot.box.add(site.place.position);
      spot.cos_spread = std::min(spot.cos_spread, dot(site.normal, spot.axis));
      spot.add_weight(site.normal,
                      double(channel_mean(site.bsdf.diffuse_albedo() * site.irradiance) * (site.area * kInvPi)));
    }
    if (!(spot.weight > 0)) continue;
    spots.push_back(spot);
    sites_of_.push_back({std::uint32_t(i), std::uint32_t(end - i)});
    if (!(sites_[i].lamp_distance > 0)) point_spots_ = spots.size();
  }
  tree_.emplace(spots);
  spots.resize(point_spots_);
  point_tree_.emplace(spots);
}

/// The site at a place; none if the point that represents the place has no high part, or if another object coincides
/// with the place.
std::optional<BrightPoints::Site> BrightPoints::site_at(const IrradiancePoint& place, float area) const {
  const float offset = Reach(tracer_).offset();
  Hit hit;
  if (!tracer_.intersect({place.position + place.normal * (4 * offset), -place.normal, 0, 8 * offset, true}, hit))
    return std::nullopt;
  SurfacePoint there = tracer_.surface_point(hit);
  if (there.object != place.object) return std::nullopt;
  const Vec3 normal = face_forward(there.normal_geometric, place.normal);
  const PointLookup::Light* light = points_.find(there.position, normal);
  if (!light || !(high_[light->point] > 0)) return std::nullopt;
  const SurfaceMaterial material(tracer_.frame(), there);
  const Bsdf bsdf(material, dot(there.normal_geometric, place.normal) > 0, Frame(face_forward(there.normal, normal)));
  if (!bsdf.has_diffuse()) return std::nullopt;
  return Site{there, normal, light->all * high_[light->point], bsdf, light->radius, area, light->point};
}

/// Gather rays sample direct light at hits whose point's direct light is not uniform. This function does the same at
/// the sites with these indices.
void BrightPoints::sample_uneven(const Lights& lights, const std::vector<std::uint32_t>& uneven,
                                 const BrightOptions& options) {
  std::vector<IrradiancePoint> sampled;
  for (const std::uint32_t i : uneven) {
    IrradiancePoint point;
    point.position = sites_[i].place.position;
    point.normal = sites_[i].normal;
    point.object = sites_[i].place.object;
    sampled.push_back(point);
  }
  PointOptions sampling;
  sampling.seed = options.seed ^ 0x6272696768740000ull;
  sampling.light_samples = options.light_samples;
  update_direct(tracer_, lights, nullptr, sampling, sampled);
  for (std::size_t i = 0; i < uneven.size(); ++i) {
    Site& site = sites_[uneven[i]];
    const IrradiancePoint& point = points_.points()[site.spot];
    site.irradiance = (point.indirect + point.caustic + sampled[i].direct) * high_[site.spot];
  }
}

/// True if w(distance) = 1 for a spot of this radius R [m]: for a lamp's light, the distance of the lamp.
bool BrightPoints::is_explicit(float distance, float radius) { return distance > kExplicitFrom * radius; }

/// Explicit share of a site's light at a receiver `distance` m away.
float BrightPoints::share(const Site& site, float distance, bool reads_close) const {
  if (site.lamp_distance > 0) return is_explicit(distance, site.lamp_distance);
  if (!is_explicit(distance, radius_)) return 0;
  return reads_close ? 1 : PointLookup::share_of_far(site.radius, distance);
}

Rgb BrightPoints::radiance(const Site& site, Vec3 wo) const {
  const Vec3 local = site.bsdf.has_specular() ? SeenSide(site.place, wo).wo_local : Vec3{0, 0, 1};
  return site.bsdf.diffuse_reflectance(local) * site.irradiance * kInvPi;
}

BrightLight BrightPoints::arriving(const Receiver& at, int samples, const PathRandom& random,
                                   GatherCounts& counts) const {
  const SurfacePoint& place = at.place;
  const Vec3 normal = at.normal;
  const Vec3 geometric = face_forward(place.normal_geometric, normal);
  std::optional<Frame> frame;
  Bsdf::Direction eye;
  if (at.seen_from) eye = at.coat->along(frame.emplace(normal).to_local(*at.seen_from));
  BrightLight light;
  if ((at.lamps ? sites_of_.size() : point_spots_) == 0) return light;
  const LightTree& tree = at.lamps ? *tree_ : *point_tree_;
  const LightTree::Start start = tree.start(place.position, normal);
  for (std::uint32_t number = 0; number < std::uint32_t(samples); ++number) {
    const float u =
        at.choice ? *at.choice : (float(number) + random.get1(number, Purpose::light_choice, 1)) / float(samples);
    LightTree::Choice chosen;
    if (!tree.choose(start, place.position, normal, std::min(u, kOneMinusEpsilon), chosen)) continue;
    const Sites& sites = sites_of_[chosen.light];
    const Site& site =
        sites_[sites.first + std::min(sites.count - 1, std::uint32_t(chosen.left * double(sites.count)))];
    const Vec3d d(site.place.position - place.position), n(normal), m(site.normal);
    const double distance = length(d), here = dot(n, d), there = -dot(m, d);  // cosines times the distance
    const Vec3 wi(d * (1 / std::max(distance, 1e-300)));
    if (!(here > 0 && there > 0 && dot(wi, geometric) > 0)) continue;
    const Vec3 wi_local = frame ? frame->to_local(wi) : Vec3{};
    const float width = frame ? lobe_width(*at.coat, wi_local, eye) : 1;
    const float part = share(site, float(distance) * width, at.reads_close);
    if (!(part > 0)) continue;
    ++counts.shadow_rays;
    const Rgb passed = transmittance(tracer_, spawn_shadow_ray(place, site.place.position, site.place.offset),
                                     {random, number, way_shadow});
    if (is_black(passed)) continue;
    const Rgbd seen = Rgbd(radiance(site, -wi) * part) * Rgbd(passed);
    const double d2 = distance * distance;
    const Rgb arrival = frame     ? at.coat->eval_specular(at.coat->along(wi_local), eye)
                        : at.coat ? Rgb(at.coat->arrival_weight(wi, normal))
                                  : Rgb(1.0f);
    const Rgbd power =
        seen * Rgbd(arrival) * (double(site.area) * double(sites.count) / (chosen.probability * double(samples)));
    const Rgbd e = power * (here * there / (d2 * d2));
    light.irradiance += e;
    if (frame) continue;
    // E = P (n d) (-m d) / d^4 with d = y - x, so dE/dx = P (-n (-m d) + m (n d) + 4 (n d) (-m d) d / d^2) / d^4. The
    // gradient is projected onto the tangent plane.
    const Vec3d along = (m - n * dot(m, n)) * here + (d - n * here) * (4 * here * there / d2);
    const Vec3d turn = cross(n, d) * there;  // (n_i x n) . g is the change of n . d
    for (int c = 0; c < 3; ++c) {
      light.translational[std::size_t(c)] += along * (power[c] / (d2 * d2));
      light.rotational[std::size_t(c)] += turn * (power[c] / (d2 * d2));
    }
  }
  return light;
}

std::optional<BrightPoints::LampSpot> BrightPoints::lamp_spot(const SurfacePoint& place, Vec3 normal,
                                                              float choice) const {
  if (sites_of_.empty()) return std::nullopt;
  LightTree::Choice chosen;
  if (!tree_->choose(tree_->start(place.position, normal), place.position, normal, choice, chosen)) return std::nullopt;
  const Sites& sites = sites_of_[chosen.light];
  const Site& site = sites_[sites.first + std::min(sites.count - 1, std::uint32_t(chosen.left * double(sites.count)))];
  const Vec3d d(site.place.position - place.position);
  const double distance = length(d), there = -dot(Vec3d(site.normal), d);
  const Vec3 wi(d * (1 / std::max(distance, 1e-300)));
  if (!(site.lamp_distance > 0 && there > 0 && dot(wi, normal) > 0 &&
        dot(wi, face_forward(place.normal_geometric, normal)) > 0))
    return std::nullopt;
  const auto scale = float(there / (distance * distance * distance) * double(sites.count) / chosen.probability);
  LampSpot spot;
  spot.wi = wi;
  spot.distance = float(distance);
  spot.lamp_distance = site.lamp_distance;
  spot.matte = radiance(site, -wi) * scale;
  if (site.bsdf.has_specular() && !site.bsdf.specular_is_delta()) {
    const SeenSide side(site.place, -wi);
    const Bsdf::Direction from = site.bsdf.along(side.frame.to_local(site.wi)), to = site.bsdf.along(side.wo_local);
    if (side.sees(site.wi)) {
      spot.glossy = eval_specular(site.bsdf, side.frame, from, to) * site.arriving * scale;
      spot.gloss_width = width_of(gloss_density(site.bsdf, side.frame, from.w, to));
    }
  }
  spot.shadow = spawn_shadow_ray(place, site.place.position, site.place.offset);
  return spot;
}

float reach_of_spots(const Lights& lights, std::span<const IrradianceRecord> records) {
  if (!lights.has_placed()) return 0;
  // n^(2/3) of n records suffice for a median, and the work stays small.
  const std::size_t step = std::size_t(std::cbrt(double(records.size()))) + 1;
  std::vector<float> distances;
  for (std::size_t i = 0; i < records.size(); i += step) {
    const PathRandom random(0x7265616368ull, i);
    LightSample light;
    if (lights.sample(records[i].position, records[i].normal, random.get2(0, Purpose::light_point), light,
                      Lights::From::not_suns) &&
        !light.distant)
      distances.push_back(length(light.position - records[i].position));
  }
  if (distances.empty()) return 0;
  std::ranges::nth_element(distances, distances.begin() + std::ptrdiff_t(distances.size() / 2));
  return distances[distances.size() / 2] / kExplicitFrom;
}

void add_bright_light(const BrightLight& light, IrradianceRecord& record) {
  record.irradiance = Rgb(Rgbd(record.irradiance) + light.irradiance);
  for (std::size_t c = 0; c < 3; ++c) {
    record.translational[c] = Vec3(Vec3d(record.translational[c]) + light.translational[c]);
    record.rotational[c] = Vec3(Vec3d(record.rotational[c]) + light.rotational[c]);
  }
}

}  // namespace tempolux
