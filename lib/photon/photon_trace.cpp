#include "lib/photon/photon_trace.h"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <type_traits>

#include "formats/error.h"
#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/material/inside.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"
#include "lib/photon/photon_path.h"
#include "lib/photon/pilot_signature.h"
#include "lib/scene/texture_lookup.h"
#include "lib/trace/solid_around.h"

namespace tempolux {
namespace {

using formats::PathKind;

constexpr float kStepsPerCrossing = 10;  ///< least mean number of tentative collisions in a crossing of the media's box

/// Kind of a photon by the events so far (formats/conventions.md).
PathKind kind_after(bool diffuse_seen, bool specular_seen) {
  return diffuse_seen ? PathKind::indirect : specular_seen ? PathKind::caustic : PathKind::direct;
}

}  // namespace

/// A photon that arrives at a surface. Normals are turned to the side from which the photon comes.
struct Arrival {
  Vec3 wi, normal_geometric, normal;
  ShadingFrame frame;
  Vec3 wi_local;
  float shading_correction;  ///< |wi.n_s| / |wi.n_g|
  bool flat;                 ///< true if the two normals are equal

  Arrival(const SurfacePoint& point, Vec3 travel)
      : wi(-travel),
        normal_geometric(point.normal_geometric * std::copysign(1.0f, dot(point.normal_geometric, wi))),
        normal(point.normal * std::copysign(1.0f, dot(point.normal, normal_geometric))),
        frame(normal, normal_geometric),
        wi_local(frame.to_local(wi)),
        flat(frame.flat()) {
    const float geometric = dot(wi, normal_geometric);
    shading_correction = flat ? 1 : geometric > 0 ? std::max(0.0f, wi_local.z) / geometric : 0;
  }

  /// Multiplies the weight of an event S by Veach's correction for shading normals: `correction`, |wi.n_s| / |wi.n_g|,
  /// times |travel.n_g| / |travel.n_s|. Black on the wrong side of the triangle.
  void weigh_specular(float correction, Vec3 travel, Bsdf::Sample& next) const {
    const float side = next.transmitted ? -1.0f : 1.0f;
    next.weight *=
        correction * std::max(0.0f, side * dot(travel, normal_geometric)) / std::max(1e-6f, side * next.wi.z);
  }

  /// Weight of an event D towards `travel`: f_D cos / pdf. The pdf is that of cosine-distributed directions around the
  /// geometric normal, times the probability of the event. f_D is evaluated as for a camera that looks against
  /// `travel`: with the shading normal, or with the geometric normal if the shading normal faces away from `travel`
  /// (SeenSide). Black behind the surface.
  Rgb scatter_diffuse(const Bsdf& bsdf, const Bsdf::Sample& chosen, Vec3 travel) const {
    const Frame geometric(normal_geometric);
    const Vec3 out = geometric.to_local(travel), in = geometric.to_local(wi);
    const auto by_geometric = [&] {
      return bsdf.in_frame(frame, geometric, [&](const Bsdf& turned) { return turned.eval_diffuse(out, in); });
    };
    if (!(out.z > 0)) return Rgb(0.0f);
    const Vec3 shaded = frame.to_local(travel);
    const bool by_shading = shaded.z > kLooksAway;
    // Light from behind the shading normal is visible only where the geometric normal is used, and only D scatters it.
    if (!(wi_local.z > 0)) return by_shading ? Rgb(0.0f) : by_geometric() * kPi;
    const float p = bsdf.pdf_diffuse(chosen.wi, wi_local) / pdf_hemisphere_cos(chosen.wi.z);
    return by_shading ? bsdf.eval_diffuse(shaded, wi_local) * (kPi * shading_correction / p)
                      : by_geometric() * (kPi / p);
  }

  /// |wi.n| / |wi.n_g| for another normal n; 0 if the light comes from behind n.
  float correction_by(Vec3 n) const {
    const float geometric = dot(wi, normal_geometric),
                cosine = dot(wi, n) * std::copysign(1.0f, dot(n, normal_geometric));
    return geometric > 0 ? std::max(0.0f, cosine) / geometric : 0;
  }

  /// True if the normals differ by half a degree or more.
  bool bent() const { return !flat && dot(normal, normal_geometric) < kBent; }

  /// An event S by the geometric normal. It counts only for directions from which a camera uses the geometric normal,
  /// because the shading normal faces away from them (SeenSide). The weight is black for other directions, and if D was
  /// drawn. These events come in addition to those by the shading normal.
  Bsdf::Sample scatter_by_geometric_normal(const Bsdf& bsdf, float u_lobe, Vec2 u, Vec3& travel) const {
    const Frame geometric(normal_geometric);
    Bsdf::Sample next = bsdf.in_frame(
        frame, geometric, [&](const Bsdf& turned) { return turned.sample(geometric.to_local(wi), u_lobe, u); });
    travel = geometric.to_world(next.wi);
    const float side = next.transmitted ? -1.0f : 1.0f;
    if (next.diffuse || side * dot(travel, normal) > kLooksAway) next.weight = Rgb(0.0f);
    next.diffuse = false;
    return next;
  }

  /// An event S for light from the image of wi (ShadingFrame): the adjoint of a camera path's event whose direction is
  /// mirrored in the plane of the triangle. The weight is black if wi has no image in a lobe, or if D was drawn. These
  /// events come in addition to those by the shading normal.
  Bsdf::Sample scatter_by_image(const Bsdf& bsdf, float u_lobe, Vec2 u, Vec3& travel) const {
    Bsdf::Sample next;
    const float geometric = dot(wi, normal_geometric);
    const std::optional<Vec3> image = frame.image_in_lobe(wi_local);
    if (!image || !(wi_local.z > 0 && geometric > 0)) return next;
    next = bsdf.sample(*image, u_lobe, u);
    travel = frame.to_world(next.wi);
    if (next.diffuse) next.weight = Rgb(0.0f);
    next.diffuse = false;
    weigh_specular(image->z / geometric, travel, next);
    return next;
  }
};

namespace {

/// A surface whose Bsdf must be made at the hit: its material has textures, alpha or dispersion, or transmits
/// diffusely, or the surface bounds a plate of glass. The constructor applies the normal map to the point.
struct Textured {
  Vec3 smooth;  ///< the point's shading normal without a normal map
  SurfaceMaterial material;
  Arrival arrival;
  Bsdf bsdf;
  float coverage;  ///< share of photons that hit the surface there (alpha)

  Textured(const SceneFrame& frame, SurfacePoint& point, Vec3 travel, float wavelength)
      : smooth(point.normal),
        material(frame, point, 0, wavelength),
        arrival(point, travel),
        bsdf(material, dot(point.normal_geometric, travel) < 0, arrival.frame, Carries::flux, point.plate),
        coverage(std::max(1e-6f, coverage_at(frame, point.surface, point.triangle, point.u, point.v))) {}
};

/// True if caustic light can fall on a Lambert lobe with a normal map. Tests all materials, whether or not they are in
/// the frame, so that the static map and the global map have the same columns.
bool normal_maps_see_caustics(const std::vector<Material>& materials) {
  return std::any_of(materials.begin(), materials.end(), [](const Material& m) { return lobes_of(m).specular; }) &&
         std::any_of(materials.begin(), materials.end(),
                     [](const Material& m) { return m.textures && m.textures->normal && may_have_lambert(m); });
}

}  // namespace

void PhotonOptions::set_kinds(const std::string& list) {
  store_direct = store_caustic = store_indirect = store_volume = false;
  std::istringstream in(list);
  for (std::string kind; std::getline(in, kind, ',');) {
    if (kind == "direct") store_direct = true;
    else if (kind == "caustic") store_caustic = true;
    else if (kind == "indirect") store_indirect = true;
    else if (kind == "volume") store_volume = true;
    else throw InputError("--kinds: '" + kind + "' is not a kind of light; choose from direct,caustic,indirect,volume");
  }
  if (kinds().empty()) throw InputError("--kinds: no kind named; choose from direct,caustic,indirect,volume");
}

std::string PhotonOptions::kinds() const {
  std::string list;
  for (const auto& [stored, name] : {std::pair{store_direct, "direct"}, std::pair{store_caustic, "caustic"},
                                     std::pair{store_indirect, "indirect"}, std::pair{store_volume, "tentative"}})
    if (stored) list += (list.empty() ? "" : ",") + std::string(name);
  return list;
}

std::uint32_t automatic_group_count(std::uint64_t photon_count, bool media) {
  if (media)
    for (std::uint32_t groups : {2520u, 630u, 210u, 30u, 6u})
      if (photon_count / groups >= 64) return groups;
  for (std::uint32_t groups : {630u, 210u, 30u, 6u})
    if (photon_count / groups >= 256) return groups;
  return 1;
}

PhotonTracer::PhotonTracer(const Tracer& tracer, const Lights& lights, const PhotonOptions& options)
    : tracer_(tracer), lights_(lights), options_(options), halton_(options.seed) {
  group_count_ = options.group_count ? options.group_count
                                     : automatic_group_count(options.photon_count, tracer.frame().media != nullptr);
  members_ = (options.photon_count + group_count_ - 1) / group_count_;
  batches_per_group_ = (members_ + kBatch - 1) / kBatch;
  stores_ = {options.store_direct, options.store_caustic, options.store_indirect};
  if (const Media* const media = tracer.frame().media.get()) {
    media_ = *media;
    media_->raise_majorants_to(kStepsPerCrossing / media->majorants().mean_chord());
  }
  for (const PlacedLight& placed : tracer.frame().lights) {
    has_point_lights_ |= !placed.light.distant();
    has_spheres_ |= placed.light.size.radius_m > 0;
  }
  directions_ = options.store_volume && media_ && media_->directional();
  directions_ |=
      options.store_directions || (options.store_caustic && normal_maps_see_caustics(tracer.frame().materials));
  for (const Material& material : tracer.frame().materials) {
    solid_.push_back(is_solid_glass(material));
    varies_.push_back(material.textures || lets_rays_pass(material) || transmits_diffusely(material) ||
                      disperses(material));
    bsdfs_.push_back({Bsdf(material, false), Bsdf(material, true)});
  }
  const SceneFrame& frame = tracer.frame();
  for (const EmissionSlot& slot : lights.slots()) {
    const bool surface_moves = slot.surface != kNone && slot.surface >= frame.static_count;
    const bool light_moves = slot.light != kNone && frame.segment.moves(frame.lights[slot.light].node);
    slot_moves_.push_back(surface_moves || light_moves);
  }
  find_solids_of_lights();
}

/// Finds the absorbing solid in which each light is. A surface's first slot stands for all of its slots.
void PhotonTracer::find_solids_of_lights() {
  const SolidAround around(tracer_);
  if (!around.any()) return;
  std::uint32_t last_surface = kNone;
  for (const EmissionSlot& slot : lights_.slots()) {
    const bool placed =
        slot.kind == EmissionSlot::Kind::punctual && !tracer_.frame().lights[slot.light].light.distant();
    const bool same = slot.surface != kNone && slot.surface == last_surface;
    last_surface = slot.surface;
    if (same) slot_inside_.push_back(slot_inside_.back());
    else if (slot.kind == EmissionSlot::Kind::triangle) {
      const Hit middle{0, slot.surface, slot.triangle, 1.0f / 3, 1.0f / 3};
      const SurfacePoint point = tracer_.surface_point(middle);
      slot_inside_.emplace_back(around(point.position, point.normal_geometric, point.offset));
    } else slot_inside_.emplace_back(placed ? around(tracer_.frame().lights[slot.light].position, {}, 0) : kNone);
  }
}

PhotonBatch PhotonTracer::trace(std::size_t number) const {
  const std::uint64_t group = number / batches_per_group_, piece = number % batches_per_group_;
  return trace_members(std::uint32_t(group), piece * kBatch, std::min(members_, (piece + 1) * kBatch));
}

PhotonBatch PhotonTracer::trace_members(std::uint32_t group, std::uint64_t first, std::uint64_t last) const {
  PhotonBatch batch;
  batch.block.group = group;
  batch.block.photons.reserve(std::size_t(3 * (last - first)));
  if (first == 0) batch.pilots.resize(std::size_t(std::min<std::uint64_t>(options_.pilots, last)));
  std::uint64_t numbers[kWave];
  if (!lights_.empty())
    for (std::uint64_t q = first; q < last; q += kWave) {
      const auto count = std::size_t(std::min(last - q, kWave));
      for (std::size_t i = 0; i < count; ++i) numbers[i] = group + (q + i) * group_count_;
      follow({numbers, count}, 0, batch);
    }
  if (!lights_.aim().empty())
    for (const formats::Photon& photon : batch.block.photons)
      batch.seen_count += photon.kind != PathKind::tentative && lights_.aim().holds(vec_of(photon.position));
  return batch;
}

PhotonBatch PhotonTracer::trace_paths(std::span<const std::uint64_t> paths) const {
  PhotonBatch batch;
  batch.by_path = true;
  batch.balance_of.resize(paths.size());
  batch.moved.resize(paths.size());
  if (paths.empty() || lights_.empty()) return batch;
  batch.block.group = std::uint32_t(paths[0] % group_count_);
  for (std::size_t first = 0; first < paths.size(); first += kWave)
    follow(paths.subspan(first, std::min<std::size_t>(kWave, paths.size() - first)), std::uint32_t(first), batch);
  return batch;
}

/// Random numbers of an event.
struct PhotonTracer::Draw {
  std::uint32_t bounce;
  Vec2 u;
  Vec3 direction;  ///< sample_hemisphere_cos(u)
};

namespace {

/// Sorts the photons from number `first` on by their paths (`paths`: the path of each); photons of one path keep their
/// order.
void sort_by_path(std::span<const std::uint8_t> paths, std::size_t first, PhotonBatch& batch) {
  std::array<std::uint32_t, 257> next{};
  for (const std::uint8_t path : paths) ++next[path + 1u];
  for (std::size_t path = 1; path < next.size(); ++path) next[path] += next[path - 1];
  thread_local std::vector<std::uint32_t> place;
  place.clear();
  for (const std::uint8_t path : paths) place.push_back(next[path]++);
  const auto sort = [&](auto& column) {
    if (column.empty()) return;
    thread_local std::remove_reference_t<decltype(column)> before;
    before.assign(column.begin() + std::ptrdiff_t(first), column.end());
    for (std::size_t i = 0; i < place.size(); ++i) column[first + place[i]] = before[i];
  };
  sort(batch.block.photons);
  sort(batch.block.directions);
  sort(batch.path_of);
}

}  // namespace

/// Starts the paths of a wave. Returns the number of paths with flux: lights that are off emit nothing.
std::size_t PhotonTracer::start(std::span<const std::uint64_t> numbers, std::uint32_t first_path, Wave& wave,
                                PhotonBatch& batch) const {
  std::array<double, 4> emission_numbers[kWave];
  for (std::size_t i = 0; i < numbers.size(); ++i) emission_numbers[i] = halton_.point(numbers[i]);
  lights_.emit({emission_numbers, numbers.size()}, {wave.emissions, numbers.size()});
  if (batch.by_path) wave.moved = &batch.moved[first_path];
  const float share = float(1.0 / double(photon_count()));
  std::size_t count = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const PhotonEmission& e = wave.emissions[i];
    Path& path = wave.paths[i];
    if (watch_) wave.touched[i] = slot_moves_[e.slot] ? watch_->all() : 0;
    path.random = PathRandom(options_.seed, numbers[i]);
    path.flux = e.flux * share;
    if (!slot_inside_.empty()) [[unlikely]] {
      path.inside = slot_inside_[e.slot];
      path.flux *= path.inside.index_squared(tracer_.frame().materials);  // as index_squared_of_start does
    }
    path.ray = {e.origin + e.normal * e.origin_offset, e.travel, 0, INFINITY};
    if (e.chord > 0 && !media_) [[unlikely]]
      path.ray.origin = e.origin - e.travel * e.chord;
    path.balance = batch.by_path ? &batch.balance_of[first_path + i] : &batch;
    if (wave.moved) [[unlikely]]
      wave.moved[i] = std::uint8_t(slot_moves_[e.slot]);
    path.balance->emitted += Rgbd(path.flux);
    if (!batch.pilots.empty()) [[unlikely]]
      if (const std::uint64_t member = numbers[i] / group_count_; member < batch.pilots.size()) {
        path.pilot = &batch.pilots[member];
        pilot_signature::start(*path.pilot, path.ray, path.flux);
      }
    if (!is_black(path.flux)) wave.alive[count++] = std::uint32_t(i);
  }
  batch.path_count += numbers.size();
  return count;
}

/// Processes all photons of a wave in each step. The work for different photons is independent, so the processor
/// overlaps it.
void PhotonTracer::follow(std::span<const std::uint64_t> path_numbers, std::uint32_t first_path,
                          PhotonBatch& batch) const {
  Wave wave;
  std::size_t count = start(path_numbers, first_path, wave, batch);
  thread_local std::vector<std::uint8_t> owners;  // paths of the photons of this wave; unused with media
  owners.clear();
  const std::size_t first_photon = batch.block.photons.size();
  Vec2 numbers[kWave];
  Vec3 directions[kWave];
  for (std::uint32_t bounce = 0; count > 0; ++bounce) {
    batch.ray_count += count;
    std::size_t arrived = 0, in_media = 0;
    if (media_) [[unlikely]]
      arrived = fly(bounce, count, wave, in_media, batch);
    else
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t number = wave.alive[i];
        const Path& path = wave.paths[number];
        const bool meets = tracer_.intersect(path.ray, wave.hits[arrived]);
        if (watch_) [[unlikely]]
          wave.touched[number] |= watch_->touching(path.ray, meets ? wave.hits[arrived].t : INFINITY);
        if (meets && wave.moved) [[unlikely]]
          wave.moved[number] |= std::uint8_t(moves(wave.hits[arrived]));
        if (meets) wave.alive[arrived++] = number;
        else path.balance->escaped += Rgbd(path.flux);
      }
    tracer_.surface_points({wave.hits, arrived}, wave.points);
    if (bounce == 0 && has_spheres_ && !media_) [[unlikely]]
      arrived = leave_spheres_of_lamps(arrived, wave, batch);
    if (bounce == 0 && has_point_lights_) arrived = leave_planes_of_lights(arrived, wave, batch);
    for (std::size_t i = 0; i < arrived; ++i)
      numbers[i] = wave.paths[wave.alive[i]].random.get2(bounce, Purpose::scatter);
    sample_hemisphere_cos({numbers, arrived}, directions);
    count = 0;
    for (std::size_t i = 0; i < arrived; ++i) {
      const Draw draw{bounce, numbers[i], directions[i]};
      const std::uint32_t number = wave.alive[i];
      Path& path = wave.paths[number];
      if (path.pilot) [[unlikely]]
        pilot_signature::meet(*path.pilot, bounce, wave.hits[i]);
      wave.alive[count] = number;
      count += scatter(path, wave.points[i], wave.hits[i].t, draw, batch);
      if (!media_) owners.resize(batch.block.photons.size() - first_photon, std::uint8_t(number));
      if (batch.by_path) [[unlikely]]
        batch.path_of.resize(batch.block.photons.size(), first_path + number);
    }
    for (std::size_t i = 0; i < in_media; ++i) wave.alive[count++] = wave.scattered[i];
  }
  if (!media_) sort_by_path(owners, first_photon, batch);
  if (watch_)
    for (std::size_t i = 0; i < path_numbers.size(); ++i)
      if (wave.touched[i]) batch.touched.push_back({path_numbers[i], wave.touched[i]});
}

/// A photon's arrival and the surface where it arrives.
struct PhotonTracer::Meeting : Arrival {
  const SurfacePoint& point;
  float distance;  ///< m: length of the ray
  const Bsdf& bsdf;
  float coverage;    ///< share of photons that hit the surface there (alpha)
  Vec3 smooth;       ///< the shading normal without a normal map
  bool front;        ///< true if the photon came from the surface's front side
  float chance = 1;  ///< probability with which the side was drawn from which the photon goes on
  /// The wavelength that the photon takes if the surface refracts it; null: it takes none.
  const HeroWavelength* hero = nullptr;
};

/// Processes the arrival of a photon at a surface. Returns false if its path ends there.
bool PhotonTracer::scatter(Path& path, SurfacePoint& point, float distance, const Draw& draw,
                           PhotonBatch& batch) const {
  const Vec3 travel = path.ray.direction;
  const bool front = dot(point.normal_geometric, travel) < 0;
  if (varies_[point.material] || point.plate > 0) [[unlikely]] {
    const std::optional<HeroWavelength> hero =
        draw_wavelength(tracer_.frame().materials[point.material], point.plate, path.wavelength, path.random);
    const Textured textured(tracer_.frame(), point, travel, hero ? hero->nm : path.wavelength);
    Meeting at{textured.arrival, point, distance, textured.bsdf, textured.coverage, textured.smooth, front};
    if (hero) at.hero = &*hero;
    const Rgb flux = arrive(path, at, draw.bounce, batch);
    if (transmits_diffusely(textured.material)) [[unlikely]]
      return scatter_to_a_side(path, at, textured.material, flux, draw, batch);
    return scatter_from(path, at, flux, draw, batch);
  }
  const Meeting at{{point, travel}, point, distance, bsdfs_[point.material][front], 1, point.normal, front};
  return scatter_from(path, at, arrive(path, at, draw.bounce, batch), draw, batch);
}

/// Scatters a photon at a surface that transmits diffusely. Draws the side from which the photon goes on. On the far
/// side the photon scatters as if it had come from there, against its direction (diffuse_transmission.h).
bool PhotonTracer::scatter_to_a_side(Path& path, Meeting& at, const MaterialValues& material, Rgb flux,
                                     const Draw& draw, PhotonBatch& batch) const {
  const SideChoice side = choose_side(at.bsdf, at.wi_local, material, path.random.get1(draw.bounce, Purpose::side));
  at.chance = side.chance;
  if (!side.far_side) return scatter_from(path, at, flux, draw, batch);
  if (bounds_solid_at(at.point)) path.inside.scatter(at.point.material, at.front, true);
  const Arrival arrival(at.point, at.wi);
  const Bsdf through(on_far_side(material), !at.front, arrival.frame, Carries::flux);
  return scatter_from(path, {arrival, at.point, at.distance, through, at.coverage, at.smooth, !at.front, at.chance},
                      flux, draw, batch);
}

/// Aims the share Aim::kTowards of the first events D that happen outside the spheres around what cameras see at the
/// spheres. If light from a distant ground enters a room, only one photon in thousands would otherwise enter, with
/// thousands of times the flux of others. Replaces `travel` or keeps it. Returns the pdf of cosine-distributed
/// directions over the pdf of both strategies together, by which the flux is multiplied; at most 1 / (1 - kTowards).
float PhotonTracer::aim(Vec3 position, Vec3 normal, const PathRandom& random, std::uint32_t bounce,
                        Vec3& travel) const {
  const Aim& aim = lights_.aim();
  double towards;
  if (random.get1(bounce, Purpose::scatter, 1) < Aim::kTowards) {
    const Aim::Way way = aim.towards(position, random.get2(bounce, Purpose::scatter, 2));
    travel = way.direction;
    towards = way.pdf_solid_angle;
  } else {
    towards = aim.pdf_solid_angle(position, travel);
  }
  const double cosine = double(std::max(0.0f, dot(travel, normal))) / M_PI;
  return float(cosine / (double(1 - Aim::kTowards) * cosine + double(Aim::kTowards) * towards));
}

/// Records a photon of this flux [W] where it arrives, if the surface has a Lambert lobe and the map stores its kind.
void PhotonTracer::store(const Path& path, const Meeting& at, Rgb flux, std::uint32_t bounce,
                         PhotonBatch& batch) const {
  const PathKind kind = kind_after(path.diffuse_seen, path.specular_seen);
  float weight = at.bsdf.arrival_weight(at.wi_local) * at.shading_correction;
  if (directions_ && kind == PathKind::caustic) [[unlikely]]
    weight = at.correction_by(at.smooth);
  if (!(stores_[std::size_t(kind)] && at.bsdf.has_lambert() && weight > 0)) return;
  Rgb stored = flux * weight;
  if (path.inside.any()) stored *= 1 / path.inside.index_squared(tracer_.frame().materials, path.wavelength);
  if (at.coverage != 1) stored *= 1 / at.coverage;
  // Field by field: copying a record of 32 bytes that was just assembled would stall.
  formats::Photon& photon = batch.block.photons.emplace_back();
  photon.position = array_of(at.point.position);
  photon.flux = array_of(stored);
  photon.normal = formats::encode_normal(array_of(at.normal_geometric));
  photon.object = std::uint16_t(at.point.object);
  photon.kind = kind;
  photon.bounce = std::uint8_t(std::min(bounce, 255u));
  if (directions_) [[unlikely]]
    record_direction(at.wi, batch);
}

/// Draws a photon's event at a surface, by the shading normal or the geometric normal.
PhotonTracer::Event PhotonTracer::event_at(const Path& path, const Meeting& at, const Draw& draw) const {
  const Bsdf& bsdf = at.bsdf;
  const PathRandom& random = path.random;
  // Without specular lobes there is no choice.
  const float u_lobe = bsdf.has_specular() ? random.get1(draw.bounce, Purpose::lobe) : 0;
  Event event;
  Bsdf::Sample& next = event.next;
  Vec3& travel = event.travel;
  // A path is aimed only once: a product of several factors of aim() would be very large for very rare paths.
  const bool aims =
      !path.diffuse_seen && !lights_.aim().empty() && bsdf.has_lambert() && lights_.aim().aims_from(at.point.position);
  // A photon may be scattered in up to three ways: by the shading normal, by the geometric normal, and by the shading
  // normal as if it came from its image. Each way has the same chance, and the photon gets the number of ways as
  // weight.
  int ways = 1;
  bool drawn = false;
  if (bsdf.has_specular() && at.bent()) {
    Bsdf::Sample further[2];
    Vec3 to[2];
    const auto add = [&](const Bsdf::Sample& sample) { further[ways - 1] = sample, ways += !is_black(sample.weight); };
    add(at.scatter_by_geometric_normal(bsdf, u_lobe, draw.u, to[0]));
    add(at.scatter_by_image(bsdf, u_lobe, draw.u, to[ways - 1]));
    const int way = ways > 1 ? int(random.get1(draw.bounce, Purpose::lobe, 1) * float(ways)) : 0;
    drawn = way < ways - 1;
    if (drawn) next = further[way], travel = to[way];
  }
  if (!drawn) {
    next = bsdf.is_matte() ? bsdf.sample_matte(at.wi_local, draw.direction) : bsdf.sample(at.wi_local, u_lobe, draw.u);
    travel = at.frame.to_world(next.wi);
    if (!at.flat && !(at.wi_local.z > 0)) next.diffuse = true;
    if (next.diffuse && (!at.flat || aims)) {
      if (!at.flat) travel = Frame(at.normal_geometric).to_world(sample_hemisphere_cos(draw.u));
      if (aims) event.aimed = aim(at.point.position, at.normal_geometric, random, draw.bounce, travel);
      next.weight = at.scatter_diffuse(bsdf, next, travel);
    } else if (!at.flat) {
      at.weigh_specular(at.shading_correction, travel, next);
    }
  }
  if (ways > 1) next.weight *= float(ways);
  if (next.transmitted && at.hero) [[unlikely]]
    next.weight *= at.hero->color;
  if (at.chance != 1) [[unlikely]]
    next.weight *= 1 / at.chance;
  return event;
}

/// Absorbs a part of the photon's flux in the solid that it has crossed, and records the photon. Returns the flux [W]
/// that arrives.
Rgb PhotonTracer::arrive(Path& path, const Meeting& at, std::uint32_t bounce, PhotonBatch& batch) const {
  Rgb flux = path.flux;
  if (path.inside.any() || (bounds_solid_at(at.point) && !at.front)) {
    flux *= path.inside.transmittance_to(tracer_.frame().materials, at.point.material, at.front, at.distance);
    path.balance->absorbed += Rgbd(path.flux) - Rgbd(flux);
  }
  store(path, at, flux, bounce, batch);
  return flux;
}

/// Scatters a photon of this flux [W] or absorbs it. Returns false if its path ends there.
bool PhotonTracer::scatter_from(Path& path, const Meeting& at, Rgb flux, const Draw& draw, PhotonBatch& batch) const {
  const SurfacePoint& point = at.point;
  const PathRandom& random = path.random;
  const auto [next, travel, aimed] = event_at(path, at, draw);
  const float cos_geometric = (next.transmitted ? -1.0f : 1.0f) * dot(travel, at.normal_geometric);
  const Rgb reflected = flux * next.weight;
  const float survival =
      std::min(kLargestPhotonSurvival, max_component(reflected) / std::max(max_component(flux), 1e-37f));
  const bool first_event = !path.diffuse_seen && !path.specular_seen && !next.straight;
  const bool wanted = !options_.first_event_smooth || !first_event || next.delta;
  const bool survives = wanted && cos_geometric > 0 && random.get1(draw.bounce, Purpose::roulette) < survival;
  // `survival` leaves out the factor `aimed`: it depends on the surface alone, so aimed photons have less flux.
  path.flux = reflected * (survives ? aimed / survival : 0);
  path.balance->absorbed += Rgbd(flux) - Rgbd(path.flux);
  if (next.transmitted && at.hero) [[unlikely]]
    path.wavelength = at.hero->nm;
  if (!next.straight) (next.diffuse ? path.diffuse_seen : path.specular_seen) = true;
  batch.specular_ray_count += survives && !next.diffuse;
  if (bounds_solid_at(point) && !next.diffuse) {
    const std::span<const Material> materials = tracer_.frame().materials;
    if (const float larger = path.inside.index_squared_of_start(materials, point.material, at.front, path.wavelength);
        larger != 1) {
      path.balance->emitted += Rgbd(path.flux * larger) - Rgbd(path.flux);
      path.flux *= larger;
    }
    path.inside.scatter(point.material, at.front, next.transmitted);
  }
  path.ray = spawn_ray(point, travel);
  return survives;
}

}  // namespace tempolux
