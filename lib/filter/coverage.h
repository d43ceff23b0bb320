// lib/filter/coverage.h -- the surfaces that a pixel sees, from the channels coverage and coverage.other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// The shares of a pixel's area that its own surface and the surfaces of neighbouring pixels cover, from 16 rays
/// (formats/frames/frames.md 2). Both channels are optional.
class Coverage {
 public:
  explicit Coverage(const Image& image)
      : width_(std::size_t(image.width)), around_(ids(image, "coverage")), other_(ids(image, "coverage.other")) {}

  bool known() const { return around_ != nullptr; }
  /// Share of the pixel that shows a surface that none of the 3 x 3 pixel centres shows.
  float other(int x, int y) const { return other_ ? float(std::min((*other_)[index(x, y)], kRays)) / float(kRays) : 0; }
  /// True if any pixel has such a share.
  bool has_other() const {
    return other_ && std::any_of(other_->begin(), other_->end(), [](std::uint32_t count) { return count != 0; });
  }
  /// True if the pixel shows one surface only.
  bool is_whole(int x, int y) const { return !around_ || ((*around_)[index(x, y)] == 0 && other(x, y) == 0); }
  /// Calls body(dx, dy, share) for each neighbour whose surface this pixel shows, too; (dx, dy) is the neighbour's
  /// offset, right and down.
  template <class Body>
  void for_each_share(int x, int y, const Body& body) const {
    std::uint32_t counts = around_ ? (*around_)[index(x, y)] : 0;
    for (int n = 0; counts != 0; ++n) {
      if (n == 4) continue;  // the pixel itself
      if (counts & 15) body(n % 3 - 1, n / 3 - 1, float(counts & 15) / float(kRays));
      counts >>= 4;
    }
  }
  static constexpr std::uint32_t kRays = 16;  ///< rays by which a pixel's shares are counted

 private:
  static const std::vector<std::uint32_t>* ids(const Image& image, const char* name) {
    const Channel* channel = image.find(name);
    return channel && !channel->ids.empty() ? &channel->ids : nullptr;
  }
  std::size_t index(int x, int y) const { return std::size_t(y) * width_ + std::size_t(x); }

  std::size_t width_;
  const std::vector<std::uint32_t>*around_, *other_;
};

}  // namespace tempolux
