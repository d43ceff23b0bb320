#include "lib/image/pixel_surfaces.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr std::size_t kRows = 16;  ///< of a chunk

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
  const auto columns = std::size_t(width_), rows = std::size_t(height_);
  parallel_chunks(rows, kRows, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first; y < last; ++y)
      for (std::size_t x = 0; x < columns; ++x) {
        const std::size_t p = y * columns + x;
        const auto slope = [&](bool before, bool after, std::size_t step) {
          before = before && object[p - step] == object[p];
          after = after && object[p + step] == object[p];
          return smaller(before ? w[p] - w[p - step] : 0, before, after ? w[p + step] - w[p] : 0, after);
        };
        w_right[p] = slope(x > 0, x + 1 < columns, 1);
        w_down[p] = slope(y > 0, y + 1 < rows, columns);
      }
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

std::vector<std::uint8_t> PixelSurfaces::edges() const {
  std::vector<std::uint8_t> edge(w.size());
  parallel_chunks(std::size_t(height_), kRows, [&](std::size_t first, std::size_t last) {
    for (int y = int(first); y < int(last); ++y)
      for (int x = 0; x < width_; ++x) {
        const std::size_t p = std::size_t(y) * std::size_t(width_) + std::size_t(x);
        for (int j = std::max(-1, -y); j <= std::min(1, height_ - 1 - y); ++j)
          for (int i = std::max(-1, -x); i <= std::min(1, width_ - 1 - x); ++i)
            if ((i != 0 || j != 0) && !(same(p, i, j) && same(p + std::size_t(std::ptrdiff_t(j) * width_ + i), -i, -j)))
              edge[p] = 1;
      }
  });
  return edge;
}

}  // namespace tempolux
