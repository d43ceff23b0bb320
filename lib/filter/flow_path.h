// lib/filter/flow_path.h -- where a pixel's surface point is in the neighbouring frames.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// Pixel flow of one frame, from a flow file (formats/flow/flow.md) or from the frame's own motion channels. If only
/// one direction in time is there, the other is its opposite. Without flow nothing moves.
struct FlowFrame {
  /// Displacement of a pixel's surface point to a neighbouring frame.
  struct Step {
    float right = 0, down = 0;  ///< pixels
    bool known = true;
  };
  FlowFrame() = default;
  /// Copies the channels. Throws InputError, naming `file`, if the size is not the frame's.
  FlowFrame(const Image& flow, int width, int height, const std::string& file);

  bool has_forward() const { return !forward_u_.empty(); }
  bool has_backward() const { return !backward_u_.empty(); }
  bool empty() const { return !has_forward() && !has_backward(); }
  /// `direction`: +1 to the next frame, -1 to the previous one.
  Step step(std::size_t pixel, int direction) const;

 private:
  std::vector<float> forward_u_, forward_v_, backward_u_, backward_v_;
  std::vector<std::uint32_t> valid_;
};

/// The flow there, w, and back, b, fit together if |w + b|^2 <= kReturnShare (|w|^2 + |b|^2) + kReturnSquare [pixels^2]
/// [Sundaram, Brox, Keutzer: Dense point trajectories by GPU-accelerated large displacement optical flow, 2010, (5)].
inline constexpr float kReturnShare = 0.01f, kReturnSquare = 0.5f;

inline FlowFrame::Step FlowFrame::step(std::size_t pixel, int direction) const {
  if (empty()) return {};
  const bool forward = direction > 0 ? has_forward() : !has_backward();  // the direction that is read
  const float sign = forward == (direction > 0) ? 1.0f : -1.0f;
  const float u = (forward ? forward_u_ : backward_u_)[pixel], v = (forward ? forward_v_ : backward_v_)[pixel];
  const bool known =
      (valid_.empty() || (valid_[pixel] & (forward ? 1u : 2u)) != 0) && std::isfinite(u) && std::isfinite(v);
  return {sign * u, -sign * v, known};
}

}  // namespace tempolux
