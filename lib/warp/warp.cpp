#include "lib/warp/warp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lib/core/parallel.h"
#include "lib/warp/masking.h"

namespace tempolux {
namespace {

/// Positions within a pixel that an edge is composed from: at first kParts, at most kMostParts where its surfaces differ much.
constexpr std::size_t kParts = 8, kMostParts = 64;

/// The first n points, n a power of two, of n rows and n columns, each met once (Hammersley's points), n = 8 to 64.
std::span<const RasterPoint> part_positions(std::size_t n) {
  static const auto all = [] {
    std::array<std::array<RasterPoint, kMostParts>, 4> sets{};
    for (std::size_t set = 0, count = kParts; set < sets.size(); ++set, count *= 2)
      for (std::size_t i = 0; i < count; ++i) {
        std::size_t mirrored = 0;   // the bits of i from the last to the first
        for (std::size_t bit = 1; bit < count; bit *= 2) mirrored = 2 * mirrored + ((i & bit) != 0);
        sets[set][i] = {(double(i) + 0.5) / double(count), (double(mirrored) + 0.5) / double(count)};
      }
    return sets;
  }();
  std::size_t set = 0;
  while (kParts << set < n) ++set;
  return std::span(all[set]).first(kParts << set);
}

constexpr std::size_t kMostChannels = 64;

/// a += w (b - c), over a stride, which is a multiple of 8. Sums are written so: equal colours give their bits, whatever the weights.
void add_difference(float* a, float w, const float* b, const float* c, std::size_t stride) {
  for (std::size_t i = 0; i < stride; i += 8)
    for (std::size_t j = 0; j < 8; ++j) a[i + j] += w * (b[i + j] - c[i + j]);
}

/// The weighted mean of a key's pixels.
void mean_of(const KeyFrame& key, const Taps& taps, std::size_t stride, float* mean) {
  const float* first = key.colour(taps.pixel[0]);
  std::copy_n(first, stride, mean);
  for (int t = 1; t < taps.count; ++t)
    add_difference(mean, taps.weight[std::size_t(t)], key.colour(taps.pixel[std::size_t(t)]), first, stride);
}

/// What the keys give for one pixel.
struct Pixel {
  alignas(32) std::array<float, kMostChannels> colour;                    ///< composed
  alignas(32) std::array<std::array<float, kMostChannels>, 2> of_key;     ///< by each key alone
  alignas(32) std::array<float, kMostChannels> square;                    ///< of several positions: mean square of what they show
  std::array<int, 2> parts{};                                 ///< how many positions it has given
  std::array<LookUp, 2> failed{LookUp::found, LookUp::found};
  bool missing = false;                                       ///< a position that no key gives
  bool undersampled = false, resampled = false;
};

class Compositor {
 public:
  Compositor(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options)
      : target_(target), keys_(keys), options_(options), stride_(keys[0].view->key().stride()) {
    for (std::size_t k = 0; k < keys.size(); ++k) {
      // Nearness in time, linear between two keys: each counts by how far away the other one is.
      const double other = keys.size() < 2 ? 1 : keys[1 - k].frames_away, sum = keys.size() < 2 ? 1 : both_away();
      nearness_[k] = float(sum > 0 ? other / sum : 0.5);
      stays_[k] = !keys[k].cut_off && keys[k].view->same_camera();
    }
  }

  void pixel(std::size_t p, std::span<const FacePoint> parts, std::span<const RasterPoint> at, Pixel& pixel) const {
    start(pixel);
    if (take_what_stands(p, pixel)) return;
    pixel.resampled = true;
    for (std::size_t i = 0; i < parts.size(); ++i) add_part(parts[i], at[i], pixel);
    if (parts.size() == 1) return;
    for (std::size_t c = 0; c < stride_; ++c) {
      pixel.colour[c] /= float(parts.size());
      pixel.square[c] /= float(parts.size());
    }
    for (std::size_t k = 0; k < keys_.size(); ++k)
      for (std::size_t c = 0; c < stride_ && pixel.parts[k] > 1; ++c) pixel.of_key[k][c] /= float(pixel.parts[k]);
  }

 private:
  double both_away() const { return keys_[0].frames_away + keys_[1].frames_away; }

  void start(Pixel& pixel) const {
    std::fill_n(pixel.colour.begin(), stride_, 0.0f);
    std::fill_n(pixel.square.begin(), stride_, 0.0f);
    for (std::size_t k = 0; k < keys_.size(); ++k) std::fill_n(pixel.of_key[k].begin(), stride_, 0.0f);
    pixel.parts = {};
    pixel.failed = {LookUp::found, LookUp::found};
    pixel.missing = pixel.undersampled = pixel.resampled = false;
  }

  /// A pixel around which key and target show the same at the same place is the key's to the bit, edges and all.
  bool stands(std::size_t p, const KeyView& view) const {
    const SeenSurfaces &here = *target_.seen, &there = view.key().seen();
    const int x = int(p % std::size_t(here.width)), y = int(p / std::size_t(here.width));
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, here.height - 1); ++ny)
      for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, here.width - 1); ++nx) {
        const std::size_t q = std::size_t(ny) * std::size_t(here.width) + std::size_t(nx);
        const std::uint32_t object = here.object_at(q);
        if (!view.sees_the_same(object) || there.object_at(q) != object) return false;
        const float z = here.depth[q], other = there.depth[q];
        if (z != other && !(std::abs(z - other) <= 1e-4f * z)) return false;
      }
    return true;
  }

  bool take_what_stands(std::size_t p, Pixel& pixel) const {
    int standing = 0;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      if (!stays_[k] || !stands(p, *keys_[k].view)) continue;
      const float* colour = keys_[k].view->key().colour(p);
      std::copy_n(colour, stride_, pixel.of_key[k].begin());
      pixel.parts[k] = 1;
      // a + w (b - a): equal keys give their bits.
      for (std::size_t c = 0; c < stride_; ++c)
        pixel.colour[c] = standing == 0 ? colour[c] : pixel.colour[c] + nearness_[k] * (colour[c] - pixel.colour[c]);
      ++standing;
    }
    return standing > 0;
  }

  void add_part(const FacePoint& point, RasterPoint at, Pixel& pixel) const {
    const FrameCamera& camera = *target_.camera;
    KeyView::Wanted wanted{point.depth < INFINITY ? camera.unproject(at, double(point.depth)) : camera.direction(at), point};
    if (point.depth < INFINITY) {
      const bool known = length2(point.normal) > 0;
      wanted.area = camera.area_of_pixel(
          wanted.at, known ? camera.camera_from_world().direction(Vec3d(point.normal)) : Vec3d{0, 0, 1});
    }
    std::array<Taps, 2> taps;
    std::array<float, 2> weight{}, magnified{};
    bool sharp = false;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      const LookUp found = keys_[k].cut_off ? LookUp::outside : keys_[k].view->find(wanted, taps[k], magnified[k]);
      if (found != LookUp::found) {
        pixel.failed[k] = std::max(pixel.failed[k], found);
        continue;
      }
      weight[k] = std::max(nearness_[k], 1e-6f) / std::clamp(magnified[k], 1.0f, 64.0f);
      sharp |= double(magnified[k]) <= options_.most_magnified;
    }
    const float sum = weight[0] + weight[1];
    if (!(sum > 0)) {
      pixel.missing = true;
      return;
    }
    pixel.undersampled |= !sharp;
    alignas(32) std::array<std::array<float, kMostChannels>, 2> here;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      if (!(weight[k] > 0)) continue;
      ++pixel.parts[k];
      mean_of(keys_[k].view->key(), taps[k], stride_, here[k].data());
      add(here[k].data(), pixel.of_key[k].data());
    }
    const std::size_t first = weight[0] > 0 ? 0 : 1;
    if (weight[0] > 0 && weight[1] > 0) add_difference(here[0].data(), weight[1] / sum, here[1].data(), here[0].data(), stride_);
    add(here[first].data(), pixel.colour.data());
    for (std::size_t c = 0; c < stride_; ++c) pixel.square[c] += here[first][c] * here[first][c];
  }

  void add(const float* colour, float* sum) const {
    for (std::size_t i = 0; i < stride_; i += 8)
      for (std::size_t j = 0; j < 8; ++j) sum[i + j] += colour[i + j];
  }

  const WarpTarget& target_;
  std::span<const WarpKey> keys_;
  const WarpOptions& options_;
  std::size_t stride_;
  std::array<float, 2> nearness_{};
  std::array<bool, 2> stays_{};
};

std::uint32_t why_missing(const Pixel& pixel) {
  switch (std::max(pixel.failed[0], pixel.failed[1])) {
    case LookUp::edge:
      return formats::why_edge;
    case LookUp::deforming:
      return formats::why_deforming;
    case LookUp::hidden:
      return formats::why_occlusion;
    default:
      return formats::why_border;
  }
}

/// RGB as the float32 sum of the layers, in their order, where all of them are there; see frames.md 2.
class LayerSum {
 public:
  explicit LayerSum(const std::vector<std::string>& names) {
    const auto find = [&](const std::string& name) {
      const auto at = std::find(names.begin(), names.end(), name);
      return at == names.end() ? -1 : int(at - names.begin());
    };
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string channel(1, "RGB"[c]);
      total_[c] = find(channel);
      for (const char* layer : {"emission", "specular", "direct", "caustic", "indirect", "volume"})
        if (const int at = find(std::string(layer) + "." + channel); at >= 0) parts_[c].push_back(at);
    }
  }
  float of(const float* colour, std::size_t c) const {
    float sum = 0;
    for (const int part : parts_[c]) sum += colour[part];
    return sum;
  }
  /// Do the layers make up all of RGB in every pixel of the key?
  bool complete_in(const KeyFrame& key) const {
    if (parts_[0].size() < 2) return false;
    for (std::size_t p = 0; p < key.seen().pixel_count(); ++p)
      for (std::size_t c = 0; c < 3; ++c)
        if (of(key.colour(p), c) != key.colour(p)[total_[c]]) return false;
    return true;
  }
  void set(float* colour) const {
    for (std::size_t c = 0; c < 3; ++c) colour[total_[c]] = of(colour, c);
  }

 private:
  std::array<int, 3> total_{};
  std::array<std::vector<int>, 3> parts_;
};

}  // namespace

WarpedFrame warp(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options) {
  if (keys.empty() || keys.size() > 2) throw std::invalid_argument("warp: one or two keys");
  const std::vector<std::string>& names = keys[0].view->key().colour_names();
  if (keys.size() == 2 && keys[1].view->key().colour_names() != names)
    throw std::invalid_argument("warp: the keys have different colour channels");
  if (names.size() > kMostChannels) throw std::invalid_argument("warp: more than 64 colour channels");

  const std::size_t pixels = target.seen->pixel_count(), width = std::size_t(target.seen->width);
  const std::size_t stride = keys[0].view->key().stride();
  WarpedFrame frame{names, stride, std::vector<float>(pixels * stride), std::vector<std::uint32_t>(pixels), {}};
  if (options.separate) frame.candidates.assign(keys.size(), std::vector<float>(pixels * stride));
  const auto height = std::size_t(target.seen->height);
  const std::vector<std::uint8_t> whole = whole_pixels(*target.seen, *target.camera);
  const Compositor compositor(target, keys, options);
  const LayerSum layers(names);
  const bool summed = std::all_of(keys.begin(), keys.end(), [&](const WarpKey& k) { return layers.complete_in(k.view->key()); });
  const Masking masking(target, keys, options, names);
  std::array<std::vector<float>, 2> light;
  for (std::size_t k = 0; k < keys.size() && masking.light_may_differ(); ++k) light[k].resize(pixels);

  parallel_chunks(pixels, 4096, [&](std::size_t first, std::size_t last) {
    Pixel pixel, around;
    std::array<FacePoint, kMostParts> points;
    std::array<RasterPoint, kMostParts> at;
    const auto centre = [&](std::size_t i, std::size_t x, std::size_t y) {
      const std::size_t q = y * width + x;
      points[i] = {target.seen->depth[q], target.seen->object_at(q), target.seen->normal_at(q)};
      at[i] = {double(x) + 0.5, double(y) + 0.5};
    };
    const auto compose = [&](std::size_t p, std::size_t n, Pixel& to) { compositor.pixel(p, std::span(points).first(n), std::span(at).first(n), to); };
    for (std::size_t p = first; p < last; ++p) {
      const std::size_t x = p % width, y = p / width;
      const bool composed = !whole[p] && target.look;
      std::size_t count = 1, wanted = kParts;
      if (composed) {
        std::size_t n = 0;
        for (std::size_t ny = y - (y > 0); ny <= std::min(y + 1, height - 1); ++ny)
          for (std::size_t nx = x - (x > 0); nx <= std::min(x + 1, width - 1); ++nx) centre(n++, nx, ny);
        compose(p, n, around);
      } else {
        centre(0, x, y);
        compose(p, 1, pixel);
      }
      while (composed && wanted > count && count < kMostParts) {
        const std::span<const RasterPoint> positions = part_positions(std::min(wanted, kMostParts));
        count = positions.size();
        for (std::size_t i = 0; i < count; ++i) at[i] = {double(x) + positions[i].x, double(y) + positions[i].y};
        target.look(std::span(at).first(count), points.data());
        compose(p, count, pixel);
        if (pixel.missing || !pixel.resampled) break;
        wanted = masking.edge_positions({pixel.colour.data(), pixel.square.data()}, count, {around.colour.data(), around.square.data()});
      }
      const bool known = !composed || wanted <= count;
      if (summed) layers.set(pixel.colour.data());
      std::array<const float*, 2> given{};
      for (std::size_t k = 0; k < keys.size(); ++k)
        if (pixel.resampled ? pixel.parts[k] == int(count) : pixel.parts[k] > 0) given[k] = pixel.of_key[k].data();
      std::uint32_t why = 0;
      if (pixel.missing) why |= why_missing(pixel);
      if (pixel.undersampled) why |= formats::why_undersampled;
      if (pixel.resampled && !pixel.missing && !whole[p] && (!target.look || !known || !masking.edge_agrees(given[0], given[1]))) why |= formats::why_edge;
      if (pixel.resampled) why |= masking.of_moved_pixel(p, pixel.colour.data(), given[0], given[1]);
      frame.why[p] = why;
      std::copy_n(pixel.colour.begin(), stride, &frame.colour[p * stride]);
      for (std::size_t k = 0; k < keys.size(); ++k) {
        if (options.separate) std::copy_n(given[k] ? given[k] : pixel.colour.data(), stride, &frame.candidates[k][p * stride]);
        if (!light[k].empty()) light[k][p] = given[k] ? masking.luminance_of(given[k]) : -1;
      }
    }
  });
  if (masking.light_may_differ()) masking.mark_changed_light(light, frame.why);
  return frame;
}

}  // namespace tempolux
