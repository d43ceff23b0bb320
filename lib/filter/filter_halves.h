// lib/filter/filter_halves.h -- a frame whose samples come in halves: filtered where the halves prove that it pays.
#pragma once

#include <array>
#include <memory>

#include "lib/filter/filter_frame.h"

namespace tempolux {

/// Does the image hold the halves of a matte layer (frame-render --channels halves)?
bool has_halves(const Image& image);

/// A frame with halves as the filter sees it: by group of layers and by half.
class FrameHalves {
 public:
  /// Layers that share surfaces: matte light by what the pixel sees; emission and specular by what mirrors and glass show (channels seen.*).
  static constexpr std::size_t kGroups = 2;
  /// The image's halves become those of its layers as they are, after outliers were spread.
  explicit FrameHalves(Image& image);
  /// Are halves of the group there? Of frames around the middle one the first group alone is read.
  bool has(std::size_t group) const { return views_[group][0] != nullptr; }
  const LightFrame& view(std::size_t group, std::size_t half) const { return *views_[group][half]; }

 private:
  std::array<std::array<std::unique_ptr<LightFrame>, 2>, kGroups> views_;
};

/// FrameFilter for frames with halves. Each half is filtered by itself, with small and with large windows, alone and with the frames around; which pixels
/// count is decided by the other half's light, so that light is lost or won by no pixel's noise. choose() mixes the result with the raw samples.
class HalvesFilter {
 public:
  /// As FrameFilter. middle and flow outlive this.
  HalvesFilter(const FrameHalves& middle, const FlowFrame& flow, std::size_t before, std::size_t after, const FilterOptions& options);
  ~HalvesFilter();
  void add(const FrameHalves& frame, const FlowFrame& flow);
  Image finish(Image image);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tempolux
