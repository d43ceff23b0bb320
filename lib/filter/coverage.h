// lib/filter/coverage.h -- which surfaces the pixels of a frame see: its channels coverage and coverage.other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// The two channels (formats/frames/frames.md 2), or nothing.
class Coverage {
 public:
  explicit Coverage(const Image& image)
      : width_(std::size_t(image.width)), around_(ids(image, "coverage")), other_(ids(image, "coverage.other")) {}

  bool known() const { return around_ != nullptr; }
  /// Share of the pixel that sees what no centre around shows.
  float other(int x, int y) const { return other_ ? float(std::min((*other_)[index(x, y)], kRays)) / float(kRays) : 0; }
  /// Is there any such share?
  bool has_other() const {
    return other_ && std::any_of(other_->begin(), other_->end(), [](std::uint32_t count) { return count != 0; });
  }
  /// Does the pixel see one surface?
  bool is_whole(int x, int y) const { return !around_ || ((*around_)[index(x, y)] == 0 && other(x, y) == 0); }
  /// body(dx, dy, share) for each pixel around whose surface is seen too, (dx, dy) from the pixel, right and down.
  template <class Body>
  void for_each_share(int x, int y, const Body& body) const {
    std::uint32_t counts = around_ ? (*around_)[index(x, y)] : 0;
    for (int n = 0; counts != 0; ++n) {
      if (n == 4) continue;  // the pixel itself
      if (counts & 15) body(n % 3 - 1, n / 3 - 1, float(counts & 15) / float(kRays));
      counts >>= 4;
    }
  }

 public:
  static constexpr std::uint32_t kRays = 16;  ///< of a pixel

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
