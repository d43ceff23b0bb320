#include "lib/filter/resolve.h"

#include <algorithm>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr std::size_t kRows = 16;   ///< of a chunk
constexpr int kNear = 2;            ///< pixels

template <class Body>
void for_each_row(int height, const Body& body) {
  parallel_chunks(std::size_t(height), kRows, [&](std::size_t first, std::size_t last) {
    for (int y = int(first); y < int(last); ++y) body(y);
  });
}

}  // namespace

Plane resolved(const Plane& own, const Plane& other, const Coverage& coverage, int width, int height) {
  Plane out = own;
  for_each_row(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      if (coverage.is_whole(x, y)) continue;
      const float unknown = coverage.other(x, y);
      float sum = unknown * other.at(x, y), rest = 1 - unknown;
      coverage.for_each_share(x, y, [&](int dx, int dy, float share) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) return;
        sum += share * own.at(x + dx, y + dy);
        rest -= share;
      });
      out.at(x, y) = sum + std::max(rest, 0.0f) * own.at(x, y);
    }
  });
  return out;
}

void resolve_passing(const LightFrame& frame, const Coverage& coverage, Plane& plane) {
  Plane own = plane;
  for_each_row(frame.height, [&](int y) {
    for (int x = 0; x < frame.width; ++x) {
      if (frame.inside.at(x, y) != 0) continue;
      float sum = 0, count = 0;
      for (int dy = -kNear; dy <= kNear; ++dy)
        for (int dx = -kNear; dx <= kNear; ++dx)
          if (frame.has_pixel(x + dx, y + dy) && frame.inside.at(x + dx, y + dy) != 0 && frame.on_surface(x, y, dx, dy)) {
            sum += plane.at(x + dx, y + dy);
            count += 1;
          }
      if (count > 0) own.at(x, y) = sum / count;
    }
  });
  plane = resolved(own, own, coverage, frame.width, frame.height);
}

}  // namespace tempolux
