#include "lib/filter/regress.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "lib/core/parallel.h"
#include "lib/filter/filter_frame.h"
#include "lib/filter/fit.h"
#include "lib/filter/lane.h"
#include "lib/filter/picture.h"
#include "lib/filter/rows.h"

namespace tempolux {
namespace {

constexpr int kFitRadius = kSmall.radius + kSmall.radius;  ///< pixels; docs/methods/st-filter.md 11 has other windows
constexpr std::size_t kFitTaps = (2 * kFitRadius + 1) * (2 * kFitRadius + 1), kBlockRows = 8, kBlockColumns = 64;
/// Share of each diagonal element that is added to the element. The share is above the rounding of a sum of kFitTaps
/// terms, so pivots are positive.
constexpr float kRounding = kFitTaps * std::numeric_limits<float>::epsilon();
constexpr std::size_t kTerms = 3 + Features::kCount;

/// Radiance of one half of a group.
struct HalfRadiance {
  std::vector<ColourPlane> layers;  ///< empty planes: black
  ColourPlane sum;                  ///< of the layers
};

/// Radiance of both halves, the variance of one half's sum and which pixels are finite.
struct Radiance {
  std::array<HalfRadiance, 2> half;
  Plane variance;  ///< summed over colours; mean over 3 x 3 pixels
  Plane finite;    ///< 1 or 0

  Radiance(const Image& image, const LightGroup& group) {
    const Surfaces& on = group.surfaces;
    finite = Plane(on.width, on.height);
    for (HalfRadiance& h : half) {
      h.layers.resize(group.layers.size());
      for (Plane& plane : h.sum) plane = Plane(on.width, on.height);
    }
    for_each_row(on.height, [&](int y) { std::fill_n(finite.row(y), on.width, 1.0f); });
    for (std::size_t l = 0; l < group.layers.size(); ++l)
      for (std::size_t c = 0; c < 3; ++c) {
        if (group.raw[0].layers[l][c].empty()) continue;
        mark(image, channel_name(group.layers[l], c), on);
        mark(image, channel_name(group.layers[l] + ".noise", c), on);
        for (std::size_t h = 0; h < 2; ++h) take(group, h, l, c);
      }
    take_variance(on.width, on.height);
  }

 private:
  void mark(const Image& image, const std::string& name, const Surfaces& on) {
    if (!holds(image, name)) return;
    const std::vector<float>& values = image.find(name)->values;
    for_each_row(on.height, [&](int y) {
      const float* row = values.data() + std::size_t(y) * std::size_t(on.width);
      for (int x = 0; x < on.width; ++x)
        if (!(std::abs(row[x]) < kLargestLight * 0.01f)) finite.at(x, y) = 0;
    });
  }
  void take(const LightGroup& group, std::size_t h, std::size_t l, std::size_t c) {
    const Surfaces& on = group.surfaces;
    Plane& to = half[h].layers[l][c] = Plane(on.width, on.height);
    for_each_row(on.height, [&](int y) {
      for (int x = 0; x < on.width; ++x) {
        if (finite.at(x, y) == 0) continue;
        to.at(x, y) = group.raw[h].layers[l][c].at(x, y) * on.albedo_at(c, x, y);
        half[h].sum[c].at(x, y) += to.at(x, y);
      }
    });
  }
  void take_variance(int width, int height) {
    Plane squares(width, height);
    for_each_row(height, [&](int y) {
      for (int x = 0; x < width; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          const float off = half[0].sum[c].at(x, y) - half[1].sum[c].at(x, y);
          squares.at(x, y) += finite.at(x, y) * off * off / 2;
        }
    });
    variance = Plane(width, height);
    for_each_row(height, [&](int y) {
      for (int x = 0; x < width; ++x) variance.at(x, y) = mean_of_nine(squares, finite, x, y);
    });
  }
};

/// Fits eight pixels of a row at once.
class Regression {
 public:
  Regression(const Radiance& from, const Features& features, std::vector<Halves>& out, int width, int height)
      : from_(from),
        features_(features),
        out_(out),
        width_(width),
        height_(height),
        weights_(kFitTaps * kBlockRows * kBlockColumns) {}

  /// The pixels from (x0, y0) on, up to kBlockColumns x kBlockRows.
  void block(int x0, int y0) {
    for (std::size_t h = 0; h < 2; ++h) {
      weigh(x0, y0, from_.half[1 - h]);
      for (int y = y0; y < std::min(height_, y0 + int(kBlockRows)); ++y)
        for (int x = x0; x < std::min(width_, x0 + int(kBlockColumns)); x += int(kEight))
          fit(h, x, y, weights_.data() + std::size_t(y - y0) * kBlockColumns + std::size_t(x - x0));
    }
  }

 private:
  static constexpr std::size_t kGram = kTerms * (kTerms + 1) / 2;
  static constexpr std::size_t kPlace = kBlockRows * kBlockColumns;  ///< floats of weights_ from tap to tap
  using Terms = std::array<Float8, kTerms>;

  /// Fills weights_ by the guide's patches.
  void weigh(int x0, int y0, const HalfRadiance& guide) {
    constexpr int kRows = int(kBlockRows) + 2,
                  kFirst = -int(kEight);  // patches reach one pixel to each side
    constexpr std::size_t kColumns = kBlockColumns + 2 * kEight;
    std::array<std::array<float, kColumns>, std::size_t(kRows)> off, count;
    std::size_t tap = 0;
    for (int dy = -kFitRadius; dy <= kFitRadius; ++dy)
      for (int dx = -kFitRadius; dx <= kFitRadius; ++dx, ++tap) {
        for (int j = 0; j < kRows; ++j)
          for (std::size_t i = 0; i < kColumns; i += kEight)
            compare(guide, x0 + kFirst + int(i), y0 + j - 1, dx, dy, &off[std::size_t(j)][i],
                    &count[std::size_t(j)][i]);
        for (std::size_t j = 0; j < kBlockRows; ++j)
          for (std::size_t i = 0; i < kBlockColumns; i += kEight) {
            Float8 sum{}, pairs{};
            for (std::size_t v = 0; v <= 2; ++v)
              for (std::size_t u = 0; u <= 2; ++u) {
                sum += load8(&off[j + v][i + kEight - 1 + u]);
                pairs += load8(&count[j + v][i + kEight - 1 + u]);
              }
            const Float8 d = sum / (pairs + 1e-6f), z = 1 - where(d > 0, d) / 4, positive = where(z > 0, z),
                         square = positive * positive;
            store8(where(pairs > 0, square * square), &weights_[tap * kPlace + j * kBlockColumns + i]);
          }
      }
  }

  /// For eight pairs of pixels: the term of d in regress.h, and 1 if both pixels count.
  void compare(const HalfRadiance& guide, int x, int y, int dx, int dy, float* off, float* count) const {
    const auto own = [&](const Plane& plane) { return load8(plane.row(y) + x); };
    const auto other = [&](const Plane& plane) { return load8(plane.row(y + dy) + x + dx); };
    Float8 difference{}, square{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Float8 a = own(guide.sum[c]), apart = a - other(guide.sum[c]);
      difference = multiply_add(apart, apart, difference);
      square = multiply_add(a, a, square);
    }
    const Float8 v = own(from_.variance), w = other(from_.variance), less = where(v < w, v) + where(v >= w, w);
    const Float8 both = own(from_.finite) * other(from_.finite);
    store8(both * (difference - v - less) / (v + w + rounding_variance(square) + kTinyVariance), off);
    store8(both, count);
  }

  /// The regressors of the pixels (dx, dy) away.
  Terms terms_at(int x, int y, int dx, int dy, const std::array<Float8, Features::kCount>& own) const {
    Terms t;
    t[0] = all8(1);
    t[1] = all8(float(dx) / float(kFitRadius));
    t[2] = all8(float(dy) / float(kFitRadius));
    for (std::size_t f = 0; f < Features::kCount; ++f)
      t[3 + f] = load8(features_.mean[f].row(y + dy) + x + dx) - own[f];
    return t;
  }

  void fit(std::size_t h, int x, int y, const float* weights) {
    std::array<Float8, Features::kCount> own;
    for (std::size_t f = 0; f < Features::kCount; ++f) own[f] = load8(features_.mean[f].row(y) + x);
    std::array<Float8, kGram> gram{};
    std::array<Float8, Features::kCount> noise{};
    std::array<Float8, kFitTaps> weight;
    std::size_t tap = 0;
    for (int dy = -kFitRadius; dy <= kFitRadius; ++dy)
      for (int dx = -kFitRadius; dx <= kFitRadius; ++dx, ++tap) {
        const Float8 w = weight[tap] = load8(weights + tap * kPlace) * load8(from_.finite.row(y + dy) + x + dx);
        const Terms t = terms_at(x, y, dx, dy, own);
        Float8* g = gram.data();
        for (std::size_t i = 0; i < kTerms; ++i) {
          const Float8 wt = w * t[i];
          for (std::size_t j = 0; j <= i; ++j, ++g) *g = multiply_add(wt, t[j], *g);
        }
        for (std::size_t f = 0; f < Features::kCount; ++f)
          noise[f] = multiply_add(w, load8(features_.variance[f].row(y + dy) + x + dx), noise[f]);
      }
    const Terms solved = first_column_of_inverse(gram, noise, own);
    tap = 0;
    for (int dy = -kFitRadius; dy <= kFitRadius; ++dy)
      for (int dx = -kFitRadius; dx <= kFitRadius; ++dx, ++tap) {
        const Terms t = terms_at(x, y, dx, dy, own);
        Float8 kernel = solved[0];
        for (std::size_t i = 1; i < kTerms; ++i) kernel = multiply_add(solved[i], t[i], kernel);
        weight[tap] *= kernel;
      }
    for (std::size_t l = 0; l < from_.half[h].layers.size(); ++l)
      for (std::size_t c = 0; c < 3; ++c)
        if (const Plane& plane = from_.half[h].layers[l][c]; !plane.empty())
          apply(plane, weight, x, y, (h == 0 ? out_[l].a : out_[l].b)[c]);
  }

  /// u with G u = (1, 0, ...): the fit's value at the pixel is the sum of weight (u . terms) value. G is scaled to a
  /// diagonal of 1 and factored as L D L^T.
  Terms first_column_of_inverse(std::array<Float8, kGram>& gram, const std::array<Float8, Features::kCount>& noise,
                                const std::array<Float8, Features::kCount>& own) const {
    const auto at = [&](std::size_t i, std::size_t j) -> Float8& { return gram[i * (i + 1) / 2 + j]; };
    const Float8 n = at(0, 0) + kTinyVariance;
    for (std::size_t i = 1; i < 3; ++i) at(i, i) += kPull * n;
    for (std::size_t f = 0; f < Features::kCount; ++f) {
      at(3 + f, 3 + f) += noise[f] + n * rounding_variance(own[f] * own[f]) + kTinyVariance;
    }
    for (std::size_t i = 1; i < kTerms; ++i) at(i, i) *= 1 + kRounding;
    at(0, 0) = n;
    for (std::size_t j = 0; j < kTerms; ++j) {
      // Column j of L below the diagonal; D in the diagonal.
      for (std::size_t k = 0; k < j; ++k) at(j, j) -= at(j, k) * at(j, k) * at(k, k);
      for (std::size_t i = j + 1; i < kTerms; ++i) {
        Float8 v = at(i, j);
        for (std::size_t k = 0; k < j; ++k) v -= at(i, k) * at(j, k) * at(k, k);
        at(i, j) = v / at(j, j);
      }
    }
    Terms u;
    for (std::size_t i = 0; i < kTerms; ++i) {
      u[i] = all8(i == 0 ? 1 : 0);
      for (std::size_t k = 0; k < i; ++k) u[i] -= at(i, k) * u[k];
    }
    for (std::size_t i = 0; i < kTerms; ++i) u[i] /= at(i, i);
    for (std::size_t i = kTerms; i-- > 0;)
      for (std::size_t k = i + 1; k < kTerms; ++k) u[i] -= at(k, i) * u[k];
    return u;
  }

  void apply(const Plane& plane, const std::array<Float8, kFitTaps>& kernel, int x, int y,
             std::vector<float>& out) const {
    const Float8 own = load8(plane.row(y) + x);
    Float8 sum = own;
    std::size_t tap = 0;
    for (int dy = -kFitRadius; dy <= kFitRadius; ++dy)
      for (int dx = -kFitRadius; dx <= kFitRadius; ++dx, ++tap)
        sum = multiply_add(kernel[tap], load8(plane.row(y + dy) + x + dx) - own, sum);
    float* to = out.data() + std::size_t(y) * std::size_t(width_) + std::size_t(x);
    for (std::size_t i = 0; i < std::min(kEight, std::size_t(width_ - x)); ++i)
      to[i] = std::max(sum[i], std::min(own[i], 0.0f));
  }

  const Radiance& from_;
  const Features& features_;
  std::vector<Halves>& out_;
  int width_, height_;
  std::vector<float> weights_;  ///< by tap, row and column of the block
};

}  // namespace

std::vector<Halves> regress(const Image& image, const LightGroup& group, const Features& features) {
  const Radiance from(image, group);
  const int width = group.surfaces.width, height = group.surfaces.height;
  std::vector<Halves> out(group.layers.size());
  for (std::size_t l = 0; l < out.size(); ++l)
    for (std::size_t c = 0; c < 3; ++c)
      if (!group.raw[0].layers[l][c].empty())
        for (Colours* half : {&out[l].a, &out[l].b}) (*half)[c].resize(image.pixel_count());
  const std::size_t rows = (std::size_t(height) + kBlockRows - 1) / kBlockRows;
  parallel_chunks(rows, 1, [&](std::size_t first, std::size_t last) {
    Regression regression(from, features, out, width, height);
    for (std::size_t r = first; r < last; ++r)
      for (int x = 0; x < width; x += int(kBlockColumns)) regression.block(x, int(r * kBlockRows));
  });
  return out;
}

}  // namespace tempolux
