#include "lib/filter/resolve.h"

#include <algorithm>

#include "lib/filter/rows.h"

namespace tempolux {
namespace {

/// The formula of resolve() at a pixel that sees several surfaces.
float composed(const EdgePlane& light, const Coverage& coverage, int x, int y, int width, int height) {
  const float unknown = coverage.other(x, y);
  float sum = unknown * light.other_at(x, y), rest = 1 - unknown;
  coverage.for_each_share(x, y, [&](int dx, int dy, float share) {
    if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) return;
    sum += share * light.own_at(x + dx, y + dy);
    rest -= share;
  });
  return sum + std::max(rest, 0.0f) * light.own_at(x, y);
}

}  // namespace

void resolve(const EdgePlane& light, const Coverage& coverage, int width, int height, std::vector<float>& values) {
  for_each_row(height, [&](int y) {
    float* to = values.data() + std::size_t(y) * std::size_t(width);
    for (int x = 0; x < width; ++x) to[x] = light.own_at(x, y);
    for (int x = 0; x < width; ++x)
      if (!coverage.is_whole(x, y)) to[x] = composed(light, coverage, x, y, width, height);
  });
}

}  // namespace tempolux
