#include "lib/photon/photon_trace.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include "formats/error.h"
#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/material/inside.h"
#include "lib/material/surface_material.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

using formats::PathKind;

constexpr float kLargestSurvival = 0.9995f;  ///< in a lossless box paths end after 2000 bounces in the mean

/// Kind of a photon by the events so far (architecture.md 3).
PathKind kind_after(bool diffuse_seen, bool specular_seen) {
  return diffuse_seen ? PathKind::indirect : specular_seen ? PathKind::caustic : PathKind::direct;
}

/// A light ray arriving at a surface: normals turned to the side it comes from.
struct Arrival {
  Vec3 wi, normal_geometric, normal;
  Frame frame;
  Vec3 wi_local;
  float shading_correction;                  ///< |wi.n_s| / |wi.n_g|
  bool flat;                                 ///< the two normals are one

  Arrival(const SurfacePoint& point, Vec3 travel)
      : wi(-travel),
        normal_geometric(dot(point.normal_geometric, wi) < 0 ? -point.normal_geometric : point.normal_geometric),
        normal(dot(point.normal, normal_geometric) < 0 ? -point.normal : point.normal),
        frame(normal),
        wi_local(frame.to_local(wi)),
        flat(normal == normal_geometric) {
    const float geometric = dot(wi, normal_geometric);
    shading_correction = flat ? 1 : geometric > 0 ? std::max(0.0f, wi_local.z) / geometric : 0;
  }

  /// Event D where the normals differ: `travel` by the cosine to the geometric normal; returns f_D cos / pdf as the eye
  /// has it that looks against `travel` (ShadingPoint in lib/render/shading.h): by the shading normal, or by
  /// the geometric one where the shading normal looks away from it.
  Rgb scatter_diffuse(const Bsdf& bsdf, const Bsdf::Sample& chosen, Vec2 u, Vec3& travel) const {
    const Frame geometric(normal_geometric);
    const Vec3 out = sample_hemisphere_cos(u), in = geometric.to_local(wi);
    travel = geometric.to_world(out);
    const Vec3 shaded = frame.to_local(travel);
    const bool by_shading = shaded.z > 1e-4f;
    // Light from behind the shading normal is seen from behind it only, and then it scatters by D alone.
    if (!(wi_local.z > 0)) return by_shading ? Rgb(0.0f) : bsdf.eval_diffuse(out, in) * kPi;
    const float p = bsdf.pdf_diffuse(chosen.wi, wi_local) / pdf_hemisphere_cos(chosen.wi.z);
    return by_shading ? bsdf.eval_diffuse(shaded, wi_local) * (kPi * shading_correction / p)
                      : bsdf.eval_diffuse(out, in) * (kPi / p);
  }
};

/// What only materials with textures or alpha need; bends the point's normal.
struct Textured {
  SurfaceMaterial material;
  Bsdf bsdf;
  float coverage;                            ///< share of photons that meet the surface there

  Textured(const SceneFrame& frame, SurfacePoint& point, Vec3 travel, float distance)
      : material(frame, point, kBounceSpread * distance),
        bsdf(material, dot(point.normal_geometric, travel) < 0),
        coverage(std::max(1e-6f, coverage_at(frame, point.surface, point.triangle, point.u, point.v))) {}
};

/// Field by field into its place: a copy of 32 bytes just put together would wait for each of them.
void record(Rgb flux, const SurfacePoint& point, Vec3 normal, PathKind kind, std::uint32_t bounce,
            std::vector<formats::Photon>& photons) {
  formats::Photon& photon = photons.emplace_back();
  photon.position = {point.position.x, point.position.y, point.position.z};
  photon.flux = {flux.r, flux.g, flux.b};
  photon.normal = formats::encode_normal({normal.x, normal.y, normal.z});
  photon.object = std::uint16_t(point.object);
  photon.kind = kind;
  photon.bounce = std::uint8_t(std::min(bounce, 255u));
}

}  // namespace

void PhotonOptions::set_kinds(const std::string& list) {
  store_direct = store_caustic = store_indirect = false;
  std::istringstream in(list);
  for (std::string kind; std::getline(in, kind, ',');) {
    if (kind == "direct") store_direct = true;
    else if (kind == "caustic") store_caustic = true;
    else if (kind == "indirect") store_indirect = true;
    else throw InputError("--kinds: '" + kind + "' is not a kind of light; choose from direct,caustic,indirect");
  }
  if (kinds().empty()) throw InputError("--kinds: no kind named; choose from direct,caustic,indirect");
}

std::string PhotonOptions::kinds() const {
  std::string list;
  for (const auto& [stored, name] : {std::pair{store_direct, "direct"}, std::pair{store_caustic, "caustic"},
                                     std::pair{store_indirect, "indirect"}})
    if (stored) list += (list.empty() ? "" : ",") + std::string(name);
  return list;
}

std::uint32_t automatic_group_count(std::uint64_t photon_count) {
  for (std::uint32_t groups : {630u, 210u, 30u, 6u})
    if (photon_count / groups >= 256) return groups;
  return 1;
}

PhotonTracer::PhotonTracer(const Tracer& tracer, const Lights& lights, const PhotonOptions& options)
    : tracer_(tracer), lights_(lights), options_(options), halton_(options.seed) {
  group_count_ = options.group_count ? options.group_count : automatic_group_count(options.photon_count);
  members_ = (options.photon_count + group_count_ - 1) / group_count_;
  batches_per_group_ = (members_ + kBatch - 1) / kBatch;
  for (const Material& material : tracer.frame().materials) {
    solid_.push_back(is_solid_glass(material));
    varies_.push_back(material.textures || lets_rays_pass(material));
    bsdfs_.push_back({Bsdf(material, false), Bsdf(material, true)});
  }
}

PhotonBatch PhotonTracer::trace(std::size_t number) const {
  PhotonBatch batch;
  const std::uint64_t group = number / batches_per_group_, piece = number % batches_per_group_;
  batch.block.group = std::uint32_t(group);
  const std::uint64_t last = std::min(members_, (piece + 1) * kBatch);
  batch.block.photons.reserve(std::size_t(2 * (last - piece * kBatch)));
  if (!lights_.empty())
    for (std::uint64_t q = piece * kBatch; q < last; ++q) follow(group + q * group_count_, batch);
  return batch;
}

void PhotonTracer::follow(std::uint64_t photon, PhotonBatch& batch) const {
  const PathRandom random(options_.seed, photon);
  double u[4];
  halton_.point(photon, u);
  const PhotonEmission start = lights_.emit(u);
  Rgb flux = start.flux * float(1.0 / double(photon_count()));
  ++batch.path_count;
  batch.emitted += Rgbd(flux);

  Ray ray{start.origin + start.normal * start.origin_offset, start.travel, 0, INFINITY};
  bool diffuse_seen = false, specular_seen = false;
  Inside inside;
  for (std::uint32_t bounce = 0;; ++bounce) {
    ++batch.ray_count;
    Hit hit;
    if (!tracer_.intersect(ray, hit)) {
      batch.escaped += Rgbd(flux);
      return;
    }
    SurfacePoint point = tracer_.surface_point(hit);
    std::optional<Textured> textured;
    if (varies_[point.material]) [[unlikely]] textured.emplace(tracer_.frame(), point, ray.direction, hit.t);
    const Arrival at(point, ray.direction);
    const bool front = dot(point.normal_geometric, at.wi) > 0;
    const Bsdf& bsdf = textured ? textured->bsdf : bsdfs_[point.material][front];
    const bool solid = solid_[point.material];
    if (inside.any() || (solid && !front)) {
      const Rgb sent = flux;
      flux *= inside.transmittance_to(tracer_.frame().materials, point.material, front, hit.t);
      batch.absorbed += Rgbd(sent) - Rgbd(flux);
    }

    // Record.
    const PathKind kind = kind_after(diffuse_seen, specular_seen);
    const bool wanted = kind == PathKind::direct ? options_.store_direct
                        : kind == PathKind::caustic ? options_.store_caustic : options_.store_indirect;
    if (wanted && bsdf.has_lambert() && at.shading_correction > 0) {
      Rgb stored = flux * (bsdf.arrival_weight(at.wi_local.z) * at.shading_correction);
      if (inside.any()) stored *= 1 / inside.index_squared(tracer_.frame().materials);
      if (textured) stored *= 1 / textured->coverage;
      record(stored, point, at.normal_geometric, kind, bounce, batch.block.photons);
    }

    // Scatter, or be absorbed.
    const float u_lobe = bsdf.has_specular() ? random.get1(bounce, Purpose::lobe) : 0;   // else it chooses nothing
    const Vec2 u_scatter = random.get2(bounce, Purpose::scatter);
    auto next = bsdf.sample(at.wi_local, u_lobe, u_scatter);
    Vec3 travel = at.frame.to_world(next.wi);
    const Rgb before = flux;
    if (!at.flat && (next.diffuse || !(at.wi_local.z > 0))) {
      next.diffuse = true;
      next.weight = at.scatter_diffuse(bsdf, next, u_scatter, travel);
    } else if (!at.flat) {
      const float side = next.transmitted ? -1.0f : 1.0f;
      next.weight *= at.shading_correction * std::max(0.0f, side * dot(travel, at.normal_geometric)) /
                     std::max(1e-6f, side * next.wi.z);
    }
    const float cos_geometric = (next.transmitted ? -1.0f : 1.0f) * dot(travel, at.normal_geometric);
    flux *= next.weight;
    const float survival = std::min(kLargestSurvival, max_component(flux) / std::max(max_component(before), 1e-37f));
    if (!(cos_geometric > 0) || !(random.get1(bounce, Purpose::roulette) < survival)) {
      batch.absorbed += Rgbd(before);
      return;
    }
    flux *= 1 / survival;
    batch.absorbed += Rgbd(before) - Rgbd(flux);
    (next.diffuse ? diffuse_seen : specular_seen) = true;
    batch.specular_ray_count += !next.diffuse;
    if (solid && !next.diffuse) inside.scatter(point.material, front, next.transmitted);
    ray = spawn_ray(point, travel);
  }
}

}  // namespace tempolux
