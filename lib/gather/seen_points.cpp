#include "lib/gather/seen_points.h"

#include <cmath>

namespace tempolux {

bool Glimpse::parted_from(const Glimpse& o) const {
  if (any != o.any || object != o.object) return true;
  if (!any) return false;
  return dot(normal, o.normal) < 0.9f || std::abs(dot(normal, o.position - position)) > 2 * footprint;
}

std::vector<std::size_t> edge_pixels(const std::vector<Glimpse>& glimpses, int width, int height) {
  std::vector<std::uint8_t> edge(glimpses.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      if (glimpses[at].by_choice) edge[at] = 1;
      if (x + 1 < width && glimpses[at].parted_from(glimpses[at + 1])) edge[at] = edge[at + 1] = 1;
      const std::size_t below = at + std::size_t(width);
      if (y + 1 < height && glimpses[at].parted_from(glimpses[below])) edge[at] = edge[below] = 1;
    }
  std::vector<std::size_t> pixels;
  for (std::size_t p = 0; p < edge.size(); ++p)
    if (edge[p]) pixels.push_back(p);
  return pixels;
}

namespace {

Look look_at(std::size_t pixel, int width, Vec2 within) {
  return {float(pixel % std::size_t(width)) + within.x, float(pixel / std::size_t(width)) + within.y, {}};
}

}  // namespace

Look centre_look(std::size_t pixel, int width) { return look_at(pixel, width, {0.5f, 0.5f}); }

Look edge_look(std::size_t pixel, int width, std::uint32_t k) {
  Look look = look_at(pixel, width, kWithin[k]);
  look.random.emplace(mix64(pixel), k);
  return look;
}

}  // namespace tempolux
