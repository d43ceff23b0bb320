#include "lib/filter/choose.h"

#include <algorithm>
#include <cmath>

#include "lib/filter/rows.h"
#include "lib/filter/surfaces.h"

namespace tempolux {
namespace {

constexpr int kAround = 3;      ///< pixels on each side in the box filter
constexpr float kDark = 0.02f;  ///< dark_of(), divided by the mean light of the picture
constexpr float kOwnLight =
    0.25f;  ///< share of a pixel's light above its surroundings that counts in PictureLight::level
/// Number of pixels whose unweighted mean has the variance of Neighbourhood::mean: 1 / sum of squared weights. In one
/// dimension two box filters of n pixels have the sum of squared weights n (2 n^2 + 1) / 3 / n^4.
constexpr float kEqualPixels = [] {
  const float n = 2 * kAround + 1, line = 3 * n * n * n / (2 * n * n + 1);
  return line * line;
}();

float squared(float v) { return v * v; }

/// Mean of the channels of a pixel. A value that is not finite counts as 0.
float light_of(const PicturePlanes& picture, std::size_t pixel) {
  float light = 0;
  for (const std::vector<float>* channel : picture)
    if (const float value = (*channel)[pixel]; std::isfinite(value))
      light += std::clamp(value, 0.0f, kLargestLight) / 3;
  return light;
}

/// Sums over the window around each pixel. With `kinds` (0 or 1, by pixel) only pixels of the window's middle pixel's
/// kind count. Rows are summed along x first; the sums of the last seven rows stay in the cache.
Plane box_sums(const Plane& values, int width, int height, const std::uint8_t* kinds = nullptr) {
  constexpr std::size_t kLines = 2 * kAround + 1, kRows = 32;  // rows of a chunk
  Plane out = Plane::unset(width, height);
  parallel_chunks(std::size_t(height), kRows, [&](std::size_t first, std::size_t last) {
    const auto columns = std::size_t(width);
    std::vector<float> of_kind(columns + 2 * kAround), lines(2 * kLines * columns);
    const auto line = [&](int y, std::size_t kind) {
      return lines.data() + (2 * (std::size_t(y + kAround) % kLines) + kind) * columns;
    };
    const auto add_along = [&](const float* row, float* to) {
      for (std::size_t x = 0; x < columns; ++x) {
        float sum = 0;
        for (std::size_t d = 0; d < kLines; ++d) sum += row[x + d];
        to[x] = sum;
      }
    };
    const auto add_across = [&](int y, std::size_t kind, const auto& put) {
      std::array<const float*, kLines> rows;
      for (std::size_t d = 0; d < kLines; ++d) rows[d] = line(y + int(d) - kAround, kind);
      for (std::size_t x = 0; x < columns; ++x) {
        float sum = 0;
        for (std::size_t d = 0; d < kLines; ++d) sum += rows[d][x];
        put(x, sum);
      }
    };
    for (int y = int(first) - kAround; y < int(last) + kAround; ++y) {
      const bool inside = y >= 0 && y < height;
      for (std::size_t kind = 0; kind < (kinds ? 2 : 1); ++kind) {
        if (!inside) std::fill_n(line(y, kind), columns, 0.0f);
        else if (!kinds) add_along(values.row(y) - kAround, line(y, kind));
        else {
          const float* from = values.row(y);
          const std::uint8_t* own = kinds + std::size_t(y) * columns;
          for (std::size_t x = 0; x < columns; ++x) of_kind[x + kAround] = own[x] == kind ? from[x] : 0.0f;
          add_along(of_kind.data(), line(y, kind));
        }
      }
      const int middle = y - kAround;
      if (middle < int(first)) continue;
      float* to = out.row(middle);
      add_across(middle, 0, [&](std::size_t x, float sum) { to[x] = sum; });
      if (!kinds) continue;
      const std::uint8_t* own = kinds + std::size_t(middle) * columns;
      add_across(middle, 1, [&](std::size_t x, float sum) { to[x] = own[x] ? sum : to[x]; });
    }
  });
  return out;
}

class Choice {
 public:
  Choice(const Halves& raw, const std::vector<Halves>& candidates, const Neighbourhood& around,
         const PictureLight& picture)
      : raw_(raw),
        candidates_(candidates),
        near_(around),
        picture_(picture),
        width_(std::size_t(around.width())),
        count_(around.count()),
        counts_(count_, 1),
        differs_(count_, 1),
        share_(around.width(), around.height()) {
    for (const std::size_t p : raw.confirmed) differs_[p] = 0;
    for (std::size_t p = 0; p < count_; ++p)
      for (std::size_t c = 0; c < 3; ++c)
        if (!(std::abs(raw.a[c][p]) < kLargestLight && std::abs(raw.b[c][p]) < kLargestLight)) counts_[p] = 0;
  }

  Halves run() {
    take_best();
    for_each_pixel([&](std::size_t p, int x, int y) {
      const float w = share(p, x, y);
      share_.at(x, y) = counts_[p] ? w : 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float a = raw_.a[c][p], b = raw_.b[c][p];
        if (counts_[p]) {
          best_.a[c][p] = a + w * (best_.a[c][p] - a);
          best_.b[c][p] = b + w * (best_.b[c][p] - b);
        } else {
          const Halves& taken = std::isfinite(mean_of(a, b)) ? raw_ : candidates_.back();
          best_.a[c][p] = taken.a[c][p];
          best_.b[c][p] = taken.b[c][p];
        }
      }
    });
    give_back();
    return std::move(best_);
  }

 private:
  /// Calls body(index, x, y) for each pixel.
  template <class Body>
  void for_each_pixel(const Body& body) const {
    for_each_row(near_.height(), [&](int y) {
      for (std::size_t x = 0; x < width_; ++x) body(std::size_t(y) * width_ + x, int(x), y);
    });
  }

  /// A - B; 0 in a pixel whose difference is no noise.
  float apart_at(std::size_t p, std::size_t c) const { return differs_[p] * (raw_.a[c][p] - raw_.b[c][p]); }

  /// Neighbourhood mean of term(pixel, colour), summed over colours and divided by the squared light of the picture;
  /// with `square` also the mean of its square.
  template <class Term>
  Plane around(const Term& term, Plane* square = nullptr) const {
    Plane values = Plane::unset(near_.width(), near_.height());
    for_each_pixel([&](std::size_t p, int x, int y) {
      const float sum = (term(p, 0) + term(p, 1) + term(p, 2)) / squared(picture_.level.at(x, y));
      values.at(x, y) = counts_[p] ? sum : 0;
    });
    Plane mean = near_.mean(values);
    if (square) {
      for_each_pixel([&](std::size_t, int x, int y) { values.at(x, y) *= values.at(x, y); });
      *square = near_.mean(values);
    }
    return mean;
  }

  /// The share of each candidate in the best candidate, by pixel.
  std::vector<Plane> take_shares() const {
    std::vector<Plane> errors, shares;
    for (const Halves& f : candidates_) {
      errors.push_back(around([&](std::size_t p, std::size_t c) {
        const float a = raw_.a[c][p], b = raw_.b[c][p], fa = f.a[c][p], fb = f.b[c][p];
        const float apart = apart_at(p, c);
        return (squared(fa + fb - a - b) - squared(apart)) / 4 + (fa - fb) * apart / 2;
      }));
      shares.emplace_back(near_.width(), near_.height());
    }
    for_each_pixel([&](std::size_t, int x, int y) {
      std::size_t best = 0;
      for (std::size_t k = 1; k < errors.size(); ++k)
        if (errors[k].at(x, y) < errors[best].at(x, y)) best = k;
      shares[best].at(x, y) = 1;
    });
    for (Plane& share : shares) share = near_.mean(share);
    return shares;
  }

  /// Mixes the candidates by their shares.
  void mix() {
    const std::vector<Plane> shares = take_shares();
    for (std::size_t c = 0; c < 3; ++c)
      for (const auto half : {&Halves::a, &Halves::b}) {
        std::vector<float>& mixed = (best_.*half)[c];
        mixed.assign(count_, 0.0f);
        for (std::size_t k = 0; k < candidates_.size(); ++k)
          for_each_pixel(
              [&](std::size_t p, int x, int y) { mixed[p] += shares[k].at(x, y) * (candidates_[k].*half)[c][p]; });
      }
  }

  /// Takes the best mixture of the candidates and estimates its squared error.
  void take_best() {
    if (candidates_.size() == 1) best_ = candidates_[0];
    else mix();
    gain_ = around(
        [&](std::size_t p, std::size_t c) {
          const float apart = apart_at(p, c);
          return (apart - (best_.a[c][p] - best_.b[c][p])) * apart / 4;
        },
        &square_);
    apart_ = around([&](std::size_t p, std::size_t c) {
      return squared(best_.a[c][p] + best_.b[c][p] - raw_.a[c][p] - raw_.b[c][p]) / 4;
    });
  }

  /// The share w of choose(). s is the standard error of a mean of kEqualPixels pixels. The factor 2 under the root
  /// takes the error of (F - M)^2 into account, which is as uncertain as V - C if A and B differ by noise alone.
  float share(std::size_t p, int x, int y) const {
    const float gain = gain_.at(x, y), apart = apart_.at(x, y);
    const float error =
        near_.kind(p) == 1 ? std::sqrt(2 * std::max(0.0f, square_.at(x, y) - squared(gain)) / kEqualPixels) : 0;
    return apart > 0 ? std::clamp((gain + error) / apart, 0.0f, 1.0f) : 0.0f;
  }

  /// Restores the sum of the layer (step 3 of choose()). Each half of a pixel gets v B(d / B(v)) with d = raw - result
  /// and v = w (filtered light + dark); B sums over 7 x 7 pixels, twice. PictureLight::dark keeps v above 0 in black
  /// pixels. share_ becomes v.
  void give_back() {
    const auto sums = [&](const Plane& values) {
      const Plane once = box_sums(values, near_.width(), near_.height());
      return box_sums(once, near_.width(), near_.height());
    };
    for_each_pixel([&](std::size_t p, int x, int y) {
      float light = 0;
      for (std::size_t c = 0; c < 3; ++c) light += std::max(mean_of(best_.a[c][p], best_.b[c][p]), 0.0f) / 3;
      if (share_.at(x, y) > 0) share_.at(x, y) *= light + picture_.dark;
    });
    const Plane weights = sums(share_);
    for (const auto half : {&Halves::a, &Halves::b})
      for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float>& raw = (raw_.*half)[c];
        std::vector<float>& result = (best_.*half)[c];
        Plane taken = Plane::unset(near_.width(), near_.height());
        for_each_pixel([&](std::size_t p, int x, int y) {
          const float off = (raw[p] - result[p]) / weights.at(x, y);
          taken.at(x, y) = share_.at(x, y) > 0 ? off : 0;
        });
        taken = sums(taken);
        for_each_pixel([&](std::size_t p, int x, int y) { result[p] += share_.at(x, y) * taken.at(x, y); });
      }
  }

  const Halves& raw_;
  const std::vector<Halves>& candidates_;
  const Neighbourhood& near_;
  const PictureLight& picture_;
  std::size_t width_, count_;
  std::vector<std::uint8_t> counts_;  ///< by pixel; 0: the pixel enters no estimate
  std::vector<float> differs_;        ///< by pixel; 0: the difference of its halves is no noise
  Halves best_;
  Plane gain_, square_, apart_;  ///< neighbourhood means of V - C, its square and (F - M)^2
  Plane share_;                  ///< w, by pixel
};

}  // namespace

Neighbourhood::Neighbourhood(std::vector<std::uint8_t> kinds, int width, int height)
    : kinds_(std::move(kinds)), width_(width), height_(height) {
  Plane ones(width, height);
  for (int y = 0; y < height; ++y) std::fill_n(ones.row(y), width, 1.0f);
  share_ = sums(ones);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) share_.at(x, y) = 1 / share_.at(x, y);
}

/// Sums over the pixels of the same kind in the window.
Plane Neighbourhood::sums(const Plane& values) const { return box_sums(values, width_, height_, kinds_.data()); }

Plane Neighbourhood::mean(const Plane& values) const {
  Plane means = sums(values);
  const auto divide = [&] {
    for_each_row(height_, [&](int y) {
      for (int x = 0; x < width_; ++x) means.row(y)[x] *= share_.row(y)[x];
    });
  };
  divide();
  means = sums(means);
  divide();
  return means;
}

Halves choose(const Halves& raw, const std::vector<Halves>& candidates, const Neighbourhood& around,
              const PictureLight& picture) {
  return Choice(raw, candidates, around, picture).run();
}

float dark_of(const PicturePlanes& picture) {
  double sum = 0;
  const std::size_t count = picture[0]->size();
  for (std::size_t p = 0; p < count; ++p) sum += double(light_of(picture, p));
  return std::max(kDark * float(sum / double(std::max<std::size_t>(1, count))), 1e-18f);
}

PictureLight::PictureLight(const PicturePlanes& picture, int width, int height, float dark_light)
    : level(width, height), dark(dark_light) {
  Plane light(width, height);
  for_each_row(height, [&](int y) {
    for (int x = 0; x < width; ++x)
      light.at(x, y) = light_of(picture, std::size_t(y) * std::size_t(width) + std::size_t(x));
  });
  for_each_row(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      float around = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) around += light.at(x + i, y + j) / 9;
      level.at(x, y) = around + kOwnLight * std::max(light.at(x, y) - around, 0.0f) + dark;
    }
  });
}

}  // namespace tempolux
