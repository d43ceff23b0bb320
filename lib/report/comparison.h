// lib/report/comparison.h -- a comparison of frames as JSON for machines and as a table for people.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/aqm/animation_quality.h"
#include "lib/aqm/frame_error.h"
#include "lib/image/object_names.h"

namespace tempolux {

/// Kind of the reference.
enum class ComparisonMode {
  one_reference,     ///< one picture, whose noise is part of every squared error
  reference_halves,  ///< two independent halves, whose noise cancels
  own_halves         ///< test and reference are two halves of one image: their difference is its noise
};

/// A comparison of a frame or a sequence with its reference, as in formats/comparison/comparison.md.
struct Comparison {
  std::string command;                  ///< the tool's line of history
  std::string test;                     ///< file or pattern, as on the command line
  std::vector<std::string> references;  ///< one or two
  std::string relative_to;              ///< file or pattern of the picture in relMSE's denominator; "": the reference
  ComparisonMode mode = ComparisonMode::one_reference;
  std::string layer;  ///< "" is RGB
  std::vector<std::string> channels;
  int width = 0, height = 0;
  struct Frame {
    int frame = 0;
    FrameError error;
    std::optional<AnimationQuality> quality;  ///< AQM, if requested
  };
  std::vector<Frame> frames;
  FrameError total;                         ///< over all frames
  std::optional<SquaredFigure> flicker;     ///< empty for a single frame
  std::optional<AnimationQuality> quality;  ///< AQM over all frames
  std::optional<VisionOptions> viewing;     ///< assumptions about the viewer, if there is AQM
  std::string flow;                         ///< file or pattern; "": no flow, nothing moves
  ObjectNames object_names;                 ///< names in the judged frames
};

/// Collects the frames of a comparison, one in memory at a time.
class ComparisonBuilder {
 public:
  /// `comparison` holds what is given in advance: command, names, mode, layer.
  explicit ComparisonBuilder(Comparison comparison) : comparison_(std::move(comparison)) {}
  /// Adds a frame. Throws InputError if its size or channels differ from the earlier frames'.
  void add(const Compared& pair, int frame, const std::string& name);
  /// Adds the names of objects of a frame.
  void add(const ObjectNames& names) { comparison_.object_names.insert(names.begin(), names.end()); }
  /// AQM of the frame added last, with its options, which must be the same for all frames.
  void add(const AnimationQuality& quality, const VisionOptions& options);
  /// Totals over the added frames; at least one must have been added.
  Comparison finish();

 private:
  Comparison comparison_;
  std::optional<ErrorSums> total_;
  FlickerMeter flicker_;
};

/// The comparison as JSON text (formats/comparison/comparison.md). Equal comparisons give the same text.
std::string comparison_json(const Comparison& comparison);

/// A table with one line per frame, then the total, flicker, the worst objects, and notes on the figures.
std::string comparison_text(const Comparison& comparison);

}  // namespace tempolux
