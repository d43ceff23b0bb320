#include "lib/filter/flow_path.h"

#include <cmath>

#include "formats/error.h"

namespace tempolux {
namespace {

std::vector<float> samples_of(const Image& flow, const char* name) {
  const Channel* channel = flow.find(name);
  return channel ? channel->values : std::vector<float>();
}

}  // namespace

FlowFrame::FlowFrame(const Image& flow, int width, int height, const std::string& file)
    : forward_u_(samples_of(flow, "forward.u")), forward_v_(samples_of(flow, "forward.v")),
      backward_u_(samples_of(flow, "backward.u")), backward_v_(samples_of(flow, "backward.v")) {
  if (flow.width != width || flow.height != height)
    throw InputError(file + ": flow of " + std::to_string(flow.width) + "x" + std::to_string(flow.height) + " pixels, the frame has " +
                     std::to_string(width) + "x" + std::to_string(height) + "; take the flow of this frame");
  if (forward_u_.size() != forward_v_.size() || backward_u_.size() != backward_v_.size() || empty())
    throw InputError(file + ": no flow: needs the channels forward.u and forward.v, or backward.u and backward.v; make it "
                            "with frame-render --channels motion or ibr-warp --flow");
  if (const Channel* valid = flow.find("valid")) {
    valid_ = valid->ids;
    if (valid_.empty())
      for (const float v : valid->values) valid_.push_back(v > 0 ? std::uint32_t(std::min(v, 3.0f)) : 0);
  }
}

FlowFrame::Step FlowFrame::step(std::size_t pixel, int direction) const {
  if (empty()) return {};
  const bool forward = direction > 0 ? has_forward() : !has_backward();   // which of the two is read
  const float sign = forward == (direction > 0) ? 1.0f : -1.0f;
  const float u = (forward ? forward_u_ : backward_u_)[pixel], v = (forward ? forward_v_ : backward_v_)[pixel];
  const bool known = (valid_.empty() || (valid_[pixel] & (forward ? 1u : 2u)) != 0) && std::isfinite(u) && std::isfinite(v);
  return {sign * u, -sign * v, known};
}

bool follow_step(const WindowFrame& at, const WindowFrame& next, int direction, const LightFrame& origin, std::size_t origin_x,
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

}  // namespace tempolux
