// tools/stages/frame_output.h -- writes the EXR files of one rendered frame: the mean and, on request, its halves.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "formats/identity.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "lib/render/frame_renderer.h"
#include "lib/render/still_pixels.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// The attributes of a frame (formats/frames/frames.md), and what is written of it.
struct FrameDescription {
  formats::Identity identity;
  std::string history;
  int frame = 0;
  double fps = 24;
  CameraMatrices camera;
  std::map<std::string, double> account;  ///< account_of()
  std::vector<std::string> object_names;  ///< by id.object
  std::vector<std::string> channels;      ///< groups
  ExrWriteOptions exr;
};

/// The pixels that another frame gives.
struct KeptPixels {
  const std::vector<std::uint8_t>& anew;  ///< by pixel: 0 if `from` gives it; empty: no pixel is kept
  const Image& from;
  const StillPixels* change = nullptr;  ///< the change that is added to the kept pixels; null: none
};

class FrameOutputs {
 public:
  /// Creates the files at once, so that an unwritable place is reported before the work.
  FrameOutputs(const std::string& path, bool halves);
  /// Writes and commits all files. `data` holds the data channels already.
  void write(const RenderedFrame& rendered, Image data, const FrameDescription& description, const KeptPixels& kept);

 private:
  std::vector<Output> outputs_;  ///< the mean, then half a and half b
};

}  // namespace tempolux::tools
