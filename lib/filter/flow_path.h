// lib/filter/flow_path.h -- where a pixel's surface point is in the frames around, followed along the pixel flow.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lib/filter/light_frame.h"
#include "lib/image/image.h"

namespace tempolux {

/// Pixel flow of one frame (formats/flow/flow.md; a frame with the channels of --channels motion will do), y down as in pictures.
/// Where only one direction is there, the other is its opposite. No flow at all: nothing moves.
struct FlowFrame {
  struct Step {
    float right = 0, down = 0;   ///< pixels
    bool known = true;
  };
  FlowFrame() = default;
  /// Copies what it needs. InputError if the size is not that of the frame, names `file`.
  FlowFrame(const Image& flow, int width, int height, const std::string& file);

  bool has_forward() const { return !forward_u_.empty(); }
  bool has_backward() const { return !backward_u_.empty(); }
  bool empty() const { return !has_forward() && !has_backward(); }
  /// direction: +1 to the next frame, -1 to the previous.
  Step step(std::size_t pixel, int direction) const;

 private:
  std::vector<float> forward_u_, forward_v_, backward_u_, backward_v_;
  std::vector<std::uint32_t> valid_;
};

/// One frame of the window.
struct WindowFrame {
  const LightFrame* light = nullptr;
  const FlowFrame* flow = nullptr;
};

/// Follows pixel (x, y) of window[from] to the frames towards `direction`, one after the other: body(frame's index in the window, x, y there)
/// for as long as the point is seen. It is not seen, or it is another point, where the nearest pixel lies outside the picture, shows another object
/// or a normal turned by more than PixelSurfaces::kSameNormal, or has come from elsewhere: the flow there and back ends more than
/// kReturn pixels, and kReturnShare of its length, from where it began.
inline constexpr float kReturn = 0.75f, kReturnShare = 0.05f;
template <class Body>
void follow(std::span<const WindowFrame> window, std::size_t from, int direction, int x, int y, const Body& body);

/// The next pixel on the way of one that is at `px`, `py` (pixel centres are whole numbers) in frame `at`; false: lost.
bool follow_step(const WindowFrame& at, const WindowFrame& next, int direction, const LightFrame& origin, std::size_t origin_x,
                 int origin_y, float& px, float& py);

inline FlowFrame::Step FlowFrame::step(std::size_t pixel, int direction) const {
  if (empty()) return {};
  const bool forward = direction > 0 ? has_forward() : !has_backward();   // which of the two is read
  const float sign = forward == (direction > 0) ? 1.0f : -1.0f;
  const float u = (forward ? forward_u_ : backward_u_)[pixel], v = (forward ? forward_v_ : backward_v_)[pixel];
  const bool known = (valid_.empty() || (valid_[pixel] & (forward ? 1u : 2u)) != 0) && std::isfinite(u) && std::isfinite(v);
  return {sign * u, -sign * v, known};
}

inline bool follow_step(const WindowFrame& at, const WindowFrame& next, int direction, const LightFrame& origin, std::size_t origin_x,
                 int origin_y, float& px, float& py) {
  const LightFrame& frame = *next.light;
  const auto width = std::size_t(frame.width);
  const auto pixel = [&](int x, int y) { return std::size_t(y) * width + std::size_t(x); };
  const FlowFrame::Step there = at.flow->step(pixel(int(px + 0.5f), int(py + 0.5f)), direction);
  px += there.right;
  py += there.down;
  // Also false for a place that is not a number.
  if (!there.known || !(px > -0.5f && py > -0.5f && px < float(frame.width) - 0.5f && py < float(frame.height) - 0.5f)) return false;
  const int x = int(px + 0.5f), y = int(py + 0.5f);
  if (origin.object.row(origin_y)[origin_x] != frame.object.at(x, y)) return false;
  const float nx = origin.nx.row(origin_y)[origin_x], ny = origin.ny.row(origin_y)[origin_x], nz = origin.nz.row(origin_y)[origin_x];
  if (nx * frame.nx.at(x, y) + ny * frame.ny.at(x, y) + nz * frame.nz.at(x, y) <
      PixelSurfaces::kSameNormal * (nx * nx + ny * ny + nz * nz))
    return false;
  const FlowFrame::Step back = next.flow->step(pixel(x, y), -direction);
  const float miss_right = there.right + back.right, miss_down = there.down + back.down;
  const float allowed = kReturn + kReturnShare * std::sqrt(there.right * there.right + there.down * there.down);
  return back.known && miss_right * miss_right + miss_down * miss_down <= allowed * allowed;
}

template <class Body>
void follow(std::span<const WindowFrame> window, std::size_t from, int direction, int x, int y, const Body& body) {
  float px = float(x), py = float(y);
  for (std::ptrdiff_t i = std::ptrdiff_t(from); i + direction >= 0 && i + direction < std::ptrdiff_t(window.size()); i += direction) {
    const auto here = std::size_t(i), next = std::size_t(i + direction);
    if (!follow_step(window[here], window[next], direction, *window[from].light, std::size_t(x), y, px, py)) return;
    body(next, int(px + 0.5f), int(py + 0.5f));
  }
}

}  // namespace tempolux
