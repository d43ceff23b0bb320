// lib/aqm/display_speed.cpp -- converts pixel flow to speeds on a display.
#include "lib/aqm/display_speed.h"

#include <algorithm>
#include <cmath>

namespace tempolux::vision {
namespace {

constexpr float kUnknown = -1;

/// Calls visit(index) for the up to 8 neighbours of pixel i.
template <class Visit>
void neighbours(const PixelFlow& flow, std::size_t i, const Visit& visit) {
  const int x = int(i % std::size_t(flow.width)), y = int(i / std::size_t(flow.width));
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, flow.height - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, flow.width - 1); ++u)
      if (u != x || v != y) visit(std::size_t(v) * std::size_t(flow.width) + std::size_t(u));
}

/// Unknown pixels get the largest speed of their known neighbours, ring by ring.
void fill_unknown(const PixelFlow& flow, std::vector<float>& speed) {
  std::vector<std::size_t> ring, next;
  std::vector<float> found;
  std::vector<bool> waiting(speed.size(), false);
  const auto wait = [&](std::size_t i) {
    neighbours(flow, i, [&](std::size_t j) {
      if (speed[j] == kUnknown && !waiting[j]) waiting[j] = true, next.push_back(j);
    });
  };
  for (std::size_t i = 0; i < speed.size(); ++i)
    if (speed[i] != kUnknown) wait(i);
  while (!next.empty()) {
    ring.swap(next);
    next.clear();
    found.assign(ring.size(), 0);
    for (std::size_t n = 0; n < ring.size(); ++n)
      neighbours(flow, ring[n], [&](std::size_t j) { found[n] = std::max(found[n], speed[j]); });
    for (std::size_t n = 0; n < ring.size(); ++n) speed[ring[n]] = found[n];
    for (const std::size_t i : ring) wait(i);
  }
  std::ranges::replace(speed, kUnknown, 0.0f);
}

}  // namespace

std::vector<float> display_speed(const PixelFlow& flow, double pixels_per_degree, double frames_per_second) {
  std::vector<float> speed(flow.valid.size(), kUnknown);
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (!flow.valid[i]) continue;
    const Vec2 motion = flow.valid[i] & forward_known ? flow.forward[i] : flow.backward[i];
    speed[i] = float(std::hypot(double(motion.x), double(motion.y)) * frames_per_second / pixels_per_degree);
  }
  if (std::ranges::find(speed, kUnknown) != speed.end()) fill_unknown(flow, speed);
  return speed;
}

}  // namespace tempolux::vision
