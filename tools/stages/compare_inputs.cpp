// tools/stages/compare_inputs.cpp -- loads the frames of a comparison and checks that they show the same scene.
#include "tools/stages/compare_inputs.h"

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"

namespace tempolux::tools {

LoadedFrame::LoadedFrame(Tool& tool, const ComparedFiles& files, std::optional<int> frame) {
  const auto load = [&](const std::string& pattern, Image& image) -> NamedImage {
    const std::string file = frame ? frame_name(pattern, *frame) : pattern;
    image = load_exr(file, {.allow_nan = true});  // pixels that do not count may have any value
    tool.depends_on(file);
    return {&image, file};
  };
  inputs_.layer = files.layer;
  inputs_.test = load(files.test, test_);
  inputs_.reference = load(files.references.at(0), reference_);
  if (files.references.size() > 1) inputs_.second = load(files.references[1], second_);
  if (!files.relative_to.empty()) inputs_.smooth = load(files.relative_to, smooth_);
  if (!files.mask.empty()) inputs_.mask = load(files.mask, mask_);
  if (!files.except.empty()) inputs_.except = load(files.except, except_);
  if (!files.flow.empty()) {
    const NamedImage file = load(files.flow, flow_image_);
    flow_ = flow_in(flow_image_, file.name);
  }
}

int LoadedFrame::frame_number() const {
  const auto found = test_.numbers.find("tempolux:frame");
  const bool whole = found != test_.numbers.end() && found->second >= -1e8 && found->second <= 1e8;
  return whole ? int(found->second) : 0;
}

void IdentityGuard::check(const ComparedInputs& inputs) {
  for (const NamedImage* reference : {&inputs.reference, &inputs.second, &inputs.smooth}) {
    if (!reference->image) continue;
    const formats::Identity test = identity_in(*inputs.test.image), other = identity_in(*reference->image);
    const std::string different = formats::stale_concerns(test, other);
    const std::string pair = inputs.test.name + " and " + reference->name;
    if (!different.empty() && !allow_stale_)
      throw InputError(pair + ": made for different states of the scene (" + different +
                       "); render one of them again, or give --allow-stale");
    if (!different.empty()) warn_once(pair + ": different states of the scene: " + different);
    if (!test.known() || !other.known()) warn_once(pair + ": do not both say which scene they show; compared unseen");
  }
}

void IdentityGuard::warn_once(const std::string& message) {
  if (!warned_) tool_.warn(message);
  warned_ = true;
}

}  // namespace tempolux::tools
