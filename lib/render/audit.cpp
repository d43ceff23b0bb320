#include "lib/render/audit.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/octahedral.h"
#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {
namespace {

constexpr int kTilesAcross = 4;
constexpr std::array<Layer, 3> kAudited{Layer::direct, Layer::caustic, Layer::indirect};
constexpr double kFewest = 32;  ///< effective photons or paths: an estimate from fewer gets no standard error
/// Largest share of one map or path in the sum of squares: above this the standard error is not known.
constexpr double kMostOfOne = 0.5;
/// Rays of a frame that cost as much as one light path with the photons that it leaves in view; as much as two camera
/// paths.
constexpr double kRaysOfPhoton = 3, kRaysOfPath = 7;
constexpr std::uint64_t kPhotonKey = 0x6175646974ull << 8, kEyeKey = 0x657965ull;

double light_of(const Layers& pixel) {
  double sum = 0;
  for (const Rgb& radiance : pixel.value) sum += channel_mean(Rgbd(radiance));
  return sum;
}

/// Mean of both estimates, weighted by inverse variance, or the only one that is known. If the two differ by more than
/// kAuditErrors standard errors of their difference, one of them is wrong (for example because it missed rare light).
/// Nothing decides which one, so the result is unknown.
Estimate joined(const Estimate& a, const Estimate& b) {
  if (!a.known()) return b;
  if (!b.known()) return a;
  const double va = a.error * a.error, vb = b.error * b.error;
  if (!(va + vb > 0)) return a;
  const double apart = a.value - b.value;
  if (apart * apart > kAuditErrors * kAuditErrors * (va + vb)) return {};
  return {(a.value * vb + b.value * va) / (va + vb), std::sqrt(va * vb / (va + vb))};
}

}  // namespace

AuditEffort audit_effort(double share, const RayCounts& rays, std::uint64_t seed) {
  const double half = 0.5 * share * double(rays.camera + rays.bounce + rays.shadow);
  return {std::uint64_t(std::ceil(half / kRaysOfPhoton)), std::size_t(std::ceil(half / kRaysOfPath)), seed};
}

FrameAudit::FrameAudit(const CameraView& view, const RenderedFrame& frame, std::span<const std::uint32_t> objects,
                       std::span<const std::uint8_t> mask)
    : view_(view), frame_(frame), mask_(mask), object_part_(objects.size()) {
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
    const Layers& pixel = frame.mean.pixels[p];
    picture_ += light_of(pixel);
    for_parts_of(p, [&](std::size_t part) {
      ++parts_[part].pixels;
      for (std::size_t l = 0; l < kLayerCount; ++l) sums_[part].shown[l] += channel_mean(Rgbd(pixel.value[l]));
    });
  }
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

/// Each map has its own seed and all of its paths in one group. Maps are traced in parallel and added in order.
void FrameAudit::add_photons(const Tracer& tracer, const Lights& lights, const AuditEffort& effort) {
  const PhotonSplats camera(tracer, view_);
  std::array<std::vector<Splat>, kMaps> seen;
  parallel_chunks(kMaps, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      PhotonOptions options{.seed = mix64(effort.seed ^ (kPhotonKey + k)),
                            .photon_count = (effort.photon_paths + kMaps - 1) / kMaps,
                            .group_count = 1};
      const PhotonTracer photons(tracer, lights, options);
      for (std::size_t b = 0; b < photons.batch_count(); ++b) {
        const formats::PhotonBlock block = photons.trace(b).block;
        for (std::size_t i = 0; i < block.photons.size(); ++i) {
          std::optional<Vec3> wi;
          if (!block.directions.empty()) {
            const std::array<float, 3> decoded = formats::decode_normal(block.directions[i]);
            wi = Vec3{decoded[0], decoded[1], decoded[2]};
          }
          if (const std::optional<Splat> splat = camera.splat(block.photons[i], {}, wi)) seen[k].push_back(*splat);
        }
      }
    }
  });
  for (std::size_t k = 0; k < kMaps; ++k)
    for (const Splat& splat : seen[k]) {
      if (!mask_.empty() && !mask_[splat.pixel]) continue;
      const auto layer = std::size_t(splat.layer);
      const double radiance = channel_mean(Rgbd(splat.radiance)), square = radiance * radiance;
      for_parts_of(splat.pixel, [&](std::size_t part) {
        sums_[part].splats[layer][k] += float(radiance);
        sums_[part].splats_square[layer] += square;
      });
    }
}

void FrameAudit::add_paths(const RenderScene& scene, const FrameOptions& options, const AuditEffort& effort) {
  const std::size_t pixels = object_part_.size(), count = effort.eye_paths;
  struct Difference {
    std::size_t pixel = 0;
    bool counts = false;
    std::array<double, kLayerCount> layer{};
    std::array<double, kLayerCount> found{};
  };
  std::vector<Difference> differences(count);
  const std::uint64_t seed = mix64(effort.seed ^ kEyeKey);
  parallel_chunks(count, 64, [&](std::size_t first, std::size_t last) {
    RayCounts rays;
    for (std::size_t i = first; i < last; ++i) {
      Difference& difference = differences[i];
      const PixelRandom random(seed, i, 0);
      // The pixels are divided into `count` runs, row by row, and one pixel is drawn from each run.
      const Vec2 jitter = random.get2(0, Purpose::pixel), within = PathRandom(seed ^ 1, i).get2(0, Purpose::pixel);
      difference.pixel =
          std::min(pixels - 1, std::size_t((double(i) + double(within.x)) * double(pixels) / double(count)));
      if (!mask_.empty() && !mask_[difference.pixel]) continue;
      const auto width = std::size_t(view_.width());
      const Ray ray = view_.ray(float(difference.pixel % width) + jitter.x, float(difference.pixel / width) + jitter.y);
      Hit hit;
      scene.tracer.intersect(ray, hit);
      const Layers shown =
          trace_eye_path(scene, ray, hit, random, options.known, rays, view_.cone(), effort_of(0)).sum();
      const Layers found = trace_eye_path(scene, ray, hit, random, nullptr, rays, view_.cone(), effort_of(0)).sum();
      difference.counts = true;
      for (std::size_t l = 0; l < kLayerCount; ++l) {
        difference.found[l] = channel_mean(Rgbd(found.value[l]));
        difference.layer[l] = channel_mean(Rgbd(shown.value[l])) - difference.found[l];
      }
    }
  });
  for (const Difference& difference : differences) {
    if (!difference.counts) continue;
    for_parts_of(difference.pixel, [&](std::size_t part) {
      Sums& sums = sums_[part];
      ++sums.path_count;
      for (std::size_t l = 0; l < kLayerCount; ++l) {
        const double d = difference.layer[l], found = difference.found[l];
        sums.paths[l] += d;
        sums.found[l] += found;
        sums.found_square[l] += found * found;
        sums.paths_square[l] += d * d;
        sums.paths_largest[l] = std::max(sums.paths_largest[l], d * d);
      }
    });
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
                   .splats = {},
                   .paths = {},
                   .bias = {},
                   .picture = picture_ / n};
  Estimate by_splats;
  double sum = 0;
  for (const float map : sums.splats[layer]) sum += double(map);
  if (sum > 0 && sum * sum >= kFewest * sums.splats_square[layer]) {
    double square = 0, largest = 0;
    for (const float map : sums.splats[layer]) {
      const double off = double(map) - sum / kMaps, off2 = off * off;
      square += off2;
      largest = std::max(largest, off2);
    }
    if (largest <= kMostOfOne * square) {
      entry.splats = {sum / n / kMaps, std::sqrt(square / kMaps / (kMaps - 1)) / n};
      const double noise = frame_.noise.known() ? std::max(0.0, frame_.noise.layer[layer].linear) : 0;
      by_splats = {entry.shown - entry.splats.value,
                   std::sqrt(entry.splats.error * entry.splats.error + noise * noise / n)};
    }
  }
  const double m = double(sums.path_count);
  // With equal random numbers both ways sample the same direct light: a difference of 0 is no measurement.
  if (sums.paths_square[layer] > 0 && sums.found[layer] * sums.found[layer] >= kFewest * sums.found_square[layer] &&
      sums.paths_largest[layer] <= kMostOfOne * sums.paths_square[layer])
    entry.paths = {sums.paths[layer] / m, std::sqrt(std::max(0.0, sums.paths_square[layer] / m -
                                                                      sums.paths[layer] * sums.paths[layer] / (m * m)) /
                                                    (m - 1))};
  // Light that no path met has no part in the variance of paths. So paths alone cannot know that a frame is too bright.
  const bool unmet = !by_splats.known() && entry.paths.value > kAuditErrors * entry.paths.error;
  entry.bias = joined(by_splats, unmet ? Estimate{} : entry.paths);
  return entry;
}

std::vector<AuditEntry> FrameAudit::entries() const {
  std::vector<AuditEntry> entries;
  for (const Layer layer : kAudited)
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      if (parts_[part].pixels == 0) continue;
      const AuditEntry found = entry(part, std::size_t(layer));
      if (found.bias.known()) entries.push_back(found);
    }
  return entries;
}

bool is_biased(const AuditEntry& entry) {
  return std::abs(entry.share()) > kAuditLimit && std::abs(entry.bias.value) > kAuditErrors * entry.bias.error;
}

}  // namespace tempolux
