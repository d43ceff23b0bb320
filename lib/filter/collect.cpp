#include "lib/filter/collect.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/filter/fit.h"
#include "lib/filter/rows.h"

namespace tempolux {
namespace {

constexpr float kLost = std::numeric_limits<float>::quiet_NaN();

/// Calls body(y, x0, count) for strips of rows, in parallel.
template <class Body>
void for_each_strip(const Surfaces& of, const Body& body) {
  for_each_row(of.height, [&](int y) {
    for (std::size_t x0 = 0; x0 < std::size_t(of.width); x0 += kStrip)
      body(y, x0, std::min(kStrip, std::size_t(of.width) - x0));
  });
}

}  // namespace

struct Collector::Strip {
  int y;
  std::size_t x0, count;
};

Collector::Collector(const WindowFrame& middle, std::size_t half)
    : middle_(middle), surfaces_(middle.light->surfaces), half_(half) {
  const Light& own = middle.light->raw[half];
  const auto plane = [&] { return Plane::unset(surfaces_.width, surfaces_.height); };
  for (Plane* each : {&px_, &py_, &right_, &down_, &out_.weight, &edge_weight_}) *each = plane();
  out_.layers.resize(own.layers.size());
  for (std::size_t l = 0; l < out_.layers.size(); ++l)
    for (std::size_t c = 0; c < 3 && !own.layers[l][c].empty(); ++c) out_.layers[l][c] = plane();
  for_each_row(surfaces_.height, [&](int y) {
    const auto width = std::size_t(surfaces_.width);
    std::copy_n(own.weight.row(y), width, out_.weight.row(y));
    for (std::size_t x = 0; x < width; ++x) edge_weight_.row(y)[x] = own.weight.row(y)[x] != 0 ? 0.0f : 1.0f;
    for (std::size_t l = 0; l < out_.layers.size(); ++l)
      for (std::size_t c = 0; c < 3 && !out_.layers[l][c].empty(); ++c)
        std::copy_n(own.layers[l][c].row(y), width, out_.layers[l][c].row(y));
  });
}

void Collector::start(int direction) {
  direction_ = direction;
  for_each_row(surfaces_.height, [&](int y) {
    for (int x = 0; x < surfaces_.width; ++x) {
      const FlowFrame::Step step =
          middle_.flow->step(std::size_t(y) * std::size_t(surfaces_.width) + std::size_t(x), direction);
      right_.at(x, y) = step.right;
      down_.at(x, y) = step.down;
      px_.at(x, y) = step.known ? float(x) + step.right : kLost;
      py_.at(x, y) = float(y) + step.down;
    }
  });
}

void Collector::add(const WindowFrame& frame) {
  const std::vector<ColourPlane>& layers = frame.light->raw[half_].layers;
  for (std::size_t l = 0; l < out_.layers.size(); ++l)
    for (std::size_t c = 0; c < 3 && out_.layers[l][c].empty() && !layers[l][c].empty(); ++c)
      out_.layers[l][c] = Plane(surfaces_.width, surfaces_.height);
  for_each_strip(surfaces_, [&](int y, std::size_t x0, std::size_t count) {
    const Strip strip{y, x0, count};
    Lane weights;
    std::array<std::uint32_t, kStrip> there;
    weights.fill(1);
    follow(strip, frame, weights, there);
    add(strip, *frame.light, weights, there);
  });
}

/// Follows the strip's pixels to the frame. `there` becomes their places, as offsets from pixel (0, 0) of a plane. The
/// weights of lost pixels become 0; all others are multiplied by value_weight() of the guides.
void Collector::follow(const Strip& strip, const WindowFrame& frame, Lane& weights,
                       std::array<std::uint32_t, kStrip>& there) {
  const int y = strip.y;
  const std::size_t x0 = strip.x0, count = strip.count;
  const Surfaces& light = frame.light->surfaces;
  const float right = float(light.width) - 0.5f, bottom = float(light.height) - 0.5f;
  const auto stride = std::uint32_t(light.use.stride()), width = std::uint32_t(light.width);
  float *px = px_.row(y) + x0, *py = py_.row(y) + x0, *step_right = right_.row(y) + x0, *step_down = down_.row(y) + x0;
  Lane alive;
  std::array<std::uint32_t, kStrip> pixel;  // index into images, which have no margin
  for (std::size_t i = 0; i < count; ++i) {
    const bool inside =
        px[i] > -0.5f && py[i] > -0.5f && px[i] < right && py[i] < bottom;  // false if a coordinate is NaN
    const auto cx = std::uint32_t(inside ? int(px[i] + 0.5f) : 0), cy = std::uint32_t(inside ? int(py[i] + 0.5f) : 0);
    there[i] = cy * stride + cx;
    pixel[i] = cy * width + cx;
    alive[i] = float(inside);
  }
  const std::uint32_t *object = surfaces_.object.row(y) + x0, *object_there = light.object.row(0);
  const float *nx = surfaces_.nx.row(y) + x0, *ny = surfaces_.ny.row(y) + x0, *nz = surfaces_.nz.row(y) + x0;
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
    const float length2 =
        step_right[i] * step_right[i] + step_down[i] * step_down[i] + back.right * back.right + back.down * back.down;
    const bool returns =
        back.known && miss_right * miss_right + miss_down * miss_down <= kReturnShare * length2 + kReturnSquare;
    if (!returns) weights[i] = 0;
    px[i] = returns && on.known ? px[i] + on.right : kLost;
    py[i] += on.down;
    step_right[i] = on.right;
    step_down[i] = on.down;
  }
  const Light &guide = (*middle_.guides)[1 - half_], &guide_there = (*frame.guides)[1 - half_];
  Lane difference{}, square{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float *own = guide.guide[c].row(y) + x0, *other = guide_there.guide[c].row(0);
    for (std::size_t i = 0; i < count; ++i) {
      const float off = own[i] - other[there[i]];
      difference[i] += off * off;
      square[i] += own[i] * own[i];
    }
  }
  const float *variance = guide.guide_variance.row(y) + x0, *other_variance = guide_there.guide_variance.row(0);
  for (std::size_t i = 0; i < count; ++i)
    weights[i] *= value_weight(difference[i], variance[i] + other_variance[there[i]] + rounding_variance(square[i]));
}

/// Adds the light at the pixels' places. Light of pixels without `use` counts only until a pixel with `use` is found.
void Collector::add(const Strip& strip, const LightGroup& frame, const Lane& weights,
                    const std::array<std::uint32_t, kStrip>& there) {
  const int y = strip.y;
  const std::size_t x0 = strip.x0, count = strip.count;
  float *sum = out_.weight.row(y) + x0, *edges = edge_weight_.row(y) + x0;
  Lane kept, factor;  // factors of the previous sum and of the added light
  const float* use = frame.surfaces.use.row(0);
  for (std::size_t i = 0; i < count; ++i) {
    const bool of_use = use[there[i]] != 0, before = sum[i] > 0, counts = weights[i] > 0;
    kept[i] = counts && of_use && !before ? 0.0f : 1.0f;
    factor[i] = of_use || !before ? weights[i] : 0.0f;
    sum[i] += of_use ? weights[i] : 0.0f;
    edges[i] += of_use ? 0.0f : weights[i];
  }
  const std::vector<ColourPlane>& layers = frame.raw[half_].layers;
  for (std::size_t l = 0; l < out_.layers.size(); ++l)
    for (std::size_t c = 0; c < 3 && !out_.layers[l][c].empty(); ++c) {
      float* sums = out_.layers[l][c].row(y) + x0;
      const float* values = layers[l][c].empty() ? nullptr : layers[l][c].row(0);
      for (std::size_t i = 0; i < count; ++i) sums[i] = sums[i] * kept[i] + (values ? factor[i] * values[there[i]] : 0);
    }
}

Light Collector::take() {
  for_each_row(surfaces_.height, [&](int y) {
    for (ColourPlane& planes : out_.layers)
      for (std::size_t c = 0; c < 3 && !planes[c].empty(); ++c)
        for (int x = 0; x < surfaces_.width; ++x)
          planes[c].row(y)[x] /= out_.weight.row(y)[x] > 0 ? out_.weight.row(y)[x] : edge_weight_.row(y)[x];
  });
  return std::move(out_);
}

}  // namespace tempolux
