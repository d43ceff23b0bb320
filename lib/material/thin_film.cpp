#include "lib/material/thin_film.h"

#include "lib/core/sampling.h"
#include "lib/material/dielectric.h"

namespace tempolux {
namespace {

float squared(float x) { return x * x; }
float schlick(float f0, float cos) { return f0 + (1 - f0) * schlick_rise(cos); }

struct Sensitivity {
  Rgb first, second;
};

/// S(path) and S(2 path) of ThinFilm without the turn of the phase [1]; path [m]. Fit of Belcour & Barla 2017: each
/// curve of CIE 1931 is a Gaussian in the wave number (X: two of them), whose transform is a damped cosine.
Sensitivity sensitivity(float path) {
  struct Curve {
    float height, middle, variance;
  };
  static constexpr Curve kX{5.4856e-13f, 1.6810e6f, 4.3278e9f}, kViolet{9.7470e-14f, 2.2399e6f, 4.5282e9f},
      kY{4.4201e-13f, 1.7953e6f, 9.3046e9f}, kZ{5.2481e-13f, 2.2084e6f, 6.6121e9f};
  constexpr float kScale = 1 / 1.0685e-7f;
  const float phase = 2 * kPi * path;
  const auto seen = [&](const Curve& c) {
    const float scale = kScale * c.height * std::sqrt(2 * kPi * c.variance);
    const float cos = std::cos(c.middle * phase), damped = std::exp(-c.variance * phase * phase),
                damped2 = damped * damped;
    return Vec2{scale * cos * damped, scale * (2 * cos * cos - 1) * damped2 * damped2};
  };
  const auto rgb = [](float x, float y, float z) {
    return Rgb{3.2404542f * x - 1.5371385f * y - 0.4985314f * z, -0.9692660f * x + 1.8760108f * y + 0.0415560f * z,
               0.0556434f * x - 0.2040259f * y + 1.0572252f * z};
  };
  const Vec2 red = seen(kX), violet = seen(kViolet), y = seen(kY), z = seen(kZ);
  return {rgb(red.x + violet.x, y.x, z.x), rgb(red.y + violet.y, y.y, z.y)};
}

}  // namespace

ThinFilm::ThinFilm(const Schlick& plain, float factor, float index, float thickness)
    : plain_(plain), plain_share_(1 - factor), film_share_(factor * plain.f90) {
  const float t = std::clamp(thickness / 30, 0.0f, 1.0f);
  index_ = 1 + (std::clamp(index, 1.0f, 1e4f) - 1) * (t * t * (3 - 2 * t));
  path_ = std::min(2 * index_ * std::min(thickness, 1e9f) * 1e-9f, 0.01f);  // S is 0 long before a centimetre
  outer_f0_ = normal_reflectance(index_);
  for (int c = 0; c < 3; ++c) {
    const float root = std::sqrt(std::clamp(plain.f0[c] / plain.f90, 0.0f, 0.9999f)), base = (1 + root) / (1 - root);
    inner_f0_[c] = normal_reflectance(base / index_);
    sign_[c] = base < index_ ? 1 : -1;
  }
  ends_ = {at(1), plain.f90};
}

Rgb ThinFilm::at(float cos_h) const {
  const float cos = std::clamp(cos_h, 0.0f, 1.0f);
  const float cos_t = std::sqrt(std::max(0.0f, 1 - (1 - cos * cos) / squared(index_)));
  const float outer = schlick(outer_f0_, cos);
  const auto [first, second] = sensitivity(path_ * cos_t);
  Rgb f = plain_.at(cos_h) * plain_share_;
  for (int c = 0; c < 3; ++c) {
    const float film = film_reflectance(outer, schlick(inner_f0_[c], cos_t), sign_[c] * first[c], second[c]);
    f[c] += film_share_ * std::clamp(film, 0.0f, 1.0f);
  }
  return f;
}

Rgb ThinFilm::mean() const {
  Rgb difference(0.0f);  // from Schlick, whose mean is known
  for (int i = 0; i < kAngles; ++i) difference += at(cos_of(i)) - ends_.at(cos_of(i));
  return ends_.mean() + difference / kAngles;
}

float ThinFilm::mean_of_largest() const {
  const Schlick grey{Rgb(max_component(ends_.f0)), ends_.f90};
  float difference = 0;
  for (int i = 0; i < kAngles; ++i) difference += max_component(at(cos_of(i))) - grey.at(cos_of(i)).r;
  return grey.mean().r + difference / kAngles;
}

}  // namespace tempolux
