// tools/stages/vision_options.cpp -- aqm-compare's options of viewer and display.
#include "tools/stages/vision_options.h"

#include "lib/core/formatted.h"
#include "lib/image/exr_io.h"
#include "tools/common/cli.h"
#include "tools/common/option_words.h"

namespace tempolux::tools {
namespace {

double number_attribute(const Image* image, const std::string& name, double otherwise) {
  if (!image) return otherwise;
  const auto found = image->numbers.find(name);
  return found != image->numbers.end() && found->second > 0 ? found->second : otherwise;
}

}  // namespace

void declare_vision(Tool& tool, VisionWords& w) {
  const vision::Display office = vision::display_named("office"), hdr = vision::display_named("hdr");
  tool.file_option("--flow", w.flow,
                   "pixel flow of the frame, EXR (ibr-warp): judge as a viewer would, by each pixel's own motion");
  tool.output_option(w.map, "write the probability that a difference is seen: EXR, channel P, or PNG over the frame",
                     "-o,--map");
  tool.choice_option(
      "--display", w.display, {"office", "hdr", "dark"},
      formatted("office: %g cd/m2 at %.0f pixels/degree; dark: the same in a dark room; hdr: %g cd/m2, %.0f",
                office.peak, office.pixels_per_degree, hdr.peak, hdr.pixels_per_degree));
  tool.auto_option("--exposure", w.exposure_stops, -200, 200,
                   "stops, as of tempolux-info --png; auto: the first frame's, for the whole sequence")
      ->type_name("STOPS");
  tool.choice_option("--eye", w.eye, {"track", "fixed"}, "track: eyes follow moving objects; fixed: they do not");
  tool.app()
      .add_option("--fps", w.frames_per_second,
                  formatted("frames per second; default: that of the flow or of the frame, else %g", Common{}.fps))
      ->type_name("VALUE")
      ->check(number_between(1e-3, 1e4));
}

VisionOptions vision_options(const VisionWords& w, const LoadedFrame& first) {
  VisionOptions options;
  options.display = vision::display_named(w.display);
  options.gaze = w.eye == "track" ? vision::Gaze::track : vision::Gaze::fixed;
  const double said = number_attribute(first.inputs().test.image, "framesPerSecond", Common{}.fps);
  options.frames_per_second =
      w.frames_per_second.value_or(number_attribute(first.flow_image(), "framesPerSecond", said));
  options.exposure_stops = w.exposure_stops ? *w.exposure_stops : shared_exposure_stops(first.inputs());
  return options;
}

void write_map(const JudgedFrame& judged, const LoadedFrame& frame, const VisionOptions& options,
               const std::string& history, Output output) {
  const Image& shown = *frame.inputs().test.image;
  if (output.path().ends_with(".png")) {
    save_png(output.temporary_path(), heat_map(judged, shown, {frame.inputs().layer, options.exposure_stops}));
  } else {
    Image image = probability_image(judged, shown.width, shown.height);
    image.text["tempolux:history"] = history;
    save_exr(output.temporary_path(), image);
  }
  output.commit();
}

}  // namespace tempolux::tools
