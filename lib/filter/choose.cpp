#include "lib/filter/choose.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "lib/filter/rows.h"

namespace tempolux {
namespace {

int env(const char* name, int value) { return std::getenv(name) ? std::atoi(std::getenv(name)) : value; }
float envf(const char* name, float value) { return std::getenv(name) ? float(std::atof(std::getenv(name))) : value; }

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
  Choice(const Halves& raw, const std::vector<Halves>& candidates, int width, int height)
      : raw_(raw), candidates_(candidates), width_(width), height_(height), count_(raw.a[0].size()) {}

  Colours run() {
    take_scale();
    const Values of_raw = smooth([&](std::size_t p, std::size_t c) { return squared(raw_.a[c][p] - raw_.b[c][p]) / 4; });
    std::vector<Values> shares = take_shares();
    Colours out;
    for (std::size_t c = 0; c < 3; ++c) out[c].assign(count_, 0);
    Halves best;
    for (std::size_t c = 0; c < 3; ++c) {
      best.a[c] = mixed(shares, [&](const Halves& h) -> const Values& { return h.a[c]; });
      best.b[c] = mixed(shares, [&](const Halves& h) -> const Values& { return h.b[c]; });
    }
    const Values covariance = smooth([&](std::size_t p, std::size_t c) { return (best.a[c][p] - best.b[c][p]) * (raw_.a[c][p] - raw_.b[c][p]) / 4; });
    const Values apart = smooth([&](std::size_t p, std::size_t c) {
      return squared(best.a[c][p] + best.b[c][p] - raw_.a[c][p] - raw_.b[c][p]) / 4;
    });
    const float always = envf("TWALL", -1);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t p = 0; p < count_; ++p) {
        const float gain = of_raw[p] - covariance[p];
        float w = apart[p] > 0 ? std::clamp(gain / apart[p], 0.0f, 1.0f) : 0.0f;
        if (always >= 0) w = always;
        const float m = (raw_.a[c][p] + raw_.b[c][p]) / 2, f = (best.a[c][p] + best.b[c][p]) / 2;
        out[c][p] = m + w * (f - m);
      }
    return out;
  }

 private:
  /// 1 / (light around)^2.
  void take_scale() {
    Values light(count_);
    double total = 0;
    for (std::size_t p = 0; p < count_; ++p) {
      for (std::size_t c = 0; c < 3; ++c) light[p] += (raw_.a[c][p] + raw_.b[c][p]) / 6;
      total += double(light[p]);
    }
    light = smoothed(light, width_, height_, env("TSC", 2));
    const float dark = std::max(envf("TDARK", 0.02f) * float(total / double(count_)), 1e-18f);
    scale_.resize(count_);
    for (std::size_t p = 0; p < count_; ++p) scale_[p] = 1 / squared(std::max(light[p], 0.0f) + dark);
  }

  template <class Estimate>
  Values smooth(const Estimate& estimate, int radius = env("TR", 3)) const {
    Values values(count_);
    for (std::size_t p = 0; p < count_; ++p) {
      float sum = 0;
      for (std::size_t c = 0; c < 3; ++c) sum += estimate(p, c);
      values[p] = sum * scale_[p];
    }
    return smoothed(values, width_, height_, radius);
  }

  std::vector<Values> take_shares() const {
    std::vector<Values> errors;
    for (const Halves& f : candidates_)
      errors.push_back(smooth([&](std::size_t p, std::size_t c) {
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
    for (Values& share : shares) share = smoothed(share, width_, height_, env("TS", 1));
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
  int width_, height_;
  std::size_t count_;
  Values scale_;
};

}  // namespace

Colours choose(const Halves& raw, const std::vector<Halves>& candidates, int width, int height) {
  return Choice(raw, candidates, width, height).run();
}

}  // namespace tempolux
