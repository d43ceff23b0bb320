#include "lib/material/glass_albedo.h"

#include <algorithm>
#include <cmath>

#include "lib/material/cubic_weights.h"

namespace tempolux {

GlassLoss::GlassLoss(float index, float alpha) : alpha_(std::clamp(alpha, float(albedo_table::kMinAlpha), 1.0f)) {
  index = std::clamp(index, 1.0f, 1e4f);
  critical_ = std::sqrt(1 - 1 / (index * index));
  first_[0] = cubic_weights(std::sqrt(std::clamp(1 - 1 / index, 0.0f, 1.0f)), glass_table::kPlanes, weight_[0]);
  first_[1] = cubic_weights(std::sqrt(alpha_), glass_table::kRows, weight_[1]);
}

float GlassLoss::column(int side, float cos) const {
  const auto root = [this](float c) { return std::sqrt(std::min(1.0f, c * (1 + alpha_) / (c + alpha_))); };
  if (side == 0) return root(cos);
  if (cos < critical_) return 0.5f * (1 - std::sqrt(std::max(0.0f, 1 - root(cos) / root(critical_))));
  return critical_ < 1 ? 0.5f + 0.5f * std::sqrt((cos - critical_) / (1 - critical_)) : 1;
}

float GlassLoss::at(int side, float cos_theta) const {
  const float cos = std::clamp(cos_theta, 0.0f, 1.0f);
  float across[4];
  const int column = cubic_weights(this->column(side, cos), glass_table::kColumns, across);
  float loss = 0;
  for (int p = 0; p < 4; ++p)
    for (int r = 0; r < 4; ++r) {
      const float* e = &glass_table::kLoss[side][first_[0] + p][first_[1] + r][column];
      loss +=
          weight_[0][p] * weight_[1][r] * (across[0] * e[0] + across[1] * e[1] + across[2] * e[2] + across[3] * e[3]);
    }
  return std::clamp(loss, 0.0f, 1.0f);
}

float GlassLoss::mean(int side) const {
  float mean = 0;
  for (int p = 0; p < 4; ++p)
    for (int r = 0; r < 4; ++r)
      mean += weight_[0][p] * weight_[1][r] * glass_table::kMean[side][first_[0] + p][first_[1] + r];
  return std::max(5e-5f, mean);
}

}  // namespace tempolux
