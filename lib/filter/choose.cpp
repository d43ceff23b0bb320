#include "lib/filter/choose.h"

#include <algorithm>
#include <cmath>

#include "lib/filter/light_frame.h"
#include "lib/filter/rows.h"

namespace tempolux {
namespace {

constexpr int kAround = 2;          ///< pixels: estimates are means over 5 x 5 pixels of a kind, twice
constexpr float kDark = 0.02f;      ///< of the layer's mean: darker light counts as if it were so bright
constexpr float kOwnNoise = 0.25f;   ///< share of a pixel's own noise in its scale
constexpr std::uint8_t kNoNumber = 2;   ///< kind of pixels that no estimate counts: a half is not finite, or too bright for squares

using Values = std::vector<float>;

/// Means over the pixels of the picture within `radius`.
Values smoothed(const Values& values, int width, int height, int radius) {
  Values rows(values.size()), out(values.size());
  const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
  for_each_row(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const int first = std::max(0, x - radius), last = std::min(width - 1, x + radius);
      float sum = 0;
      for (int i = first; i <= last; ++i) sum += values[at(i, y)];
      rows[at(x, y)] = sum / float(last - first + 1);
    }
  });
  for_each_row(height, [&](int y) {
    const int first = std::max(0, y - radius), last = std::min(height - 1, y + radius);
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int j = first; j <= last; ++j) sum += rows[at(x, j)];
      out[at(x, y)] = sum / float(last - first + 1);
    }
  });
  return out;
}

float squared(float v) { return v * v; }

class Choice {
 public:
  Choice(const Halves& raw, const std::vector<Halves>& candidates, const std::vector<std::uint8_t>& kinds, int width, int height)
      : raw_(raw), candidates_(candidates), kinds_(kinds), width_(width), height_(height), count_(kinds.size()) {
    for (std::size_t p = 0; p < count_; ++p)
      for (std::size_t c = 0; c < 3; ++c)
        if (!(std::abs(raw.a[c][p]) < kLargestLight && std::abs(raw.b[c][p]) < kLargestLight)) kinds_[p] = kNoNumber;
  }

  Colours run() {
    take_scale();
    const Values of_raw = around([&](std::size_t p, std::size_t c) { return squared(raw_.a[c][p] - raw_.b[c][p]) / 4; });
    const std::vector<Values> shares = take_shares();
    Halves best;
    for (std::size_t c = 0; c < 3; ++c) {
      best.a[c] = mixed(shares, [&](const Halves& h) -> const Values& { return h.a[c]; });
      best.b[c] = mixed(shares, [&](const Halves& h) -> const Values& { return h.b[c]; });
    }
    const Values covariance =
        around([&](std::size_t p, std::size_t c) { return (best.a[c][p] - best.b[c][p]) * (raw_.a[c][p] - raw_.b[c][p]) / 4; });
    const Values apart =
        around([&](std::size_t p, std::size_t c) { return squared(best.a[c][p] + best.b[c][p] - raw_.a[c][p] - raw_.b[c][p]) / 4; });
    Colours out;
    for (std::size_t c = 0; c < 3; ++c) {
      out[c].resize(count_);
      for (std::size_t p = 0; p < count_; ++p) {
        const float w = apart[p] > 0 ? std::clamp((of_raw[p] - covariance[p]) / apart[p], 0.0f, 1.0f) : 0.0f;
        const float m = (raw_.a[c][p] + raw_.b[c][p]) / 2, f = (best.a[c][p] + best.b[c][p]) / 2;
        out[c][p] = kinds_[p] != kNoNumber ? m + w * (f - m) : std::isfinite(m) ? m : (candidates_.back().a[c][p] + candidates_.back().b[c][p]) / 2;
      }
    }
    return out;
  }

 private:
  /// 1 / (light around + part of the pixel's own noise)^2.
  void take_scale() {
    Values light(count_);
    double total = 0;
    for (std::size_t p = 0; p < count_; ++p) {
      if (kinds_[p] == kNoNumber) continue;
      for (std::size_t c = 0; c < 3; ++c) light[p] += (raw_.a[c][p] + raw_.b[c][p]) / 6;
      total += double(light[p]);
    }
    light = smoothed(light, width_, height_, kAround);
    const float dark = std::max(kDark * float(total / double(count_)), 1e-18f);
    scale_.resize(count_);
    for (std::size_t p = 0; p < count_; ++p) {
      float noise = 0;
      for (std::size_t c = 0; c < 3; ++c) noise += std::abs(raw_.a[c][p] - raw_.b[c][p]) / 6;
      scale_[p] = 1 / squared(std::max(light[p], 0.0f) + dark + kOwnNoise * noise);
    }
  }

  /// Sums over colours, scaled, as means of what is around.
  template <class Estimate>
  Values around(const Estimate& estimate) const {
    Values values(count_);
    for (std::size_t p = 0; p < count_; ++p) {
      if (kinds_[p] == kNoNumber) continue;
      float sum = 0;
      for (std::size_t c = 0; c < 3; ++c) sum += estimate(p, c);
      values[p] = sum * scale_[p];
    }
    return of_kind(std::move(values));
  }

  /// Means over pixels around of the same kind, twice: near ones count more.
  Values of_kind(Values values) const {
    for (int pass = 0; pass < 2; ++pass) {
      Values out(count_);
      for (std::uint8_t kind = 0; kind < 2; ++kind) {
        Values masked(count_), weight(count_);
        for (std::size_t p = 0; p < count_; ++p)
          if (kinds_[p] == kind) masked[p] = values[p], weight[p] = 1;
        masked = smoothed(masked, width_, height_, kAround);
        weight = smoothed(weight, width_, height_, kAround);
        for (std::size_t p = 0; p < count_; ++p)
          if (kinds_[p] == kind) out[p] = masked[p] / weight[p];
      }
      values = std::move(out);
    }
    return values;
  }

  /// Of each candidate the share that it has in the best one.
  std::vector<Values> take_shares() const {
    std::vector<Values> errors;
    for (const Halves& f : candidates_)
      errors.push_back(around([&](std::size_t p, std::size_t c) {
        const float a = raw_.a[c][p], b = raw_.b[c][p];
        return (squared(f.a[c][p] - b) + squared(f.b[c][p] - a) - squared(a - b)) / 2 - squared(f.a[c][p] - f.b[c][p]) / 4;
      }));
    std::vector<Values> shares(errors.size(), Values(count_, 0));
    for (std::size_t p = 0; p < count_; ++p) {
      std::size_t best = 0;
      for (std::size_t k = 1; k < errors.size(); ++k)
        if (errors[k][p] < errors[best][p]) best = k;
      shares[best][p] = 1;
    }
    for (Values& share : shares) share = of_kind(std::move(share));
    return shares;
  }

  template <class Of>
  Values mixed(const std::vector<Values>& shares, const Of& of) const {
    Values out(count_, 0);
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      const Values& from = of(candidates_[k]);
      for (std::size_t p = 0; p < count_; ++p) out[p] += shares[k][p] * from[p];
    }
    return out;
  }

  const Halves& raw_;
  const std::vector<Halves>& candidates_;
  std::vector<std::uint8_t> kinds_;
  int width_, height_;
  std::size_t count_;
  Values scale_;
};

}  // namespace

Colours choose(const Halves& raw, const std::vector<Halves>& candidates, const std::vector<std::uint8_t>& kinds, int width, int height) {
  return Choice(raw, candidates, kinds, width, height).run();
}

}  // namespace tempolux
