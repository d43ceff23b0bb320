#include "lib/filter/fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/filter/surface_weight.h"

namespace tempolux {
namespace {

/// Pulls slopes to 0 as if by pixels kPull times all of them, 1 px^2 away: decides where a window has all its pixels in one column.
constexpr float kPull = 0.02f;

/// Sums of weight, weight dx ... over the window, one strip's.
struct Moments {
  Lane one{}, x{}, y{}, xx{}, xy{}, yy{};
};
/// Sums of weight value, weight value dx, weight value dy of one plane; value: less that of the pixel in the middle.
struct ValueMoments {
  Lane one{}, x{}, y{};
};

class StripFit {
 public:
  StripFit(const LightFrame& frame, const Collected& collected, const FitOptions& options, Fitted& out)
      : frame_(frame), collected_(collected), options_(options), out_(out) {
    for (std::size_t l = 0; l < collected.light.size(); ++l)
      for (std::size_t c = 0; c < 3; ++c)
        if (!collected.light[l][c].empty()) planes_.push_back({&collected.light[l][c], &out.light[l][c]});
    values_.resize(planes_.size());
    rows_.resize(planes_.size());
  }

  void run(int y, std::size_t x0) {
    y_ = y;
    x0_ = x0;
    count_ = std::min(kStrip, std::size_t(frame_.width) - x0);
    sums_ = {};
    std::fill(values_.begin(), values_.end(), ValueMoments{});
    for (int dy = -options_.radius; dy <= options_.radius; ++dy) add_row(dy);
    store();
  }

 private:
  const float* plane(const Plane& p, int dy = 0) const { return p.row(y_ + dy) + x0_; }

  void add_row(int dy) {
    Lane one{}, x{}, xx{};
    std::fill(rows_.begin(), rows_.end(), std::array<Lane, 2>{});
    Lane weight;
    for (int dx = -options_.radius; dx <= options_.radius; ++dx) {
      weigh(dx, dy, weight);
      const auto fx = float(dx);
      for (std::size_t i = 0; i < kStrip; ++i) {
        one[i] += weight[i];
        x[i] += weight[i] * fx;
        xx[i] += weight[i] * (fx * fx);
      }
      for (std::size_t v = 0; v < values_.size(); ++v) {
        const float* value = plane(*planes_[v].from, dy) + dx;
        const float* own = plane(*planes_[v].from);   // differences from it: what is constant comes out to the bit
        Lane &sum = rows_[v][0], &sum_x = rows_[v][1];
        for (std::size_t i = 0; i < count_; ++i) {
          const float weighted = weight[i] * (value[i] - own[i]);
          sum[i] += weighted;
          sum_x[i] += weighted * fx;
        }
      }
    }
    const auto fy = float(dy);
    for (std::size_t i = 0; i < kStrip; ++i) {
      sums_.one[i] += one[i];
      sums_.x[i] += x[i];
      sums_.xx[i] += xx[i];
      sums_.y[i] += one[i] * fy;
      sums_.xy[i] += x[i] * fy;
      sums_.yy[i] += one[i] * (fy * fy);
    }
    for (std::size_t v = 0; v < values_.size(); ++v)
      for (std::size_t i = 0; i < kStrip; ++i) {
        values_[v].one[i] += rows_[v][0][i];
        values_[v].x[i] += rows_[v][1][i];
        values_[v].y[i] += rows_[v][0][i] * fy;
      }
  }

  void weigh(int dx, int dy, Lane& weight) const {
    const SurfaceRow surface(frame_, y_, dx, dy, collected_.weight.row(y_ + dy));
    weight = {};
    surface.weigh(x0_, count_, weight);
    if (options_.reach2) {
      const float* reach2 = plane(*options_.reach2);
      const auto distance2 = float(dx * dx + dy * dy);
      for (std::size_t i = 0; i < count_; ++i) {
        const float left = std::max(0.0f, 1 - distance2 / reach2[i]);
        weight[i] *= left * left;
      }
    }
    if (!options_.by_value) return;
    const float *r = plane(collected_.mean[0]), *g = plane(collected_.mean[1]), *b = plane(collected_.mean[2]),
                *other_r = plane(collected_.mean[0], dy) + dx, *other_g = plane(collected_.mean[1], dy) + dx,
                *other_b = plane(collected_.mean[2], dy) + dx, *variance = plane(collected_.mean_variance),
                *other_variance = plane(collected_.mean_variance, dy) + dx;
    for (std::size_t i = 0; i < count_; ++i) {
      const float dr = r[i] - other_r[i], dg = g[i] - other_g[i], db = b[i] - other_b[i];
      const float allowed = variance[i] + other_variance[i] + rounding_variance(r[i] * r[i] + g[i] * g[i] + b[i] * b[i]);
      weight[i] *= value_weight(dr * dr + dg * dg + db * db, allowed);
    }
  }

  void store() {
    for (std::size_t i = 0; i < count_; ++i) {
      const int x = int(x0_ + i);
      const double one = double(sums_.one[i]);
      out_.support.at(x, y_) = sums_.one[i];
      if (!(one > 0)) {
        for (std::size_t v = 0; v < values_.size(); ++v) planes_[v].to->at(x, y_) = planes_[v].from->at(x, y_);
        continue;
      }
      // Coordinates from the window's centre of weight: two slopes are left to solve for.
      const double mx = double(sums_.x[i]) / one, my = double(sums_.y[i]) / one, pull = double(kPull) * one;
      const double xx = double(sums_.xx[i]) - one * mx * mx + pull, yy = double(sums_.yy[i]) - one * my * my + pull,
                   xy = double(sums_.xy[i]) - one * mx * my;
      const double determinant = xx * yy - xy * xy;   // positive: pull is
      const double to_x = -(mx * yy - my * xy) / determinant, to_y = -(my * xx - mx * xy) / determinant;
      for (std::size_t v = 0; v < values_.size(); ++v) {
        const ValueMoments& sums = values_[v];
        const double own = double(planes_[v].from->at(x, y_)), mean = double(sums.one[i]) / one;   // the mean less own
        const double value = own + mean + to_x * (double(sums.x[i]) - mean * double(sums_.x[i])) +
                             to_y * (double(sums.y[i]) - mean * double(sums_.y[i]));
        planes_[v].to->at(x, y_) = float(std::max(value, std::min(own + mean, 0.0)));
      }
    }
  }

  const LightFrame& frame_;
  const Collected& collected_;
  const FitOptions& options_;
  Fitted& out_;
  int y_ = 0;
  std::size_t x0_ = 0, count_ = 0;
  Moments sums_;
  struct FittedPlane {
    const Plane* from;
    Plane* to;
  };
  std::vector<FittedPlane> planes_;         ///< of layers that are not black
  std::vector<ValueMoments> values_;        ///< by plane
  std::vector<std::array<Lane, 2>> rows_;   ///< of one row of the window: weight value, weight value dx
};

}  // namespace

Fitted fit(const LightFrame& frame, const Collected& collected, const FitOptions& options) {
  Fitted out;
  out.support = Plane(frame.width, frame.height);
  out.light.resize(frame.light.size());
  for (std::size_t l = 0; l < out.light.size(); ++l)
    for (std::size_t c = 0; c < 3 && !collected.light[l][c].empty(); ++c) out.light[l][c] = Plane(frame.width, frame.height);
  parallel_chunks(std::size_t(frame.height), 8, [&](std::size_t first, std::size_t last) {
    StripFit strip(frame, collected, options, out);
    for (int y = int(first); y < int(last); ++y)
      for (std::size_t x = 0; x < std::size_t(frame.width); x += kStrip) strip.run(y, x);
  });
  return out;
}

}  // namespace tempolux
