#include "lib/render/audit.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/octahedral.h"
#include "lib/core/parallel.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr int kTilesAcross = 4;
constexpr std::array<Layer, 3> kAudited{Layer::direct, Layer::caustic, Layer::indirect};
constexpr std::size_t kFewestPaths = 64;     ///< that found light: of fewer no standard error is said
constexpr std::uint32_t kFewestSplats = 32;  ///< likewise
constexpr double kMostOfOne = 0.5;           ///< of the sum of squares: beyond that one path decides, and the error is not known

double light_of(const Layers& pixel) {
  double sum = 0;
  for (const Rgb& radiance : pixel.value) sum += channel_mean(Rgbd(radiance));
  return sum;
}

/// Both estimates joined by inverse variance; the one that is known if there is one only.
Estimate joined(const Estimate& a, const Estimate& b) {
  if (!a.known()) return b;
  if (!b.known()) return a;
  const double va = a.error * a.error, vb = b.error * b.error;
  if (!(va + vb > 0)) return a;
  return {(a.value * vb + b.value * va) / (va + vb), std::sqrt(va * vb / (va + vb))};
}

}  // namespace

FrameAudit::FrameAudit(const CameraView& view, const RenderedFrame& frame, std::span<const std::uint32_t> objects, std::span<const std::uint8_t> mask)
    : view_(view), frame_(frame), mask_(mask), object_part_(objects.size()), splats_(objects.size()) {
  parts_.push_back({"picture"});
  for (int j = 0; j < kTilesAcross; ++j)
    for (int i = 0; i < kTilesAcross; ++i) parts_.push_back({"tile " + std::to_string(i + 1) + " " + std::to_string(j + 1)});
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

/// body(part) for the picture, the tile and the object that the pixel belongs to.
template <class Body>
void FrameAudit::for_parts_of(std::size_t pixel, const Body& body) const {
  const auto width = std::size_t(view_.width()), height = std::size_t(view_.height());
  const std::size_t i = pixel % width * kTilesAcross / width, j = pixel / width * kTilesAcross / height;
  body(std::size_t(0));
  body(1 + j * kTilesAcross + i);
  body(std::size_t(object_part_[pixel]));
}

/// What splats scatter by. The groups of a map are no samples of it: each is a box of the space of starting paths, so their means differ by far more than the map errs.
/// But within a group paths follow each other, and a run of photons whose bounce does not fall holds all photons of one or more whole paths
/// (photon-trace: of 64). Runs of a group that follow each other have equal means, so the square of the difference of two has the variance of their sum.
/// A group's last run may have fewer paths and is left out; so is one without a partner. The sum of squares is scaled by photons.
class FrameAudit::PairedRuns {
 public:
  explicit PairedRuns(FrameAudit& audit) : audit_(audit) {}
  void next(std::uint32_t group, std::uint8_t bounce) {
    if (started_ && group != group_) drop();
    else if (started_ && bounce < bounce_) keep();
    started_ = true;
    group_ = group;
    bounce_ = bounce;
    ++run_photons_;
  }
  void add(std::size_t part, std::size_t layer, double radiance) { run_.push_back({part, layer, radiance}); }

 private:
  struct Seen {
    std::size_t part, layer;
    double radiance;
  };
  /// Another run of the group follows, so this one is whole.
  void keep() {
    for (const Seen& seen : run_) {
      audit_.sums_[seen.part].difference[seen.layer] += second_ ? -seen.radiance : seen.radiance;
      pair_.push_back(seen);
    }
    pair_photons_ += run_photons_;
    run_.clear();
    run_photons_ = 0;
    if (second_) {
      for (const Seen& seen : pair_) {
        double& difference = audit_.sums_[seen.part].difference[seen.layer];
        audit_.sums_[seen.part].pairs_square[seen.layer] += difference * difference;
        difference = 0;   // so that it counts once
      }
      audit_.paired_photons_ += double(pair_photons_);
      pair_.clear();
      pair_photons_ = 0;
    }
    second_ = !second_;
  }
  void drop() {
    for (const Seen& seen : pair_) audit_.sums_[seen.part].difference[seen.layer] = 0;
    pair_.clear();
    run_.clear();
    run_photons_ = pair_photons_ = 0;
    second_ = false;
  }

  FrameAudit& audit_;
  std::vector<Seen> run_, pair_;
  std::uint64_t run_photons_ = 0, pair_photons_ = 0;
  std::uint32_t group_ = 0;
  std::uint8_t bounce_ = 0;
  bool started_ = false, second_ = false;
};

void FrameAudit::add_splats(const Tracer& tracer, const AuditPhotons& photons) {
  const PhotonSplats camera(tracer, view_);
  holds_ = photons.holds;
  PairedRuns runs(*this);
  std::vector<std::optional<Splat>> seen;
  photons.for_each_block([&](const formats::PhotonBlock& block, Vec3d shift) {
    seen.assign(block.photons.size(), std::nullopt);
    const bool directed = !block.directions.empty();
    parallel_chunks(seen.size(), 1024, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        std::optional<Vec3> wi;
        if (directed) {
          const std::array<float, 3> decoded = formats::decode_normal(block.directions[i]);
          wi = Vec3{decoded[0], decoded[1], decoded[2]};
        }
        seen[i] = camera.splat(block.photons[i], shift, wi);
      }
    });
    photons_ += double(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      runs.next(block.group, block.photons[i].bounce);
      const std::optional<Splat>& splat = seen[i];
      if (!splat || (!mask_.empty() && !mask_[splat->pixel])) continue;
      splats_[splat->pixel][splat->layer] += splat->radiance;
      splats_[splat->pixel].coverage = 1;
      const double radiance = channel_mean(Rgbd(splat->radiance));
      const auto layer = std::size_t(splat->layer);
      for_parts_of(splat->pixel, [&](std::size_t part) {
        sums_[part].splats[layer] += radiance;
        ++sums_[part].splat_count[layer];
        // A path has one photon of kind direct at most, so these are independent of each other.
        if (splat->layer == Layer::direct) sums_[part].pairs_square[layer] += radiance * radiance;
        else runs.add(part, layer, radiance);
      });
    }
  });
}

void FrameAudit::add_paths(const RenderScene& scene, const FrameOptions& options, std::size_t count) {
  const std::size_t pixels = splats_.size();
  struct Difference {
    std::size_t pixel = 0;
    bool counts = false;
    std::array<double, kLayerCount> layer{};
    std::array<bool, kLayerCount> met{};
  };
  std::vector<Difference> differences(count);
  const std::uint64_t seed = mix64(options.seed ^ 0x6175646974ull);
  parallel_chunks(count, 64, [&](std::size_t first, std::size_t last) {
    RayCounts rays;
    for (std::size_t i = first; i < last; ++i) {
      Difference& difference = differences[i];
      const PixelRandom random(seed, i, 0);
      // One pixel of each of `count` runs of them, row by row.
      const Vec2 jitter = random.get2(0, Purpose::pixel), within = PathRandom(seed ^ 1, i).get2(0, Purpose::pixel);
      difference.pixel = std::min(pixels - 1, std::size_t((double(i) + double(within.x)) * double(pixels) / double(count)));
      if (!mask_.empty() && !mask_[difference.pixel]) continue;
      const auto width = std::size_t(view_.width());
      const Ray ray = view_.ray(float(difference.pixel % width) + jitter.x, float(difference.pixel / width) + jitter.y);
      Hit hit;
      scene.tracer.intersect(ray, hit);
      const Layers shown = trace_eye_path(scene, ray, hit, random, options.known, rays, view_.cone(), effort_of(0)).sum();
      const Layers found = trace_eye_path(scene, ray, hit, random, nullptr, rays, view_.cone(), effort_of(0)).sum();
      difference.counts = true;
      for (std::size_t l = 0; l < kLayerCount; ++l) difference.met[l] = !is_black(found.value[l]);
      for (std::size_t l = 0; l < kLayerCount; ++l) difference.layer[l] = channel_mean(Rgbd(shown.value[l])) - channel_mean(Rgbd(found.value[l]));
    }
  });
  for (const Difference& difference : differences) {
    if (!difference.counts) continue;
    for_parts_of(difference.pixel, [&](std::size_t part) {
      Sums& sums = sums_[part];
      ++sums.path_count;
      for (std::size_t l = 0; l < kLayerCount; ++l) {
        const double d = difference.layer[l];
        sums.paths[l] += d;
        sums.met[l] += difference.met[l];
        sums.paths_square[l] += d * d;
        sums.paths_largest[l] = std::max(sums.paths_largest[l], d * d);
      }
    });
  }
}

AuditEntry FrameAudit::entry(std::size_t part, std::size_t layer) const {
  const Sums& sums = sums_[part];
  const double n = double(parts_[part].pixels);
  AuditEntry entry{.layer = Layer(layer), .part = parts_[part].name, .object = parts_[part].object, .pixels = parts_[part].pixels, .shown = sums.shown[layer] / n,
                   .splats = {}, .paths = {}, .bias = {}, .picture = picture_ / n};
  Estimate by_splats;
  const bool of_direct = Layer(layer) == Layer::direct;
  if (holds_[layer] && sums.splat_count[layer] >= kFewestSplats && (of_direct || paired_photons_ > 0)) {
    entry.splats = {sums.splats[layer] / n, std::sqrt(sums.pairs_square[layer] * (of_direct ? 1 : photons_ / paired_photons_)) / n};
    const double noise = frame_.noise.known() ? std::max(0.0, frame_.noise.layer[layer].linear) : 0;
    by_splats = {entry.shown - entry.splats.value, std::sqrt(entry.splats.error * entry.splats.error + noise * noise / n)};
  }
  const double m = double(sums.path_count);
  if (sums.met[layer] >= kFewestPaths && sums.paths_largest[layer] <= kMostOfOne * sums.paths_square[layer])
    entry.paths = {sums.paths[layer] / m, std::sqrt(std::max(0.0, sums.paths_square[layer] / m - sums.paths[layer] * sums.paths[layer] / (m * m)) / (m - 1))};
  entry.bias = joined(by_splats, entry.paths);
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
