// tools/stages/vision_options.cpp -- aqm-compare's options of viewer and display.
#include "tools/stages/vision_options.h"

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "tools/common/cli.h"
#include "tools/common/option_words.h"

namespace tempolux::tools {
namespace {

bool is_png(const std::string& name) { return name.ends_with(".png"); }

double number_attribute(const Image* image, const std::string& name, double otherwise) {
  if (!image) return otherwise;
  const auto found = image->numbers.find(name);
  return found != image->numbers.end() && found->second > 0 ? found->second : otherwise;
}

}  // namespace

void declare_vision(Tool& tool, VisionWords& w) {
  CLI::App& app = tool.app();
  app.add_option("--flow", w.flow,
                 "pixel flow of the frame, EXR (ibr-warp): judge as a viewer would, by each pixel's own motion")
      ->type_name("FILE");
  tool.output_option(w.map, "write the probability that a difference is seen: EXR, channel P, or PNG over the frame",
                     "-o,--map");
  app.add_option("--display", w.display,
                 "office: 200 cd/m2 at 38 pixels/degree; dark: the same in a dark room; hdr: 1500 cd/m2, 75")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(CLI::IsMember({"office", "hdr", "dark"}));
  app.add_option("--exposure", w.exposure,
                 "stops, as of tempolux-info --png; auto: the first frame's, for the whole sequence")
      ->type_name("{auto,STOPS}")
      ->capture_default_str();
  app.add_option("--eye", w.eye, "track: eyes follow moving objects; fixed: they do not")
      ->type_name("{track,fixed}")
      ->capture_default_str()
      ->check(CLI::IsMember({"track", "fixed"}));
  app.add_option("--fps", w.frames_per_second, "frames per second; default: that of the flow or of the frame, else 24")
      ->type_name("VALUE")
      ->check(number_between(1e-3, 1e4));
}

void check_vision(const VisionWords& w, bool several_frames) {
  if (!w.map.empty() && !w.map.ends_with(".exr") && !is_png(w.map))
    throw InputError("--map " + w.map + ": the name must end in .exr or .png");
  if (several_frames && !w.map.empty() && !has_frame_pattern(w.map))
    throw InputError("--map " + w.map + ": give a pattern such as p.####.exr for several frames");
  double stops = 0;
  if (w.exposure != "auto" && (!CLI::detail::lexical_cast(w.exposure, stops) || !(stops > -200 && stops < 200)))
    throw InputError("--exposure: '" + w.exposure + "' is neither auto nor a number of stops");
}

VisionOptions vision_options(const VisionWords& w, const LoadedFrame& first) {
  VisionOptions options;
  options.display = vision::display_named(w.display);
  options.gaze = w.eye == "track" ? vision::Gaze::track : vision::Gaze::fixed;
  const double said = number_attribute(first.inputs().test.image, "framesPerSecond", 24);
  options.frames_per_second =
      w.frames_per_second > 0 ? w.frames_per_second : number_attribute(first.flow_image(), "framesPerSecond", said);
  if (w.exposure == "auto") options.exposure_stops = shared_exposure_stops(first.inputs());
  else CLI::detail::lexical_cast(w.exposure, options.exposure_stops);
  return options;
}

void write_map(const JudgedFrame& judged, const LoadedFrame& frame, const VisionOptions& options,
               const std::string& history, Output output) {
  const Image& shown = *frame.inputs().test.image;
  if (is_png(output.path())) {
    save_png(output.temporary_path(), heat_map(judged, shown, {frame.inputs().layer, options.exposure_stops}));
  } else {
    Image image = probability_image(judged, shown.width, shown.height);
    image.text["tempolux:history"] = history;
    save_exr(output.temporary_path(), image);
  }
  output.commit();
}

}  // namespace tempolux::tools
