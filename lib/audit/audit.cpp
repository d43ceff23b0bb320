#include "lib/audit/audit.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/octahedral.h"
#include "lib/core/arrays.h"
#include "lib/core/parallel_each.h"
#include "lib/core/random.h"
#include "lib/density/photon_view.h"
#include "lib/photon/photon_trace.h"
#include "lib/render/frame_noise.h"

namespace tempolux {
namespace {

constexpr int kTilesAcross = 4;
constexpr std::array<Layer, 4> kAudited{Layer::specular, Layer::direct, Layer::caustic, Layer::indirect};
constexpr auto kSpecular = std::size_t(Layer::specular);
constexpr double kFewest = 32;  ///< least effective number of contributions from which a variance is estimated
/// Factor for standard errors from 32 audits. Student's t with 31 degrees of freedom exceeds 3 times this factor as
/// rarely as a normally distributed number exceeds 3.
constexpr double kStudent = 3.25 / 3;
/// Cost in rays of a frame: of one light path with its photons in view, and of one camera path.
constexpr double kRaysOfPhoton = 3, kRaysOfPath = 5;
constexpr int kStep = 2;  ///< expect() computes one pixel in each square of this edge
constexpr std::uint64_t kPhotonKey = 0x6175646974ull << 8, kEyeKey = 0x657965ull << 8;

/// The audited light of a pixel or a path by layer, mean channels: all light but lamps and sky in mirrors.
std::array<double, kLayerCount> audited(const Layers& light) {
  std::array<double, kLayerCount> means{};
  for (std::size_t l = 0; l < kLayerCount; ++l) means[l] = channel_mean(Rgbd(light.value[l]));
  means[kSpecular] -= double(light.mirrored);
  return means;
}

}  // namespace

AuditEffort audit_effort(double share, const RayCounts& rays, bool photons, bool paths, bool specular,
                         std::uint64_t seed) {
  const double each = share * double(rays.camera + rays.bounce + rays.shadow) /
                      std::max(1.0, double(photons) + double(paths) + double(specular));
  const auto count = [&](bool wanted, double cost) { return wanted ? std::uint64_t(std::ceil(each / cost)) : 0; };
  return {count(photons, kRaysOfPhoton), count(paths, kRaysOfPath), count(specular, kRaysOfPath), seed};
}

FrameAudit::FrameAudit(const CameraView& view, const RenderedFrame& frame, std::span<const std::uint32_t> objects,
                       std::span<const std::uint8_t> mask, const Inside& camera_inside)
    : view_(view), frame_(frame), mask_(mask), camera_inside_(camera_inside), object_part_(objects.size()) {
  parts_.push_back({"picture"});
  for (int j = 0; j < kTilesAcross; ++j)
    for (int i = 0; i < kTilesAcross; ++i)
      parts_.push_back({"tile " + std::to_string(i + 1) + " " + std::to_string(j + 1)});
  std::map<std::uint32_t, std::uint32_t> part_of;
  for (const std::uint32_t object : objects) part_of.emplace(object, 0);
  for (auto& [object, part] : part_of) {
    part = std::uint32_t(parts_.size());
    parts_.push_back({"object " + std::to_string(object), object});
  }
  for (std::size_t p = 0; p < objects.size(); ++p) object_part_[p] = part_of[objects[p]];
  sums_.resize(parts_.size());
  for (std::size_t p = 0; p < objects.size(); ++p) {
    if (!mask_.empty() && !mask_[p]) continue;
    const std::array<double, kLayerCount> shown = audited(frame.mean.pixels[p]);
    for_parts_of(p, [&](std::size_t part) {
      ++parts_[part].pixels;
      for (std::size_t l = 0; l < kLayerCount; ++l) sums_[part].shown[l] += shown[l];
    });
  }
  picture_ = mean_to_white(frame.mean.pixels, mask_) * double(parts_[0].pixels);
}

/// Calls body(part) for the picture, for the pixel's tile and for the pixel's object.
template <class Body>
void FrameAudit::for_parts_of(std::size_t pixel, const Body& body) const {
  const auto width = std::size_t(view_.width()), height = std::size_t(view_.height());
  const std::size_t i = pixel % width * kTilesAcross / width, j = pixel / width * kTilesAcross / height;
  body(std::size_t(0));
  body(1 + j * kTilesAcross + i);
  body(std::size_t(object_part_[pixel]));
}

void FrameAudit::add_to(Sums& sums, std::size_t audit, std::size_t layer, double radiance) {
  const double square = radiance * radiance;
  sums.light[layer][audit] += radiance;
  sums.square[layer] += square;
  sums.fourth[layer] += square * square;
}

void FrameAudit::add(std::size_t audit, std::size_t pixel, std::size_t layer, double radiance) {
  if (!mask_.empty() && !mask_[pixel]) return;
  for_parts_of(pixel, [&](std::size_t part) { add_to(sums_[part], audit, layer, radiance); });
}

/// Each audit is a photon map with its own seed and one group. Audits are traced in parallel and added in their order.
void FrameAudit::add_photons(const Tracer& tracer, const Lights& lights, const AuditEffort& effort,
                             const SpecularHits* hits) {
  struct Seen : Splat {
    double flux = 0;
  };
  const PhotonSplats camera(tracer, view_, camera_inside_);
  std::array<std::vector<Seen>, kAudits> seen;
  std::array<std::vector<std::pair<std::uint32_t, double>>, kAudits> seen_at_hits;
  std::array<std::vector<double>, kAudits> of_photons;  ///< that are seen at hits
  parallel_each(kAudits, 1, [&](std::size_t k) {
    PhotonOptions options{.seed = mix64(effort.seed ^ (kPhotonKey + k)),
                          .photon_count = (effort.photon_paths + kAudits - 1) / kAudits,
                          .group_count = 1};
    const PhotonTracer photons(tracer, lights, options);
    for (std::size_t b = 0; b < photons.batch_count(); ++b) {
      const formats::PhotonBlock block = photons.trace(b).block;
      for (std::size_t i = 0; i < block.photons.size(); ++i) {
        if (const std::optional<Splat> splat = camera.splat(block.photons[i], {}, PhotonView(block).direction(i)))
          seen[k].push_back({*splat, channel_mean(Rgbd(rgb_of(block.photons[i].flux)))});
        if (!hits) continue;
        const std::size_t first = seen_at_hits[k].size();
        hits->add(block.photons[i], PhotonView(block).direction(i), seen_at_hits[k]);
        double light = 0;
        for (std::size_t h = first; h < seen_at_hits[k].size(); ++h) light += seen_at_hits[k][h].second;
        if (light > 0) of_photons[k].push_back(light);
      }
    }
  });
  std::array<double, kLayerCount> flux{}, square{};
  for (std::size_t k = 0; k < kAudits; ++k)
    for (const Seen& splat : seen[k]) {
      const auto layer = std::size_t(splat.layer);
      add(k, splat.pixel, layer, channel_mean(Rgbd(splat.radiance)));
      flux[layer] += splat.flux, square[layer] += splat.flux * splat.flux;
    }
  for (std::size_t l = 0; l < kLayerCount; ++l) flux[l] = flux[l] > 0 ? square[l] / flux[l] : 0;
  specular_ = hits != nullptr;
  std::vector<double> at_hit(hits ? hits->size() : 0);
  for (std::size_t k = 0; k < kAudits; ++k) {
    for (const double light : of_photons[k]) add_to(sums_[0], k, kSpecular, light);
    for (const auto& [hit, light] : seen_at_hits[k]) at_hit[hit] += light / kAudits;
  }
  for (const double light : at_hit) hits_square_ += light * light;
  expect(tracer, camera, flux);
}

/// Sets Sums::expected. flux [W]: by layer, mean square over mean of the flux of one photon. The contribution of a
/// photon to a pixel is taken at the surface that the pixel's centre sees.
void FrameAudit::expect(const Tracer& tracer, const PhotonSplats& camera, const std::array<double, kLayerCount>& flux) {
  const int columns = (view_.width() + kStep - 1) / kStep, rows = (view_.height() + kStep - 1) / kStep;
  std::vector<double> unit(std::size_t(columns) * std::size_t(rows), 0.0);  ///< contribution of a photon of 1 W
  const auto pixel_of = [&](std::size_t i) {
    const int x = int(i) % columns * kStep, y = int(i) / columns * kStep;
    return std::pair(x, y);
  };
  parallel_each(unit.size(), 64, [&](std::size_t i) {
    const auto [x, y] = pixel_of(i);
    const Ray ray = view_.middle(x, y);
    Hit hit;
    if (!tracer.intersect(ray, hit)) return;
    const SurfacePoint place = tracer.surface_point(hit);
    const Vec3 normal =
        dot(place.normal_geometric, ray.direction) < 0 ? place.normal_geometric : -place.normal_geometric;
    const formats::Photon photon{.position = array_of(place.position),
                                 .flux = {1, 1, 1},
                                 .normal = formats::encode_normal(array_of(normal)),
                                 .kind = formats::PathKind::indirect};
    if (const std::optional<Splat> splat = camera.splat(photon, {}, {})) unit[i] = channel_mean(Rgbd(splat->radiance));
  });
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const auto [x, y] = pixel_of(i);
    const std::size_t pixel = std::size_t(y) * std::size_t(view_.width()) + std::size_t(x);
    if (!mask_.empty() && !mask_[pixel]) continue;
    const Layers& shown = frame_.mean.pixels[pixel];
    for_parts_of(pixel, [&](std::size_t part) {
      for (std::size_t l = 0; l < kLayerCount; ++l)
        sums_[part].expected[l] +=
            kStep * kStep * channel_mean(Rgbd(shown.value[l])) * flux[l] * unit[i] / double(kAudits);
    });
  }
}

/// Each audit cuts the list of pixels into as many pieces as it has paths and draws one pixel from each piece.
void FrameAudit::add_paths(const RenderScene& scene, const AuditEffort& effort) {
  for (Sums& sums : sums_) sums.expected = {};  // not valid if photons find only a part of the frame's light
  const std::size_t pixels = object_part_.size(), count = (effort.eye_paths + kAudits - 1) / kAudits;
  struct Found {
    std::size_t pixel = 0;
    std::array<double, kLayerCount> layer{};
  };
  std::vector<Found> found(kAudits * count);
  parallel_each(found.size(), 64, [&](std::size_t i) {
    const std::uint64_t seed = mix64(effort.seed ^ (kEyeKey + i / count));
    const std::size_t run = i % count;
    const PixelRandom random(seed, run, 0);
    const Vec2 within = PathRandom(seed ^ 1, run).get2(0, Purpose::pixel);
    const std::size_t pixel =
        std::min(pixels - 1, std::size_t((double(run) + double(within.x)) * double(pixels) / double(count)));
    found[i].pixel = pixel;
    if (!mask_.empty() && !mask_[pixel]) return;
    const auto width = std::size_t(view_.width());
    const Ray ray = view_.ray(sample_of_pixel(view_, int(pixel % width), int(pixel / width), random));
    RayCounts rays;
    const Layers light = trace_eye_path(scene, ray, random, nullptr, rays, view_.cone());
    found[i].layer = audited(light);
  });
  const double pixels_of_path = double(pixels) / double(count);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const Layer layer : kAudited) {
      const auto l = std::size_t(layer);
      if (found[i].layer[l] != 0) add(i / count, found[i].pixel, l, pixels_of_path * found[i].layer[l]);
    }
}

AuditEntry FrameAudit::entry(std::size_t part, std::size_t layer) const {
  const Sums& sums = sums_[part];
  const double n = double(parts_[part].pixels);
  AuditEntry entry{.layer = Layer(layer),
                   .part = parts_[part].name,
                   .object = parts_[part].object,
                   .pixels = parts_[part].pixels,
                   .shown = sums.shown[layer] / n,
                   .light = {},
                   .bias = {},
                   .picture = picture_ / n};
  const bool few = sums.square[layer] * sums.square[layer] < kFewest * sums.fourth[layer];
  if (!(sums.fourth[layer] > 0) || (few && !(sums.expected[layer] > 0))) return entry;
  double sum = 0, square = 0;
  for (const double audit : sums.light[layer]) sum += audit;
  const double mean = sum / kAudits;
  for (const double audit : sums.light[layer]) square += (audit - mean) * (audit - mean);
  entry.light = {mean / n, std::sqrt(square / kAudits / (kAudits - 1)) / n};
  const double noise = frame_.noise.known() ? std::max(0.0, frame_.noise.layer[layer].linear) : 0;
  if (layer == kSpecular) entry.light.error = std::hypot(entry.light.error, std::sqrt(hits_square_) / n);
  const double error = std::max(kStudent * entry.light.error, std::sqrt(std::max(0.0, sums.expected[layer])) / n);
  entry.bias = {entry.shown - entry.light.value, std::sqrt(error * error + noise * noise / n)};
  return entry;
}

std::vector<AuditEntry> FrameAudit::entries() const {
  std::vector<AuditEntry> entries;
  for (const Layer layer : kAudited)
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      if (parts_[part].pixels == 0 || (layer == Layer::specular && (part > 0 || !specular_))) continue;
      const AuditEntry found = entry(part, std::size_t(layer));
      if (found.bias.known()) entries.push_back(found);
    }
  return entries;
}

bool is_biased(const AuditEntry& entry) {
  return std::abs(entry.share()) > kAuditLimit && std::abs(entry.bias.value) > kAuditErrors * entry.bias.error;
}

}  // namespace tempolux
