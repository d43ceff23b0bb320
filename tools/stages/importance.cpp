#include "tools/stages/importance.h"

#include "lib/plan/view_of.h"

namespace tempolux::tools {

Importance::Importance(Tool& tool, SceneInput& input, const std::string& option, std::string kinds)
    : tool_(tool), input_(input), own_(option.empty()), kinds_(std::move(kinds)) {
  if (own_ || option == "none") return;
  tool.depends_on(option);
  given_ = formats::read_view(option);
}

const formats::View& Importance::at(int frame) {
  if (!own_) return given_;
  const int inside = frame_in_animation(input_.scene(), frame, input_.time());
  const Segment segment = segment_of(input_.scene(), inside, input_.time());
  const auto [found, is_new] =
      found_.try_emplace(segment.first);  // segments of a shot without media have the same view
  if (!is_new) return found->second;
  const int camera = input_.scene().camera_node(tool_.common().camera);
  const int asked[] = {inside};
  const Plan plan = make_plan(input_.scene(), asked, camera, input_.time());
  const SceneSource source{[&](int f, bool with_media) { return input_.at(f, with_media); },
                           [&](int f) { return input_.emission(f); }, camera};
  const Wish usual;  // default picture size, of which only the aspect ratio counts
  StaticTree tree;
  const std::string text =
      view_of(frames_of(input_.has_media() ? plan.segments : plan.shot), kinds_, usual, source, tree);
  if (!text.empty()) found->second = formats::parse_view(text, "what the camera sees");
  return found->second;
}

}  // namespace tempolux::tools
