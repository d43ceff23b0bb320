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

void add8(Float8 values, float* to) { store8(load8(to) + values, to); }

class StripFit {
 public:
  StripFit(const LightFrame& frame, const Collected& collected, const FitOptions& options, Fitted& out)
      : frame_(frame), collected_(collected), options_(options), out_(out) {
    for (std::size_t l = 0; l < collected.light.size(); ++l)
      for (std::size_t c = 0; c < 3; ++c)
        if (!collected.light[l][c].empty()) planes_.push_back({&collected.light[l][c], &out.light[l][c]});
    values_.resize(planes_.size());
  }

  void run(int y, std::size_t x0) {
    y_ = y;
    x0_ = x0;
    count_ = std::min(kStrip, std::size_t(frame_.width) - x0);
    sums_ = {};
    std::fill(values_.begin(), values_.end(), ValueMoments{});
    for (int dy = -options_.radius; dy <= options_.radius; ++dy)
      for (std::size_t i = 0; i < count_; i += kEight) add_row(dy, i);   // the last eight may reach into the margin: never stored
    store();
  }

 private:
  static constexpr std::size_t kMostTaps = 2 * kMargin + 1;

  /// What eight pixels add from one row of their windows.
  void add_row(int dy, std::size_t i) {
    std::array<Float8, kMostTaps> weights;
    const SurfaceEight surface(frame_, y_, dy, x0_ + i, collected_.weight.row(y_ + dy));
    Float8 one{}, x{}, xx{};
    for (int dx = -options_.radius; dx <= options_.radius; ++dx) {
      Float8 weight = surface.weight(dx);
      if (options_.reach2) weight *= left_of_reach(dx, dy, i);
      if (options_.by_value) weight *= agreement(dx, dy, i);
      weights[std::size_t(dx + options_.radius)] = weight;
      const auto fx = float(dx);
      one += weight;
      x += weight * fx;
      xx += weight * (fx * fx);
    }
    const auto fy = float(dy);
    add8(one, &sums_.one[i]);
    add8(x, &sums_.x[i]);
    add8(xx, &sums_.xx[i]);
    add8(one * fy, &sums_.y[i]);
    add8(x * fy, &sums_.xy[i]);
    add8(one * (fy * fy), &sums_.yy[i]);
    for (std::size_t v = 0; v < values_.size(); ++v) {
      const float* values = planes_[v].from->row(y_ + dy) + x0_ + i;
      const Float8 own = load8(planes_[v].from->row(y_) + x0_ + i);   // differences from it: what is constant comes out to the bit
      Float8 sum{}, sum_x{};
      for (int dx = -options_.radius; dx <= options_.radius; ++dx) {
        const Float8 weighted = weights[std::size_t(dx + options_.radius)] * (load8(values + dx) - own);
        sum += weighted;
        sum_x += weighted * float(dx);
      }
      add8(sum, &values_[v].one[i]);
      add8(sum_x, &values_[v].x[i]);
      add8(sum * fy, &values_[v].y[i]);
    }
  }

  Float8 at(const Plane& plane, int dx, int dy, std::size_t i) const { return load8(plane.row(y_ + dy) + std::ptrdiff_t(x0_ + i) + dx); }

  Float8 left_of_reach(int dx, int dy, std::size_t i) const {
    const Float8 left = 1 - float(dx * dx + dy * dy) / at(*options_.reach2, 0, 0, i);
    return where(left > 0, left * left);
  }

  /// value_weight() of the means.
  Float8 agreement(int dx, int dy, std::size_t i) const {
    Float8 difference{}, square{};
    for (const Plane& mean : collected_.mean) {
      const Float8 own = at(mean, 0, 0, i), off = own - at(mean, dx, dy, i);
      difference += off * off;
      square += own * own;
    }
    return value_weight(difference, at(collected_.mean_variance, 0, 0, i) + at(collected_.mean_variance, dx, dy, i) + rounding_variance(square));
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
      const double per_weight = 1 / one, mx = double(sums_.x[i]) * per_weight, my = double(sums_.y[i]) * per_weight, pull = double(kPull) * one;
      const double xx = double(sums_.xx[i]) - one * mx * mx + pull, yy = double(sums_.yy[i]) - one * my * my + pull,
                   xy = double(sums_.xy[i]) - one * mx * my;
      const double determinant = xx * yy - xy * xy;   // positive: pull is
      const double to_x = -(mx * yy - my * xy) / determinant, to_y = -(my * xx - mx * xy) / determinant;
      for (std::size_t v = 0; v < values_.size(); ++v) {
        const ValueMoments& sums = values_[v];
        const double own = double(planes_[v].from->at(x, y_)), mean = double(sums.one[i]) * per_weight;   // the mean less own
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
};

}  // namespace

Fitted fit(const LightFrame& frame, const Collected& collected, const FitOptions& options) {
  Fitted out;
  out.support = Plane(frame.width, frame.height);
  out.light.resize(collected.light.size());
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
