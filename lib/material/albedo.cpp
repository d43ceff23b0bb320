#include "lib/material/albedo.h"

#include <algorithm>
#include <cmath>

#include "lib/material/cubic_weights.h"

namespace tempolux {
namespace {

constexpr float kFirstRoot = 0.14142136f;  // albedo_table::kMinAlpha^(1/4)

}  // namespace

GgxAlbedo::GgxAlbedo(float alpha) : alpha_(std::clamp(alpha, float(albedo_table::kMinAlpha), 1.0f)) {
  const float position = (std::sqrt(std::sqrt(alpha_)) - kFirstRoot) / (1 - kFirstRoot);
  row_ = cubic_weights(std::clamp(position, 0.0f, 1.0f), albedo_table::kRows, weight_);
}

AlbedoPair GgxAlbedo::at(float cos_theta) const {
  const float cos = std::clamp(cos_theta, 0.0f, 1.0f), sum = cos + alpha_;
  float across[4];
  const int column = cubic_weights(std::sqrt(std::min(1.0f, cos * (1 + alpha_) / sum)), albedo_table::kColumns, across);
  float totals[4], ms[4];  // the compiler computes four rows at once, since rows lie side by side
  const float(*e)[albedo_table::kRows] = &albedo_table::kTotal[column];
  const float(*c)[albedo_table::kRows] = &albedo_table::kCosine[column];
  for (int r = 0; r < 4; ++r) {
    const int i = row_ + r;
    totals[r] = weight_[r] * (across[0] * e[0][i] + across[1] * e[1][i] + across[2] * e[2][i] + across[3] * e[3][i]);
    ms[r] = weight_[r] * (across[0] * c[0][i] + across[1] * c[1][i] + across[2] * c[2][i] + across[3] * c[3][i]);
  }
  return albedo_table::split(totals[0] + totals[1] + totals[2] + totals[3], ms[0] + ms[1] + ms[2] + ms[3], sum);
}

AlbedoPair GgxAlbedo::mean() const {
  AlbedoPair sum;
  for (int r = 0; r < 4; ++r) {
    sum.a += weight_[r] * albedo_table::kMeanA[row_ + r];
    sum.b += weight_[r] * albedo_table::kMeanB[row_ + r];
  }
  return sum;
}

}  // namespace tempolux
