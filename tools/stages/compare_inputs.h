// tools/stages/compare_inputs.h -- the files that aqm-compare reads for a frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/aqm/compared.h"
#include "lib/image/pixel_flow.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// Names or patterns. The reference is one file or two halves; all other names may be "".
struct ComparedFiles {
  std::string test;
  std::vector<std::string> references;
  std::string mask, layer, relative_to, except, flow = {};
};

/// The images of one frame. Adds their files to the tool's dependencies.
class LoadedFrame {
 public:
  /// `frame` is filled into patterns; without it names are used unchanged. Throws as load_exr does.
  LoadedFrame(Tool& tool, const ComparedFiles& files, std::optional<int> frame);
  LoadedFrame(const LoadedFrame&) = delete;
  LoadedFrame& operator=(const LoadedFrame&) = delete;

  /// The result refers to this object.
  const ComparedInputs& inputs() const { return inputs_; }
  /// The flow's file, and the flow in it; nullptr without one.
  const Image* flow_image() const { return flow_ ? &flow_image_ : nullptr; }
  const PixelFlow* flow() const { return flow_ ? &*flow_ : nullptr; }
  /// Frame number of the test frame, from "tempolux:frame"; 0 if the attribute is missing.
  int frame_number() const;

 private:
  Image test_, reference_, second_, mask_, smooth_, except_, flow_image_;
  std::optional<PixelFlow> flow_;
  ComparedInputs inputs_;
};

/// Refuses frames of different states of the scene; warns once per run about frames without identity.
class IdentityGuard {
 public:
  /// With allow_stale different states only give a warning.
  IdentityGuard(Tool& tool, bool allow_stale) : tool_(tool), allow_stale_(allow_stale) {}
  /// Throws InputError naming both files and the hashes that differ.
  void check(const ComparedInputs& inputs);

 private:
  void warn_once(const std::string& message);

  Tool& tool_;
  bool allow_stale_, warned_ = false;
};

}  // namespace tempolux::tools
