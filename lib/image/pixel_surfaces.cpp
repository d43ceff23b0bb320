#include "lib/image/pixel_surfaces.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/core/parallel_each.h"

namespace tempolux {
namespace {

std::vector<float> channel_or_zero(const Image& image, const char* name) {
  const Channel* channel = image.find(name);
  return channel && !channel->values.empty() ? channel->values : std::vector<float>(image.pixel_count());
}

}  // namespace

PixelSurfaces::PixelSurfaces(const Image& image)
    : object(image.pixel_count()),
      w(image.pixel_count()),
      w_right(image.pixel_count()),
      w_down(image.pixel_count()),
      nx(channel_or_zero(image, "N.X")),
      ny(channel_or_zero(image, "N.Y")),
      nz(channel_or_zero(image, "N.Z")),
      width_(image.width),
      height_(image.height) {
  if (const Channel* ids = image.find("id.object"); ids && !ids->ids.empty()) object = ids->ids;
  if (const Channel* z = image.find("Z"); z && !z->values.empty())
    for (std::size_t p = 0; p < w.size(); ++p) w[p] = inverse_depth(z->values[p]);
  parallel_pixels(width_, height_, [&](int x, int y, std::size_t p) {
    const auto slope = [&](bool before, bool after, std::size_t step) {
      before = before && object[p - step] == object[p];
      after = after && object[p + step] == object[p];
      return smaller(before ? w[p] - w[p - step] : 0, before, after ? w[p + step] - w[p] : 0, after);
    };
    w_right[p] = slope(x > 0, x + 1 < width_, 1);
    w_down[p] = slope(y > 0, y + 1 < height_, std::size_t(width_));
  });
}

bool PixelSurfaces::same(std::size_t pixel, int dx, int dy) const {
  const std::size_t other = pixel + std::size_t(std::ptrdiff_t(dy) * width_ + dx);
  if (object[pixel] != object[other]) return false;
  const float facing = nx[pixel] * nx[other] + ny[pixel] * ny[other] + nz[pixel] * nz[other];
  const float length2 = nx[pixel] * nx[pixel] + ny[pixel] * ny[pixel] + nz[pixel] * nz[pixel];
  if (facing < kSameNormal * length2) return false;
  const float right = w_right[pixel] * float(dx), down = w_down[pixel] * float(dy);
  return std::abs(w[other] - w[pixel] - right - down) <= kSameDepth * w[pixel] + std::abs(right) + std::abs(down);
}

}  // namespace tempolux
