#include "lib/warp/warp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lib/core/parallel.h"
#include "lib/image/channel_groups.h"
#include "lib/warp/compositor.h"
#include "lib/warp/masking.h"

namespace tempolux {
namespace {

/// Number of positions inside a pixel at an edge: kParts at first, and up to kMostParts if its surfaces differ much.
constexpr std::size_t kParts = 8, kMostParts = 64;

/// At least n positions, a power of two from 8 to 64, one in each of as many rows and columns: Hammersley's points.
std::span<const RasterPoint> part_positions(std::size_t n) {
  static const auto all = [] {
    std::array<std::array<RasterPoint, kMostParts>, 4> sets{};
    for (std::size_t set = 0, count = kParts; set < sets.size(); ++set, count *= 2)
      for (std::size_t i = 0; i < count; ++i) {
        std::size_t mirrored = 0;  // the bits of i in reverse order
        for (std::size_t bit = 1; bit < count; bit *= 2) mirrored = 2 * mirrored + ((i & bit) != 0);
        sets[set][i] = {(double(i) + 0.5) / double(count), (double(mirrored) + 0.5) / double(count)};
      }
    return sets;
  }();
  std::size_t set = 0;
  while (kParts << set < n) ++set;
  return std::span(all[set]).first(kParts << set);
}

std::uint32_t why_missing(const ComposedPixel& pixel) {
  switch (std::max(pixel.failed[0], pixel.failed[1])) {
    case LookUp::edge: return formats::why_edge;
    case LookUp::deforming: return formats::why_deforming;
    case LookUp::hidden: return formats::why_occlusion;
    default: return formats::why_border;
  }
}

/// Computes R, G and B as the float32 sum of the layers, in the order of kFrameLayers (frames.md 2).
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
      for (const char* layer : kFrameLayers)
        if (const int at = find(std::string(layer) + "." + channel); at >= 0) parts_[c].push_back(at);
    }
  }
  float of(const float* colour, std::size_t c) const {
    float sum = 0;
    for (const int part : parts_[c]) sum += colour[part];
    return sum;
  }
  /// True if the layers sum up to RGB in every pixel of the key.
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

/// Colours of consecutive pixels by pixel, before they are stored by channel.
struct Strip {
  std::array<std::array<float, kMostChannels>, WantedPoints::kMost> colour;
  std::array<std::array<std::array<float, kMostChannels>, WantedPoints::kMost>, 2> of_key;

  void keep(std::size_t i, const ComposedPixel& pixel, std::size_t channels) {
    std::copy_n(pixel.colour.begin(), channels, colour[i].begin());
    for (std::size_t k = 0; k < 2; ++k) std::copy_n(pixel.of_key[k].begin(), channels, of_key[k][i].begin());
  }
};

/// The state of warping one frame.
class Warping {
 public:
  Warping(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options, WarpedFrame& frame)
      : target_(target),
        keys_(keys),
        options_(options),
        frame_(frame),
        width_(std::size_t(target.seen->width)),
        height_(std::size_t(target.seen->height)),
        whole_(whole_pixels(*target.seen, *target.camera)),
        compositor_(target, keys, options),
        layers_(frame.names),
        masking_(target, keys, options, frame.names),
        edge_(target.seen->pixel_count()),
        centres_(target.seen->pixel_count()) {
    summed_ =
        std::all_of(keys.begin(), keys.end(), [&](const WarpKey& k) { return layers_.complete_in(k.view->key()); });
    for (auto& plane : gloss_)
      if (masking_.judges_gloss()) plane.resize(target.seen->pixel_count());
    for (std::size_t k = 0; k < keys.size() && masking_.light_may_differ(); ++k)
      light_[k].resize(target.seen->pixel_count());
  }

  void run() {
    parallel_chunks(centres_.size(), 4096, [&](std::size_t first, std::size_t last) {
      LookedUp points;
      ComposedPixel pixel{};
      Strip strip;
      for (std::size_t p = first; p < last; p += WantedPoints::kMost)
        centres(p, std::min(p + WantedPoints::kMost, last), points, pixel, strip);
    });
    if (target_.look)
      parallel_chunks(centres_.size(), 4096, [&](std::size_t first, std::size_t last) {
        LookedUp points;
        ComposedPixel pixel{};
        for (std::size_t p = first; p < last; ++p)
          if (edge_[p]) edge(p, points, pixel);
      });
    if (masking_.light_may_differ()) masking_.mark_changed_light(light_, frame_.why);
    if (masking_.judges_gloss()) masking_.mark_seen_gloss(frame_.colour, std::move(gloss_), frame_.why);
  }

 private:
  /// Composes pixels from their centres. Pixels without an edge are then finished.
  void centres(std::size_t first, std::size_t last, LookedUp& points, ComposedPixel& pixel, Strip& strip) {
    const SeenSurfaces& seen = *target_.seen;
    points.wanted.count = last - first;
    for (std::size_t p = first; p < last; ++p) {
      points.wanted.at[p - first] = {double(p % width_) + 0.5, double(p / width_) + 0.5};
      points.wanted.face[p - first] = {seen.depth[p], seen.object_at(p), seen.normal_at(p)};
    }
    compositor_.look_up(points);
    for (std::size_t p = first; p < last; ++p) {
      compositor_.centre(p, points, p - first, pixel);
      masking_.note_light(pixel.colour.data(), centres_[p]);
      edge_[p] = !whole_[p] && target_.look && pixel.resampled;
      if (!edge_[p]) judge(p, pixel, 1, whole_[p] != 0);
      strip.keep(p - first, pixel, frame_.names.size());
    }
    for (std::size_t c = 0; c < frame_.names.size(); ++c) {
      for (std::size_t i = 0; i < last - first; ++i) frame_.colour[c][first + i] = strip.colour[i][c];
      for (std::size_t k = 0; k < keys_.size() && options_.separate; ++k)
        for (std::size_t i = 0; i < last - first; ++i) frame_.candidates[k][c][first + i] = strip.of_key[k][i][c];
    }
  }

  /// Composes a pixel with an edge from several positions; the more its surfaces differ, the more positions.
  void edge(std::size_t p, LookedUp& points, ComposedPixel& pixel) {
    const std::size_t x = p % width_, y = p / width_;
    const Masking::Spread around = spread_around(x, y);
    std::size_t wanted = kParts, count = 0;
    do {
      const std::span<const RasterPoint> positions = part_positions(std::min(wanted, kMostParts));
      points.wanted.count = count = positions.size();
      for (std::size_t i = 0; i < count; ++i)
        points.wanted.at[i] = {double(x) + positions[i].x, double(y) + positions[i].y};
      target_.look(std::span(points.wanted.at).first(count), points.wanted.face.data());
      compositor_.look_up(points);
      compositor_.mean(p, points, pixel);
      if (pixel.missing) break;
      wanted = masking_.edge_positions(masking_.spread(pixel.colour.data(), pixel.square.data()), count, around);
    } while (wanted > count && count < kMostParts);
    judge(p, pixel, int(count), wanted <= count);
    for (std::size_t c = 0; c < frame_.names.size(); ++c) {
      frame_.colour[c][p] = pixel.colour[c];
      for (std::size_t k = 0; k < keys_.size() && options_.separate; ++k)
        frame_.candidates[k][c][p] = pixel.of_key[k][c];
    }
  }

  /// Mean and mean square of the colours at the centres of the 3 x 3 pixels around.
  Masking::Spread spread_around(std::size_t x, std::size_t y) const {
    Masking::Spread spread;
    float n = 0;
    for (std::size_t ny = y - (y > 0); ny <= std::min(y + 1, height_ - 1); ++ny)
      for (std::size_t nx = x - (x > 0); nx <= std::min(x + 1, width_ - 1); ++nx, ++n)
        for (std::size_t c = 0; c < 3; ++c) {
          const float value = centres_[ny * width_ + nx][c];
          spread.mean[c] += value;
          spread.square[c] += value * value;
        }
    for (std::size_t c = 0; c < 3; ++c) {
      spread.mean[c] /= n;
      spread.square[c] /= n;
    }
    return spread;
  }

  /// Decides whether the pixel is masked, and why; sums its layers; stores what the decisions about light and gloss
  /// need. `count`: number of positions; `known`: true if these are enough. The candidate of a key that does not show
  /// the whole pixel becomes the composed colour.
  void judge(std::size_t p, ComposedPixel& pixel, int count, bool known) {
    if (summed_) layers_.set(pixel.colour.data());
    std::array<const float*, 2> given{};
    for (std::size_t k = 0; k < keys_.size(); ++k)
      if (pixel.resampled ? pixel.parts[k] == count : pixel.parts[k] > 0) given[k] = pixel.of_key[k].data();
    std::uint32_t why = 0;
    if (pixel.missing) why |= why_missing(pixel);
    if (pixel.undersampled) why |= formats::why_undersampled;
    if (pixel.resampled && !pixel.missing && !whole_[p] && (!known || !masking_.edge_agrees(given[0], given[1])))
      why |= formats::why_edge;
    if (pixel.resampled) why |= masking_.of_moved_pixel(p, pixel.colour.data(), given[0], given[1]);
    frame_.why[p] = why;
    if (masking_.judges_gloss() && pixel.resampled && given[0] && given[1]) {
      std::array<float, 3> error{};
      masking_.note_gloss(given[0], given[1], error);
      for (std::size_t c = 0; c < 3; ++c) gloss_[c][p] = error[c];
    }
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      if (!light_[k].empty()) light_[k][p] = given[k] ? masking_.luminance_of(given[k]) : -1;
      if (options_.separate && (!given[k] || !pixel.resampled)) pixel.of_key[k] = pixel.colour;
    }
  }

  const WarpTarget& target_;
  std::span<const WarpKey> keys_;
  const WarpOptions& options_;
  WarpedFrame& frame_;
  std::size_t width_, height_;
  std::vector<std::uint8_t> whole_;
  Compositor compositor_;
  LayerSum layers_;
  Masking masking_;
  bool summed_ = false;
  std::vector<std::uint8_t> edge_;             ///< 1: composed from several positions
  std::vector<std::array<float, 3>> centres_;  ///< R, G, B at each pixel's centre
  std::array<std::vector<float>, 3> gloss_;    ///< GlossInDoubt::error
  std::array<std::vector<float>, 2> light_;    ///< by key; see Masking::mark_changed_light
};

}  // namespace

WarpedFrame warp(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options) {
  if (keys.empty() || keys.size() > 2) throw std::invalid_argument("warp: one or two keys");
  const std::vector<std::string>& names = keys[0].view->key().colour_names();
  if (keys.size() == 2 && keys[1].view->key().colour_names() != names)
    throw std::invalid_argument("warp: the keys have different colour channels");

  const std::size_t pixels = target.seen->pixel_count();
  WarpedFrame frame{names, {}, std::vector<std::uint32_t>(pixels), {}};
  frame.colour.assign(names.size(), std::vector<float>(pixels));
  if (options.separate) frame.candidates.assign(keys.size(), frame.colour);
  Warping(target, keys, options, frame).run();
  return frame;
}

}  // namespace tempolux
