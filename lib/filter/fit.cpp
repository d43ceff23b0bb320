#include "lib/filter/fit.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "lib/core/parallel.h"
#include "lib/filter/lane.h"
#include "lib/filter/rows.h"
#include "lib/filter/surface_weight.h"

namespace tempolux {
namespace {

constexpr float kPlane = 3;  ///< variance of a fitted plane's value over the variance of a mean
/// Sums of weight, weight dx ... over the window, for eight pixels at once.
struct Moments {
  Float8 one{}, x{}, y{}, xx{}, xy{}, yy{};
};

/// Fits eight pixels of a row at once, each in a window of 2 kRadius + 1 pixels a side. The radius is a template
/// parameter, so the compiler unrolls the loops over a window.
template <int kRadius>
class StripFit {
 public:
  StripFit(const Surfaces& surfaces, const BothHalves& from, const BothHalves* guides, const FitOptions& options,
           BothHalves& out)
      : surfaces_(surfaces), from_(from), guides_(guides), options_(options), out_(out) {
    const auto row = std::ptrdiff_t(surfaces.use.stride());
    std::ptrdiff_t* offset = offsets_.data();
    for (int dy = -kRadius; dy <= kRadius; ++dy)
      for (int dx = -kRadius; dx <= kRadius; ++dx) *offset++ = options.stride * (dy * row + dx);
  }

  void run(int y, std::size_t x0) {
    y_ = y;
    x0_ = x0;
    // The last eight pixels of a row may reach into the margin, whose results are not stored.
    count_ = std::min(kEight, std::size_t(surfaces_.width) - x0);
    Float8* same = same_.data();
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      const SurfaceEight row(surfaces_, y, dy * options_.stride, std::ptrdiff_t(x0));
      for (int dx = -kRadius; dx <= kRadius; ++dx) *same++ = row.surface(dx * options_.stride);
    }
    alignas(32) std::array<float, kEight> support;
    for (std::size_t h = 0; h < 2; ++h) {
      if (h == 0 || !options_.alike) {
        const Moments moments = weigh(h);
        store8(moments.one, support.data());
        to_kernel(moments);
      }
      std::copy_n(support.begin(), count_, out_[h].weight.row(y_) + x0_);
      for (std::size_t l = 0; l < from_[h].layers.size(); ++l)
        if (!from_[h].layers[l][0].empty()) apply(from_[h].layers[l], out_[h].layers[l]);
    }
  }

 private:
  static constexpr std::size_t kTaps = std::size_t(2 * kRadius + 1) * (2 * kRadius + 1);
  using Taps = std::array<Float8, kTaps>;

  /// The first of the eight pixels. The pixels of the window are at `offsets_` from there, as all planes have one size.
  const float* middle(const Plane& plane) const { return plane.row(y_) + x0_; }

  /// Computes the weights of half h.
  Moments weigh(std::size_t h) {
    const float* weights = middle(from_[h].weight);
    const Light* other = guides_ ? &(*guides_)[1 - h] : nullptr;
    Moments sums;
    if (other) take_own(*other);
    std::size_t tap = 0;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      Float8 one{}, x{}, xx{};
      for (int dx = -kRadius; dx <= kRadius; ++dx, ++tap) {
        Float8 weight = same_[tap] * load8(weights + offsets_[tap]);
        if (other) weight *= agreement(offsets_[tap]);
        weights_[tap] = weight;
        const Float8 fx = all8(float(dx)), first = weight * fx;
        one += weight;
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

  void take_own(const Light& light) {
    Float8 square{};
    for (std::size_t c = 0; c < 3; ++c) {
      guide_[c] = middle(light.guide[c]);
      own_guide_[c] = load8(guide_[c]);
      square += own_guide_[c] * own_guide_[c];
    }
    guide_variance_ = middle(light.guide_variance);
    own_variance_ = load8(guide_variance_) + rounding_variance(square);
  }

  /// value_weight() of the guides.
  Float8 agreement(std::ptrdiff_t offset) const {
    Float8 difference{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Float8 off = own_guide_[c] - load8(guide_[c] + offset);
      difference = multiply_add(off, off, difference);
    }
    const Float8 z = 1 - difference / (kValueErrors * kValueErrors * (own_variance_ + load8(guide_variance_ + offset)) +
                                       kTinyVariance);
    return where(z > 0, z * z);
  }

  /// Computes the kernel of the window. The fitted plane's value at the pixel is own + sum of kernel (value - own),
  /// where own is the pixel's value. The kernel has the sum 1; at the offset (dx, dy) it is
  ///     weight (1 / one + b (dx - mx) + c (dy - my)) = weight (a + b dx + c dy).
  /// (mx, my) is the weighted mean of the offsets. At this mean the plane's value is the weighted mean of the values,
  /// so only the slopes remain to be computed.
  void to_kernel(const Moments& moments) {
    const Int8 any = moments.one > 0;
    const Float8 one = where(any, moments.one) + where(~any, all8(1)), per_weight = where(any, 1 / one);
    const Float8 mx = moments.x / one, my = moments.y / one, pull = kPull * one;
    const Float8 xx = moments.xx - moments.x * mx + pull, yy = moments.yy - moments.y * my + pull,
                 xy = moments.xy - moments.x * my;
    const Float8 determinant = xx * yy - xy * xy;  // positive because of kPull
    const Float8 b = (my * xy - mx * yy) / determinant, c = (mx * xy - my * xx) / determinant,
                 a = per_weight - b * mx - c * my;
    store8(per_weight, per_weight_.data());
    std::size_t tap = 0;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      const Float8 of_row = multiply_add(c, all8(float(dy)), a);
      for (int dx = -kRadius; dx <= kRadius; ++dx, ++tap)
        kernel_[tap] = weights_[tap] * multiply_add(b, all8(float(dx)), of_row);
    }
  }

  /// Sum over the window of factors (value - own), for three planes. Differences to the own value keep constant light
  /// exact, to the last bit.
  std::array<Float8, 3> sum_of(const Taps& factors, const ColourPlane& from) const {
    const float *red = middle(from[0]), *green = middle(from[1]), *blue = middle(from[2]);
    const Float8 own_r = load8(red), own_g = load8(green), own_b = load8(blue);
    Float8 r{}, g{}, b{};
    for (std::size_t tap = 0; tap < kTaps; ++tap) {
      r = multiply_add(factors[tap], load8(red + offsets_[tap]) - own_r, r);
      g = multiply_add(factors[tap], load8(green + offsets_[tap]) - own_g, g);
      b = multiply_add(factors[tap], load8(blue + offsets_[tap]) - own_b, b);
    }
    return {r, g, b};
  }

  void apply(const ColourPlane& from, ColourPlane& to) {
    const std::array<Float8, 3> sums = sum_of(kernel_, from);
    bool below = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const float* own = from[c].row(y_) + x0_;
      float* value = to[c].row(y_) + x0_;
      for (std::size_t i = 0; i < count_; ++i) {
        value[i] = own[i] + sums[c][i];
        below |= value[i] < 0;
      }
    }
    if (below) raise(from, to);
  }

  /// If the plane is below 0 at the pixel, takes the weighted mean, or 0 if the mean is negative.
  void raise(const ColourPlane& from, ColourPlane& to) {
    const std::array<Float8, 3> sums = sum_of(weights_, from);
    for (std::size_t c = 0; c < 3; ++c) {
      const float* own = from[c].row(y_) + x0_;
      float* value = to[c].row(y_) + x0_;
      for (std::size_t i = 0; i < count_; ++i)
        value[i] = std::max(value[i], std::min(own[i] + sums[c][i] * per_weight_[i], 0.0f));
    }
  }

  const Surfaces& surfaces_;
  const BothHalves& from_;
  const BothHalves* guides_;
  const FitOptions& options_;
  BothHalves& out_;
  int y_ = 0;
  std::size_t x0_ = 0, count_ = 0;
  std::array<std::ptrdiff_t, kTaps> offsets_;  ///< by place in the window, in floats of a plane
  std::array<const float*, 3> guide_{};
  const float* guide_variance_ = nullptr;
  Float8 own_variance_{};
  std::array<Float8, 3> own_guide_{};
  Taps same_, weights_, kernel_;                        ///< by place in the window, row after row
  alignas(32) std::array<float, kEight> per_weight_{};  ///< 1 / sum of the weights
};

/// Computes the guide, by which later fits and other frames compare pixels.
void take_guide(const Surfaces& surfaces, const Plane& variance, Light& light) {
  for (Plane& plane : light.guide) plane = Plane(surfaces.width, surfaces.height);
  light.guide_variance = Plane::unset(surfaces.width, surfaces.height);
  for_each_row(surfaces.height, [&](int y) {
    for (std::size_t c = 0; c < 3; ++c)
      for (const ColourPlane& layer : light.layers)
        if (!layer[c].empty())
          for (int x = 0; x < surfaces.width; ++x) light.guide[c].row(y)[x] += layer[c].row(y)[x];
    for (int x = 0; x < surfaces.width; ++x)
      light.guide_variance.row(y)[x] = kPlane * variance.row(y)[x] / std::max(light.weight.row(y)[x], 1.0f);
  });
}

}  // namespace

BothHalves fit(const Surfaces& surfaces, const BothHalves& from, const BothHalves* guides, const FitOptions& options,
               const Plane& variance) {
  BothHalves out;
  for (std::size_t h = 0; h < 2; ++h) {
    out[h].weight = Plane::unset(surfaces.width, surfaces.height);
    out[h].layers.resize(from[h].layers.size());
    for (std::size_t l = 0; l < out[h].layers.size(); ++l)
      for (std::size_t c = 0; c < 3 && !from[h].layers[l][c].empty(); ++c)
        out[h].layers[l][c] = Plane::unset(surfaces.width, surfaces.height);
  }
  const auto fit_all = [&]<int kRadius>(std::integral_constant<int, kRadius>) {
    parallel_chunks(std::size_t(surfaces.height), 8, [&](std::size_t first, std::size_t last) {
      StripFit<kRadius> strip(surfaces, from, guides, options, out);
      for (int y = int(first); y < int(last); ++y)
        for (std::size_t x = 0; x < std::size_t(surfaces.width); x += kEight) strip.run(y, x);
    });
  };
  if (options.radius == 1) fit_all(std::integral_constant<int, 1>());
  else fit_all(std::integral_constant<int, 2>());
  for (Light& half : out) take_guide(surfaces, variance, half);
  return out;
}

Plane smoothed(const Surfaces& surfaces, const Plane& values) {
  constexpr int kNear = 2;
  Plane out = Plane::unset(surfaces.width, surfaces.height);
  for_each_row(surfaces.height, [&](int y) {
    for (std::size_t x = 0; x < std::size_t(surfaces.width); x += kEight) {
      Float8 sum{}, count{};
      for (int dy = -kNear; dy <= kNear; ++dy) {
        const SurfaceEight row(surfaces, y, dy, std::ptrdiff_t(x));
        for (int dx = -kNear; dx <= kNear; ++dx) {
          const Float8 weight = row.surface(dx) * load8(surfaces.use.row(y + dy) + std::ptrdiff_t(x) + dx);
          count += weight;
          sum = multiply_add(weight, load8(values.row(y + dy) + std::ptrdiff_t(x) + dx), sum);
        }
      }
      for (std::size_t i = 0; i < std::min(kEight, std::size_t(surfaces.width) - x); ++i)
        out.row(y)[x + i] = count[i] > 0 ? sum[i] / count[i] : values.row(y)[x + i];
    }
  });
  return out;
}

}  // namespace tempolux
