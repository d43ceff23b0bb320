#include "lib/filter/flow_path.h"

#include <algorithm>

#include "formats/error.h"

namespace tempolux {
namespace {

std::vector<float> samples_of(const Image& flow, const char* name) {
  const Channel* channel = flow.find(name);
  return channel ? channel->values : std::vector<float>();
}

}  // namespace

FlowFrame::FlowFrame(const Image& flow, int width, int height, const std::string& file)
    : forward_u_(samples_of(flow, "forward.u")),
      forward_v_(samples_of(flow, "forward.v")),
      backward_u_(samples_of(flow, "backward.u")),
      backward_v_(samples_of(flow, "backward.v")) {
  if (flow.width != width || flow.height != height)
    throw InputError(file + ": flow of " + std::to_string(flow.width) + "x" + std::to_string(flow.height) +
                     " pixels, the frame has " + std::to_string(width) + "x" + std::to_string(height) +
                     "; take the flow of this frame");
  if (forward_u_.size() != forward_v_.size() || backward_u_.size() != backward_v_.size() || empty())
    throw InputError(file +
                     ": no flow: needs the channels forward.u and forward.v, or backward.u and backward.v; make it "
                     "with frame-render --channels motion or ibr-warp --flow");
  const Channel* const valid = flow.find("valid");
  if (!valid) return;
  valid_ = valid->ids;
  if (valid_.empty())
    for (const float v : valid->values) valid_.push_back(v > 0 ? std::uint32_t(std::min(v, 3.0f)) : 0);
}

}  // namespace tempolux
