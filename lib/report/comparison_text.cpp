// lib/report/comparison_text.cpp -- formats a comparison as a table.
#include <algorithm>
#include <cmath>

#include "lib/core/formatted.h"
#include "lib/report/comparison.h"

namespace tempolux {
namespace {

/// A figure in 10 columns, a blank first; "-" if it does not exist.
std::string cell(std::optional<double> value, const char* pattern = "%10.4g") {
  if (!value) return "         -";
  const std::string text = formatted(pattern, *value);
  return text.starts_with(' ') ? text : formatted("%10.2g", *value);
}

std::optional<double> value_of(const std::optional<Estimate>& estimate, double scale = 1) {
  return estimate ? std::optional(estimate->value * scale) : std::nullopt;
}

std::optional<double> standard_error_of(const std::optional<Estimate>& estimate, double scale = 1) {
  return estimate && estimate->standard_error ? std::optional(*estimate->standard_error * scale) : std::nullopt;
}

std::string error_line(const std::string& name, const FrameError& error) {
  return formatted("%-8s", name.c_str()) + cell(error.squared_error.root()) +
         cell(error.squared_error.root_standard_error()) + cell(value_of(error.relative_squared_error)) +
         cell(value_of(error.bias, 100), "%10.3f") + cell(standard_error_of(error.bias, 100), "%10.3f") +
         cell(error.psnr_db, "%10.2f") + "\n";
}

/// A note for readers who quote a root mean square.
std::string caveat(const std::string& name, const SquaredFigure& figure) {
  if (figure.resolved()) return "";
  const std::string standard_error =
      figure.squared.standard_error ? formatted("%.3g", *figure.squared.standard_error) : "unknown";
  const std::string square = formatted("%s: mean square %.3g, standard error ", name.c_str(), figure.squared.value);
  if (figure.squared.value < 0) return square + standard_error + ": below what the reference resolves, reported as 0\n";
  if (figure.squared.value == 0) return "";
  return square + standard_error + ": not below a third of it, the figure is not settled\n";
}

std::string worst_objects(const std::vector<ObjectError>& objects, const ObjectNames& names) {
  constexpr std::size_t kShown = 6;
  std::vector<ObjectError> judged;
  for (const ObjectError& object : objects)
    if (object.bias && !object.few_pixels) judged.push_back(object);
  std::ranges::stable_sort(judged, std::ranges::greater{},
                           [](const ObjectError& object) { return std::abs(object.bias->value); });
  std::string text;
  if (!judged.empty()) text = formatted("%-8s%10s%10s%10s%10s\n", "object", "pixels", "bias %", "+-", "share %");
  for (std::size_t i = 0; i < std::min(judged.size(), kShown); ++i) {
    const ObjectError& object = judged[i];
    text += formatted("%-8u%10llu", object.id, static_cast<unsigned long long>(object.pixels)) +
            cell(value_of(object.bias, 100), "%10.3f") + cell(standard_error_of(object.bias, 100), "%10.3f") +
            cell(100 * object.share_of_squared_error, "%10.1f") +
            (names.contains(object.id) ? "  " + names.at(object.id) : "") + "\n";
  }
  if (judged.size() > kShown) text += formatted("and %zu objects with less bias\n", judged.size() - kShown);
  if (judged.size() < objects.size())
    text += formatted("%zu objects not shown: too few pixels, or no light on them\n", objects.size() - judged.size());
  return text;
}

/// AQM by frame and object, and the assumptions about the viewer.
std::string quality_text(const Comparison& comparison) {
  const AnimationQuality& total = *comparison.quality;
  const VisionOptions& viewing = *comparison.viewing;
  std::string text;
  if (comparison.frames.size() > 1)
    for (const Comparison::Frame& frame : comparison.frames)
      text += formatted("frame %d: AQM %.2f %%\n", frame.frame, 100 * frame.quality->all.share());
  text += formatted("AQM %.2f %%: %llu of %llu pixels are seen to differ (P > %.2f)\n", 100 * total.all.share(),
                    static_cast<unsigned long long>(total.all.seen), static_cast<unsigned long long>(total.all.pixels),
                    vision::kSeenProbability);
  std::vector<std::pair<std::uint32_t, SeenShare>> objects(total.objects.begin(), total.objects.end());
  std::ranges::stable_sort(objects, std::ranges::greater{}, [](const auto& object) { return object.second.seen; });
  for (std::size_t i = 0; i < std::min<std::size_t>(objects.size(), 3) && objects[i].second.seen; ++i)
    text += "  " + object_in_words(objects[i].first, comparison.object_names) +
            formatted(": %.2f %% of its pixels, %.1f %% of those seen\n", 100 * objects[i].second.share(),
                      100 * double(objects[i].second.seen) / double(total.all.seen));
  return text +
         formatted("display %s, %g cd/m2, %.1f pixels/degree, exposure %+.2f stops, eyes %s at %g frames/s; ",
                   viewing.display.name.c_str(), viewing.display.peak, viewing.display.pixels_per_degree,
                   viewing.exposure_stops, viewing.gaze == vision::Gaze::track ? "track" : "fixed",
                   viewing.frames_per_second) +
         (comparison.flow.empty() ? "no flow: judged as a still picture" : "flow " + comparison.flow) + "\n";
}

}  // namespace

std::string comparison_text(const Comparison& comparison) {
  const FrameError& total = comparison.total;
  std::string text = comparison.test + (comparison.mode == ComparisonMode::own_halves ? " and " : " against ");
  for (std::size_t i = 0; i < comparison.references.size(); ++i) text += (i ? " + " : "") + comparison.references[i];
  text +=
      formatted("\nlayer %s, %dx%d, %llu pixels counted\n", comparison.layer.empty() ? "RGB" : comparison.layer.c_str(),
                comparison.width, comparison.height, static_cast<unsigned long long>(total.pixels));

  text += formatted("%-8s%10s%10s%10s%10s%10s%10s\n", "frame", "RMSE", "+-", "relMSE", "bias %", "+-", "PSNR dB");
  for (const Comparison::Frame& frame : comparison.frames) text += error_line(std::to_string(frame.frame), frame.error);
  if (comparison.frames.size() > 1) text += error_line("all", total);
  if (comparison.flicker) {
    text += formatted("flicker %10.4g", comparison.flicker->root()) + cell(comparison.flicker->root_standard_error()) +
            "\n";
    text += caveat("flicker", *comparison.flicker);
  }
  if (total.largest.value == 0) text += "no sample differs\n";
  else
    text += formatted("largest difference %.4g in channel %s at column %d, row %d of frame %d; mean difference %.4g\n",
                      total.largest.value, total.largest.channel.empty() ? "Y" : total.largest.channel.c_str(),
                      total.largest.x, total.largest.y, total.largest.frame, total.mean_difference.value);
  text += worst_objects(total.objects, comparison.object_names);
  if (comparison.quality) text += quality_text(comparison);
  if (comparison.mode == ComparisonMode::own_halves)
    return text + formatted("noise of the mean of the two halves: RMS %.4g\n", noise_of_mean(total).root());
  text += caveat("RMSE", total.squared_error);
  if (total.reference_noise)
    text += formatted("noise of the reference: RMS %.4g, not part of the RMSE\n", *total.reference_noise);
  else text += "one reference: its noise is part of the RMSE\n";
  if (!total.bias) text += "the reference is black: no relMSE, no bias\n";
  return text;
}

}  // namespace tempolux
