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

/// Sums of weight, weight dx ... over the window, of eight pixels.
struct Moments {
  Float8 one{}, x{}, y{}, xx{}, xy{}, yy{};
};

class StripFit {
 public:
  StripFit(const LightFrame& frame, const Collected& collected, const FitOptions& options, Fitted& out)
      : frame_(frame), collected_(collected), options_(options), out_(out) {}

  void run(int y, std::size_t x0) {
    y_ = y;
    x0_ = x0;
    const std::size_t count = std::min(kEight, std::size_t(frame_.width) - x0);   // the last eight may reach into the margin: never stored
    const Moments moments = weigh();
    store8(moments.one, kept_.data());
    std::copy_n(kept_.begin(), count, out_.support.row(y_) + x0_);
    to_kernel(moments);
    for (std::size_t l = 0; l < collected_.light.size(); ++l)
      if (!collected_.light[l][0].empty()) apply(collected_.light[l], out_.light[l], count);
  }

 private:
  static constexpr std::size_t kMostTaps = 2 * kMargin + 1;

  Float8 at(const Plane& plane, int dx, int dy) const { return load8(plane.row(y_ + dy) + std::ptrdiff_t(x0_) + dx); }

  /// Fills weights_.
  Moments weigh() {
    const int radius = options_.radius;
    Moments sums;
    own_variance_ = at(collected_.mean_variance, 0, 0);
    Float8 square{};
    for (std::size_t c = 0; c < 3; ++c) {
      own_mean_[c] = at(collected_.mean[c], 0, 0);
      square += own_mean_[c] * own_mean_[c];
    }
    own_variance_ += rounding_variance(square);
    Float8* weight = weights_.data();
    for (int dy = -radius; dy <= radius; ++dy) {
      const SurfaceEight surface(frame_, y_, dy, x0_, collected_.weight.row(y_ + dy));
      Float8 one{}, x{}, xx{};
      for (int dx = -radius; dx <= radius; ++dx, ++weight) {
        *weight = surface.weight(dx);
        if (options_.reach2) *weight *= left_of_reach(dx, dy);
        if (options_.by_value) *weight *= agreement(dx, dy);
        const Float8 fx = all8(float(dx)), first = *weight * fx;
        one += *weight;
        x += first;
        xx = multiply_add(first, fx, xx);
      }
      const Float8 fy = all8(float(dy));
      sums.one += one;
      sums.x += x;
      sums.xx += xx;
      sums.y = multiply_add(one, fy, sums.y);
      sums.xy = multiply_add(x, fy, sums.xy);
      sums.yy = multiply_add(one * fy, fy, sums.yy);
    }
    return sums;
  }

  Float8 left_of_reach(int dx, int dy) const {
    const Float8 left = 1 - float(dx * dx + dy * dy) / at(*options_.reach2, 0, 0);
    return where(left > 0, left * left);
  }

  /// value_weight() of the means.
  Float8 agreement(int dx, int dy) const {
    Float8 difference{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Float8 off = own_mean_[c] - at(collected_.mean[c], dx, dy);
      difference = multiply_add(off, off, difference);
    }
    return value_weight(difference, own_variance_ + at(collected_.mean_variance, dx, dy));
  }

  /// The plane's value at the pixel is a weighted sum of differences to the pixel's own: weights_ become those weights,
  ///     weight (1 / one + to_x (dx - mx) + to_y (dy - my)),   their sum is 1.
  /// Coordinates are counted from the window's centre of weight: two slopes are left to solve for.
  void to_kernel(const Moments& moments) {
    alignas(32) std::array<float, kEight> flat{}, slope_x{}, slope_y{};
    for (std::size_t i = 0; i < kEight; ++i) {
      const double one = double(moments.one[i]);
      if (!(one > 0)) continue;
      const double per_weight = 1 / one, mx = double(moments.x[i]) * per_weight, my = double(moments.y[i]) * per_weight,
                   pull = double(kPull) * one;
      const double xx = double(moments.xx[i]) - one * mx * mx + pull, yy = double(moments.yy[i]) - one * my * my + pull,
                   xy = double(moments.xy[i]) - one * mx * my;
      const double determinant = xx * yy - xy * xy;   // positive: pull is
      const double to_x = -(mx * yy - my * xy) / determinant, to_y = -(my * xx - mx * xy) / determinant;
      flat[i] = float(per_weight - to_x * mx - to_y * my);
      slope_x[i] = float(to_x);
      slope_y[i] = float(to_y);
      kept_[i] = float(per_weight);
    }
    const Float8 a = load8(flat.data()), b = load8(slope_x.data()), c = load8(slope_y.data());
    Float8* kernel = kernel_.data();
    const Float8* weight = weights_.data();
    for (int dy = -options_.radius; dy <= options_.radius; ++dy) {
      const Float8 of_row = multiply_add(c, all8(float(dy)), a);
      for (int dx = -options_.radius; dx <= options_.radius; ++dx) *kernel++ = *weight++ * multiply_add(b, all8(float(dx)), of_row);
    }
  }

  /// Sum over the window of factors (value - own), for three planes. Differences: what is constant comes out to the bit.
  std::array<Float8, 3> sum_of(const std::vector<Float8>& factors, const ColourPlane& from) const {
    const std::array<Float8, 3> own{at(from[0], 0, 0), at(from[1], 0, 0), at(from[2], 0, 0)};
    Float8 r{}, g{}, b{};
    const Float8* factor = factors.data();
    for (int dy = -options_.radius; dy <= options_.radius; ++dy)
      for (int dx = -options_.radius; dx <= options_.radius; ++dx, ++factor) {
        r = multiply_add(*factor, at(from[0], dx, dy) - own[0], r);
        g = multiply_add(*factor, at(from[1], dx, dy) - own[1], g);
        b = multiply_add(*factor, at(from[2], dx, dy) - own[2], b);
      }
    return {r, g, b};
  }

  void apply(const ColourPlane& from, ColourPlane& to, std::size_t count) {
    const std::array<Float8, 3> sums = sum_of(kernel_, from);
    bool below = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const float* own = from[c].row(y_) + x0_;
      float* value = to[c].row(y_) + x0_;
      for (std::size_t i = 0; i < count; ++i) {
        value[i] = own[i] + sums[c][i];
        below |= value[i] < 0;
      }
    }
    if (below) raise(from, to, count);
  }

  /// A plane that falls below 0 in the middle gives way to the mean, or 0 if that is above it.
  void raise(const ColourPlane& from, ColourPlane& to, std::size_t count) {
    const std::array<Float8, 3> sums = sum_of(weights_, from);
    for (std::size_t c = 0; c < 3; ++c) {
      const float* own = from[c].row(y_) + x0_;
      float* value = to[c].row(y_) + x0_;
      for (std::size_t i = 0; i < count; ++i) value[i] = std::max(value[i], std::min(own[i] + sums[c][i] * kept_[i], 0.0f));
    }
  }

  const LightFrame& frame_;
  const Collected& collected_;
  const FitOptions& options_;
  Fitted& out_;
  int y_ = 0;
  std::size_t x0_ = 0;
  Float8 own_variance_{};
  std::array<Float8, 3> own_mean_{};
  std::vector<Float8> weights_ = std::vector<Float8>(kMostTaps * kMostTaps), kernel_ = weights_;   ///< of the window, row after row
  alignas(32) std::array<float, kEight> kept_{};   ///< 1 / sum of the weights
};

}  // namespace

Fitted fit(const LightFrame& frame, const Collected& collected, const FitOptions& options) {
  Fitted out;
  out.support = Plane::unset(frame.width, frame.height);
  out.light.resize(collected.light.size());
  for (std::size_t l = 0; l < out.light.size(); ++l)
    for (std::size_t c = 0; c < 3 && !collected.light[l][c].empty(); ++c) out.light[l][c] = Plane::unset(frame.width, frame.height);
  parallel_chunks(std::size_t(frame.height), 8, [&](std::size_t first, std::size_t last) {
    StripFit strip(frame, collected, options, out);
    for (int y = int(first); y < int(last); ++y)
      for (std::size_t x = 0; x < std::size_t(frame.width); x += kEight) strip.run(y, x);
  });
  return out;
}

}  // namespace tempolux
