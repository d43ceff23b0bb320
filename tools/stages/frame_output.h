// tools/stages/frame_output.h -- the EXR files of one rendered frame: the mean and, if asked for, its halves.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "formats/identity.h"
#include "lib/image/exr_io.h"
#include "lib/render/frame_renderer.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// What a frame says about itself in its attributes (formats/frames/frames.md).
struct FrameDescription {
  formats::Identity identity;
  std::string history;
  int frame = 0;
  double fps = 24;
  std::array<double, 16> world_to_camera{}, world_to_ndc{};
  std::map<std::string, double> account;  ///< account_of()
  std::vector<std::string> object_names;  ///< by id.object
};

class FrameOutputs {
 public:
  /// Creates the files at once: an unwritable place is noticed before the work.
  FrameOutputs(const std::string& path, bool halves, bool no_clobber);
  /// Writes and commits all of them. `data` holds the data channels already; where there is a mask, pixels it
  /// leaves out are those of `base`.
  void write(const RenderedFrame& rendered, const Image& data, const std::vector<std::string>& channels,
             const FrameDescription& description, const ExrWriteOptions& options, const std::vector<std::uint8_t>& mask,
             const Image& base);

 private:
  std::vector<Output> outputs_;  ///< the mean, then half a and half b
};

}  // namespace tempolux::tools
