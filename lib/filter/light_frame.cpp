#include "lib/filter/light_frame.h"

#include <algorithm>
#include <cmath>

#include "lib/filter/coverage.h"
#include "lib/filter/rows.h"
#include "lib/filter/surface_weight.h"
#include "lib/image/channel_groups.h"

namespace tempolux {
namespace {

constexpr int kNear = 2;             ///< means are of 5 x 5 pixels
/// Beside kFilteredLayers. R, G and B stand for them where a frame has none.
constexpr std::array<const char*, 11> kReadGroups{"R", "G", "B", "albedo", "Z", "N", "id", "motion", "coverage", "samples", "variance"};
constexpr float kDarkest = 0.01f;    ///< albedo is taken to be at least this: what is nearly black has nearly no light to filter

bool has_rgb(const Image& image, const std::string& layer) {
  const Channel* red = image.find(layer.empty() ? "R" : layer + ".R");
  return red && !red->values.empty();
}

/// Brings the frame's light to one number that its noise is told by.
class Preparation {
 public:
  /// spare: the image, if its samples may be freed; else nullptr.
  Preparation(const Image& image, Image* spare, std::span<const char* const> wanted, LightFrame& frame) : wanted_(wanted), image_(image), spare_(spare), frame_(frame), width_(std::size_t(frame.width)) {}

  void take_surfaces() {
    const auto take_if_there = [&](const char* name, Plane& plane) {
      const Channel* channel = image_.find(name);
      const bool there = channel && !channel->values.empty();
      plane = there ? unset() : cleared();
      if (there) plane.take(channel->values, image_.width);
      free(channel);
    };
    take_if_there("N.X", frame_.nx);
    take_if_there("N.Y", frame_.ny);
    take_if_there("N.Z", frame_.nz);
    frame_.object = PlaneT<std::uint32_t>(frame_.width, frame_.height);
    if (const Channel* ids = image_.find("id.object"); ids && !ids->ids.empty()) frame_.object.take(ids->ids, image_.width);
    take_depth();
    const Coverage coverage(image_);
    frame_.use = unset();
    frame_.inside = unset();
    for_each_strip([&](int y, std::size_t x0, std::size_t count) {
      Lane inside;
      one_surface_around(y, x0, count, inside);
      for (std::size_t i = 0; i < count; ++i) {
        const bool whole = coverage.known() ? coverage.is_whole(int(x0 + i), y) : inside[i] != 0;
        frame_.use.row(y)[x0 + i] = whole ? 1.0f : 0.0f;
        frame_.inside.row(y)[x0 + i] = whole ? inside[i] : 0.0f;
      }
    });
  }

  /// w and its slopes, as PixelSurfaces has them.
  void take_depth() {
    const Channel* z = image_.find("Z");
    const bool there = z && !z->values.empty();
    for (Plane* plane : {&frame_.w, &frame_.w_right, &frame_.w_down}) *plane = there ? unset() : cleared();
    if (!there) return;
    for_each_row(frame_.height, [&](int y) {
      float* w = frame_.w.row(y);
      const float* depth = z->values.data() + std::size_t(y) * width_;
      for (std::size_t x = 0; x < width_; ++x) w[x] = PixelSurfaces::inverse_depth(depth[x]);
    });
    free(z);
    for_each_row(frame_.height, [&](int y) {
      const float *w = frame_.w.row(y), *above = frame_.w.row(y - 1), *below = frame_.w.row(y + 1);
      const std::uint32_t *object = frame_.object.row(y), *object_above = frame_.object.row(y - 1), *object_below = frame_.object.row(y + 1);
      float *right = frame_.w_right.row(y), *down = frame_.w_down.row(y);
      for (int x = 0; x < frame_.width; ++x) {
        const bool before = x > 0 && object[x - 1] == object[x], after = x + 1 < frame_.width && object[x + 1] == object[x];
        right[x] = PixelSurfaces::smaller(w[x] - w[x - 1], before, w[x + 1] - w[x], after);
        const bool upper = y > 0 && object_above[x] == object[x], lower = y + 1 < frame_.height && object_below[x] == object[x];
        down[x] = PixelSurfaces::smaller(w[x] - above[x], upper, below[x] - w[x], lower);
      }
    });
  }

  void take_light() {
    for (const char* layer : wanted_)
      if (has_rgb(image_, layer)) frame_.layers.push_back(layer);
    if (frame_.layers.empty()) frame_.layers.push_back("");
    const bool albedo = has_rgb(image_, "albedo");
    if (albedo) take("albedo", frame_.albedo);
    frame_.light.resize(frame_.layers.size());
    for (Plane& plane : sum_) plane = cleared();
    for (std::size_t l = 0; l < frame_.layers.size(); ++l)
      if (!is_black(frame_.layers[l])) take(frame_.layers[l], frame_.light[l]);
    for_each_row(frame_.height, [&](int y) {
      float* use = frame_.use.row(y);
      for (std::size_t c = 0; c < 3; ++c) {
        float *sum = sum_[c].row(y), *rho = albedo ? frame_.albedo[c].row(y) : nullptr;
        if (rho)
          for (std::size_t x = 0; x < width_; ++x) rho[x] = rho[x] >= kDarkest && rho[x] < kLargestLight ? rho[x] : kDarkest;
        for (ColourPlane& planes : frame_.light) {
          if (planes[c].empty()) continue;
          float* light = planes[c].row(y);
          for (std::size_t x = 0; x < width_; ++x) {
            if (rho) light[x] /= rho[x];
            if (!(std::abs(light[x]) < kLargestLight)) light[x] = use[x] = 0;
            sum[x] += light[x];
          }
        }
      }
    });
  }

  void take_noise() {
    frame_.variance = cleared();
    const bool diffuse = !frame_.layers[0].empty() && has_rgb(image_, "diffuse.variance");
    const bool told = diffuse || has_rgb(image_, "variance");
    const Channel* samples = image_.find("samples");
    if (samples && samples->values.empty()) samples = nullptr;
    frame_.noise = told ? NoiseKnowledge::told : samples ? NoiseKnowledge::estimated : NoiseKnowledge::none;
    if (frame_.noise == NoiseKnowledge::none) return;
    std::array<const std::vector<float>*, 3> variance{};
    if (told) variance = image_.rgb(diffuse ? "diffuse.variance" : "variance");
    if (!told || samples) estimate_variance();
    for_each_row(frame_.height, [&](int y) {
      float* to = frame_.variance.row(y);
      const std::size_t row = std::size_t(y) * width_;
      // A variance channel without `samples` is believed everywhere.
      for (std::size_t x = 0; told && x < width_; ++x)
        if (!samples || samples->values[row + x] >= 2) to[x] = told_variance(variance, int(x), y);
    });
  }

  /// Means over the window, of the sum of the layers and of the variance; a pixel's variance becomes the window's.
  void take_means() {
    for (Plane& plane : frame_.mean) plane = unset();
    frame_.mean_variance = unset();
    Plane smooth = unset();
    const std::array<const Plane*, 4> from{&sum_[0], &sum_[1], &sum_[2], &frame_.variance};
    const std::array<Plane*, 4> to{&frame_.mean[0], &frame_.mean[1], &frame_.mean[2], &smooth};
    for_each_strip([&](int y, std::size_t x0, std::size_t count) {
      Lane total{}, weight;
      std::array<Lane, 4> sums{};
      for (int dy = -kNear; dy <= kNear; ++dy)
        for (int dx = -kNear; dx <= kNear; ++dx) {
          SurfaceRow(frame_, y, dx, dy).weigh(x0, count, weight);
          for (std::size_t i = 0; i < count; ++i) total[i] += weight[i];
          for (std::size_t v = 0; v < from.size(); ++v) {
            const float* values = from[v]->row(y + dy) + x0 + dx;
            for (std::size_t i = 0; i < count; ++i) sums[v][i] += weight[i] * values[i];
          }
        }
      for (std::size_t v = 0; v < from.size(); ++v) {
        const float* own = from[v]->row(y) + x0;
        float* mean = to[v]->row(y) + x0;
        // Without any pixel of use the own one stands alone.
        for (std::size_t i = 0; i < count; ++i) mean[i] = total[i] > 0 ? sums[v][i] / total[i] : own[i];
      }
      const float* variance = smooth.row(y) + x0;
      float* mean_variance = frame_.mean_variance.row(y) + x0;
      for (std::size_t i = 0; i < count; ++i) mean_variance[i] = variance[i] / std::max(total[i], 1.0f);
    });
    frame_.variance = std::move(smooth);
  }

 private:
  Plane unset() const { return Plane::unset(frame_.width, frame_.height); }
  Plane cleared() const { return Plane(frame_.width, frame_.height); }
  void free(const Channel* channel) {
    if (Channel* mine = channel && spare_ ? spare_->find(channel->name) : nullptr) *mine = {mine->name, {}, {}};
  }
  void take(const std::string& layer, ColourPlane& planes) {
    const auto samples = image_.rgb(layer);
    for (std::size_t c = 0; c < 3; ++c) {
      planes[c] = unset();
      planes[c].take(*samples[c], image_.width);
    }
    for (const char* c : {"R", "G", "B"}) free(image_.find(layer.empty() ? c : layer + "." + c));
  }

  bool is_black(const std::string& layer) const {
    for (const std::vector<float>* samples : image_.rgb(layer))
      if (std::any_of(samples->begin(), samples->end(), [](float v) { return v != 0; })) return false;
    return true;
  }

  float told_variance(const std::array<const std::vector<float>*, 3>& variance, int x, int y) const {
    const std::size_t p = std::size_t(y) * width_ + std::size_t(x);
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float rho = frame_.albedo[c].empty() ? 1 : frame_.albedo[c].at(x, y), v = (*variance[c])[p] / (rho * rho);
      if (v > 0) sum += std::min(v, kLargestLight * kLargestLight);
    }
    return sum;
  }

  /// inside[i]: 1 if pixel x0 + i and those around it in the picture are on one surface, both ways asked (PixelSurfaces::edges), else 0.
  void one_surface_around(int y, std::size_t x0, std::size_t count, Lane& inside) const {
    inside.fill(1);
    for (int dy = std::max(-1, -y); dy <= std::min(1, frame_.height - 1 - y); ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0) continue;
        const SurfaceRow there(frame_, y, dx, dy), back(frame_, y + dy, -dx, -dy);
        // Columns beyond the picture do not count.
        const std::size_t first = x0 == 0 && dx < 0 ? 1 : 0, last = x0 + count == width_ && dx > 0 ? count - 1 : count;
        for (std::size_t i = first; i < last; ++i)
          inside[i] *= there.surface(x0 + i) * back.surface(std::size_t(std::ptrdiff_t(x0 + i) + dx));
      }
  }

  /// body(y, x0, count) for strips of rows, in parallel.
  template <class Body>
  void for_each_strip(const Body& body) const {
    for_each_row(frame_.height, [&](int y) {
      for (std::size_t x0 = 0; x0 < width_; x0 += kStrip) body(y, x0, std::min(kStrip, width_ - x0));
    });
  }

  /// Half the square of the difference to the four pixels beside, above and below on the surface: with noise alone its mean is the
  /// variance, and smooth light adds little to it.
  void estimate_variance() {
    for_each_strip([&](int y, std::size_t x0, std::size_t count) {
      Lane total{}, sum{}, weight;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}}) {
        SurfaceRow(frame_, y, dx, dy).weigh(x0, count, weight);
        const float* use = frame_.use.row(y) + x0;
        for (std::size_t i = 0; i < count; ++i) weight[i] *= use[i];
        for (std::size_t i = 0; i < count; ++i) total[i] += weight[i];
        for (const Plane& plane : sum_) {
          const float *own = plane.row(y) + x0, *other = plane.row(y + dy) + x0 + dx;
          for (std::size_t i = 0; i < count; ++i) {
            const float difference = own[i] - other[i];
            sum[i] += weight[i] * 0.5f * (difference * difference);
          }
        }
      }
      float* variance = frame_.variance.row(y) + x0;
      for (std::size_t i = 0; i < count; ++i) variance[i] = sum[i] / std::max(total[i], 1.0f);
    });
  }

  std::span<const char* const> wanted_;
  const Image& image_;
  Image* spare_;
  LightFrame& frame_;
  std::size_t width_;
  ColourPlane sum_;   ///< of the layers
};

}  // namespace

bool is_read_by_others(const std::string& channel) {
  const auto is_of = [&](const char* group) { return is_in_group(channel, group); };
  return channel.starts_with("diffuse.variance") || std::any_of(kFilteredLayers.begin(), kFilteredLayers.end(), is_of) ||
         std::any_of(kReadGroups.begin(), kReadGroups.end(), is_of);
}
bool is_read_to_filter(const std::string& channel) {
  constexpr std::array<const char*, 5> kGroups{"layers", "emission", "specular", "volume", "seen"};
  const auto is_of = [&](const char* group) { return is_in_group(channel, group); };
  return is_read_by_others(channel) || std::any_of(kGroups.begin(), kGroups.end(), is_of) || channel == "A";
}

namespace {

void prepare(const Image& image, Image* spare, std::span<const char* const> wanted, LightFrame& frame) {
  Preparation preparation(image, spare, wanted, frame);
  preparation.take_surfaces();
  preparation.take_light();
  preparation.take_noise();
  preparation.take_means();
}

}  // namespace

LightFrame::LightFrame(const Image& image, std::span<const char* const> wanted) : width(image.width), height(image.height) {
  prepare(image, nullptr, wanted, *this);
}
LightFrame::LightFrame(Image&& image, std::span<const char* const> wanted) : width(image.width), height(image.height) {
  prepare(image, &image, wanted, *this);
}

bool LightFrame::on_surface(int x, int y, int dx, int dy) const {
  return SurfaceRow(*this, y, dx, dy).surface(std::size_t(x)) != 0;
}

}  // namespace tempolux
