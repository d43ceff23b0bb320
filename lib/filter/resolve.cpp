#include "lib/filter/resolve.h"

#include <algorithm>

#include "lib/filter/rows.h"

namespace tempolux {
namespace {

/// The formula of resolve() at a pixel that sees several surfaces. own(x, y) and other are radiances of surfaces.
template <class Own>
float composed(const Own& own, float other, const Coverage& coverage, int x, int y, int width, int height) {
  const float unknown = coverage.other(x, y);
  float sum = unknown * other, rest = 1 - unknown;
  coverage.for_each_share(x, y, [&](int dx, int dy, float share) {
    if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) return;
    sum += share * own(x + dx, y + dy);
    rest -= share;
  });
  return sum + std::max(rest, 0.0f) * own(x, y);
}

}  // namespace

void resolve(const EdgePlane& light, const Coverage& coverage, int width, int height, std::vector<float>& values) {
  const auto own = [&](int x, int y) { return light.own_at(x, y); };
  for_each_row(height, [&](int y) {
    float* to = values.data() + std::size_t(y) * std::size_t(width);
    for (int x = 0; x < width; ++x) to[x] = light.own_at(x, y);
    for (int x = 0; x < width; ++x)
      if (!coverage.is_whole(x, y)) to[x] = composed(own, light.other_at(x, y), coverage, x, y, width, height);
  });
}

}  // namespace tempolux
