#include "lib/filter/collect.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/filter/rows.h"

namespace tempolux {
namespace {

constexpr float kLost = std::numeric_limits<float>::quiet_NaN();

/// body(y, x0, count) for strips of rows, in parallel.
template <class Body>
void for_each_strip(const LightFrame& frame, const Body& body) {
  for_each_row(frame.height, [&](int y) {
    for (std::size_t x0 = 0; x0 < std::size_t(frame.width); x0 += kStrip) body(y, x0, std::min(kStrip, std::size_t(frame.width) - x0));
  });
}

}  // namespace

struct Collector::Strip {
  int y;
  std::size_t x0, count;
};

Collector::Collector(const WindowFrame& middle, float weight, const Plane* in_time) : frame_(*middle.light), in_time_(in_time) {
  const auto plane = [&] { return Plane::unset(frame_.width, frame_.height); };
  for (Plane* each : {&px_, &py_, &right_, &down_, &out_.weight, &edge_weight_, &mean_weight_, &out_.mean_variance}) *each = plane();
  for (Plane& each : out_.mean) each = plane();
  out_.light.resize(frame_.light.size());
  for (std::size_t l = 0; l < out_.light.size(); ++l)
    for (std::size_t c = 0; c < 3 && !frame_.light[l][c].empty(); ++c) out_.light[l][c] = plane();
  for_each_strip(frame_, [&](int y, std::size_t x0, std::size_t count) {
    const auto scaled = [&](const Plane& from, float by, Plane& to) {
      const float* values = from.row(y) + x0;
      float* sums = to.row(y) + x0;
      for (std::size_t i = 0; i < count; ++i) sums[i] = by * values[i];
    };
    scaled(frame_.use, weight, out_.weight);
    for (std::size_t i = x0; i < x0 + count; ++i) edge_weight_.row(y)[i] = frame_.use.row(y)[i] != 0 ? 0 : weight;
    std::fill_n(mean_weight_.row(y) + x0, count, 1.0f);
    scaled(frame_.mean_variance, 1, out_.mean_variance);
    for (std::size_t c = 0; c < 3; ++c) scaled(frame_.mean[c], 1, out_.mean[c]);
    for (std::size_t l = 0; l < out_.light.size(); ++l)
      for (std::size_t c = 0; c < 3 && !out_.light[l][c].empty(); ++c) scaled(frame_.light[l][c], weight, out_.light[l][c]);
  });
}

void Collector::start(const FlowFrame& middle, int direction) {
  direction_ = direction;
  for_each_row(frame_.height, [&](int y) {
    for (int x = 0; x < frame_.width; ++x) {
      const FlowFrame::Step step = middle.step(std::size_t(y) * std::size_t(frame_.width) + std::size_t(x), direction);
      const bool known = step.known && (!in_time_ || in_time_->at(x, y) != 0);
      right_.at(x, y) = step.right;
      down_.at(x, y) = step.down;
      px_.at(x, y) = known ? float(x) + step.right : kLost;
      py_.at(x, y) = float(y) + step.down;
    }
  });
}

void Collector::add(const WindowFrame& frame, float weight) {
  const auto plane = [&] { return Plane(frame_.width, frame_.height); };
  for (std::size_t l = 0; l < out_.light.size(); ++l)
    for (std::size_t c = 0; c < 3 && out_.light[l][c].empty() && !frame.light->light[l][c].empty(); ++c) out_.light[l][c] = plane();
  for_each_strip(frame_, [&](int y, std::size_t x0, std::size_t count) {
    const Strip strip{y, x0, count};
    Lane weights;
    std::array<std::uint32_t, kStrip> there;
    weights.fill(weight);
    follow(strip, frame, weights, there);
    add(strip, *frame.light, weights, there);
  });
}

/// Where the strip's pixels are in the frame, as places from its pixel (0, 0); weights of those that are lost become 0, others are multiplied
/// by what their means agree.
void Collector::follow(const Strip& strip, const WindowFrame& frame, Lane& weights, std::array<std::uint32_t, kStrip>& there) {
  const int y = strip.y;
  const std::size_t x0 = strip.x0, count = strip.count;
  const LightFrame& light = *frame.light;
  const float right = float(light.width) - 0.5f, bottom = float(light.height) - 0.5f;
  const auto stride = std::uint32_t(light.use.stride()), width = std::uint32_t(light.width);
  float *px = px_.row(y) + x0, *py = py_.row(y) + x0, *step_right = right_.row(y) + x0, *step_down = down_.row(y) + x0;
  Lane alive;
  std::array<std::uint32_t, kStrip> pixel;   // in images, which have no margin
  for (std::size_t i = 0; i < count; ++i) {
    const bool inside = px[i] > -0.5f && py[i] > -0.5f && px[i] < right && py[i] < bottom;   // false for what is not a number
    const auto cx = std::uint32_t(inside ? int(px[i] + 0.5f) : 0), cy = std::uint32_t(inside ? int(py[i] + 0.5f) : 0);
    there[i] = cy * stride + cx;
    pixel[i] = cy * width + cx;
    alive[i] = float(inside);
  }
  const std::uint32_t *object = frame_.object.row(y) + x0, *object_there = light.object.row(0);
  const float *nx = frame_.nx.row(y) + x0, *ny = frame_.ny.row(y) + x0, *nz = frame_.nz.row(y) + x0;
  const float *nx_there = light.nx.row(0), *ny_there = light.ny.row(0), *nz_there = light.nz.row(0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t at = there[i];
    const float facing = nx[i] * nx_there[at] + ny[i] * ny_there[at] + nz[i] * nz_there[at];
    const float length2 = nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i];
    alive[i] *= float(object[i] == object_there[at]) * float(facing >= PixelSurfaces::kSameNormal * length2);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (alive[i] == 0) {
      px[i] = kLost;
      weights[i] = 0;
      continue;
    }
    const FlowFrame::Step back = frame.flow->step(pixel[i], -direction_), on = frame.flow->step(pixel[i], direction_);
    const float miss_right = step_right[i] + back.right, miss_down = step_down[i] + back.down;
    const float allowed = kReturn + kReturnShare * std::sqrt(step_right[i] * step_right[i] + step_down[i] * step_down[i]);
    const bool returns = back.known && miss_right * miss_right + miss_down * miss_down <= allowed * allowed;
    if (!returns) weights[i] = 0;
    px[i] = returns && on.known ? px[i] + on.right : kLost;
    py[i] += on.down;
    step_right[i] = on.right;
    step_down[i] = on.down;
  }
  if (frame_.noise == NoiseKnowledge::none) return;
  Lane difference{}, square{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float *own = frame_.mean[c].row(y) + x0, *other = light.mean[c].row(0);
    for (std::size_t i = 0; i < count; ++i) {
      const float off = own[i] - other[there[i]];
      difference[i] += off * off;
      square[i] += own[i] * own[i];
    }
  }
  const float *variance = frame_.mean_variance.row(y) + x0, *other_variance = light.mean_variance.row(0);
  for (std::size_t i = 0; i < count; ++i)
    weights[i] *= value_weight(difference[i], variance[i] + other_variance[there[i]] + rounding_variance(square[i]));
}

/// Adds what the pixels' places hold. Light of edges counts only as long as none of use is there.
void Collector::add(const Strip& strip, const LightFrame& frame, const Lane& weights, const std::array<std::uint32_t, kStrip>& there) {
  const int y = strip.y;
  const std::size_t x0 = strip.x0, count = strip.count;
  float *sum = out_.weight.row(y) + x0, *edges = edge_weight_.row(y) + x0, *mean_weight = mean_weight_.row(y) + x0;
  Lane kept, factor;   // of the sum of light so far, and of what is added to it
  const float* use = frame.use.row(0);
  for (std::size_t i = 0; i < count; ++i) {
    const bool of_use = use[there[i]] != 0, before = sum[i] > 0, counts = weights[i] > 0;
    kept[i] = counts && of_use && !before ? 0.0f : 1.0f;
    factor[i] = of_use || !before ? weights[i] : 0.0f;
    sum[i] += of_use ? weights[i] : 0.0f;
    edges[i] += of_use ? 0.0f : weights[i];
    mean_weight[i] += weights[i];
  }
  const auto add_plane = [&](const Plane& from, const Lane& by, Plane& to) {
    const float* values = from.row(0);
    float* sums = to.row(y) + x0;
    for (std::size_t i = 0; i < count; ++i) sums[i] += by[i] * values[there[i]];
  };
  for (std::size_t c = 0; c < 3; ++c) add_plane(frame.mean[c], weights, out_.mean[c]);
  Lane squares;
  for (std::size_t i = 0; i < count; ++i) squares[i] = weights[i] * weights[i];
  add_plane(frame.mean_variance, squares, out_.mean_variance);
  for (std::size_t l = 0; l < out_.light.size(); ++l)
    for (std::size_t c = 0; c < 3 && !out_.light[l][c].empty(); ++c) {
      float* sums = out_.light[l][c].row(y) + x0;
      for (std::size_t i = 0; i < count; ++i) sums[i] *= kept[i];
      if (!frame.light[l][c].empty()) add_plane(frame.light[l][c], factor, out_.light[l][c]);
    }
}

Collected Collector::take() {
  for_each_strip(frame_, [&](int y, std::size_t x0, std::size_t count) {
    const float *sum = out_.weight.row(y) + x0, *edges = edge_weight_.row(y) + x0, *mean_weight = mean_weight_.row(y) + x0;
    Lane weight;
    for (std::size_t i = 0; i < count; ++i) weight[i] = sum[i] > 0 ? sum[i] : edges[i];
    for (ColourPlane& planes : out_.light)
      for (std::size_t c = 0; c < 3 && !planes[c].empty(); ++c)
        for (std::size_t i = 0; i < count; ++i) planes[c].row(y)[x0 + i] /= weight[i];
    for (Plane& mean : out_.mean)
      for (std::size_t i = 0; i < count; ++i) mean.row(y)[x0 + i] /= mean_weight[i];
    float* variance = out_.mean_variance.row(y) + x0;
    for (std::size_t i = 0; i < count; ++i) variance[i] /= mean_weight[i] * mean_weight[i];
  });
  return std::move(out_);
}

}  // namespace tempolux
