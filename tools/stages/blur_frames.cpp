#include "tools/stages/blur_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/filter/blur.h"
#include "lib/image/cryptomatte.h"
#include "lib/image/exr_io.h"
#include "lib/scene/scene.h"
#include "tools/common/cli.h"
#include "tools/common/keep_memory.h"
#include "tools/common/tool_main.h"
#include "tools/stages/filter_frames.h"

namespace tempolux::tools {
namespace {

struct Options {
  std::string input, flow, output, open = "centre";
  double shutter_deg = 0;
  Camera lens;

  Options() { lens.sensor_width_mm = kSensorWidth_mm; }
};

/// Widths of the picture and of its longer side at distance 1 m, m, from the attributes of a perspective camera. The
/// column of w is the view axis; what the column of x (y) has across it is 1 / width (1 / height).
std::array<double, 2> widths_in(const Image& image, const std::string& file) {
  const auto found = image.matrices.find("worldToNDC");
  const auto across = [&](int column) {
    double length2 = 0, along = 0, axis2 = 0;
    for (int row = 0; row < 3; ++row) {
      const double a = found->second[std::size_t(4 * row + column)], w = found->second[std::size_t(4 * row + 3)];
      length2 += a * a;
      along += a * w;
      axis2 += w * w;
    }
    return axis2 > 0 ? std::sqrt(std::max(0.0, length2 - along * along / axis2)) : 0;
  };
  const double x = found == image.matrices.end() ? 0 : across(0), y = x > 0 ? across(1) : 0;
  if (!(x > 0 && y > 0))
    throw InputError(file +
                     ": no perspective camera (attribute worldToNDC), so the lens has no size in pixels; leave "
                     "out --f-stop and --lens-radius");
  return {1 / x, 1 / std::min(x, y)};
}

BlurOptions blur_of(const Options& options, const Image& image, const std::string& file) {
  BlurOptions blur;
  const double frames = options.shutter_deg / 360;
  blur.opens = options.open == "begin" ? 0 : -frames / 2;
  blur.closes = blur.opens + frames;
  if (!options.lens.has_lens()) return blur;
  const auto [width, longer] = widths_in(image, file);
  blur.lens_px = lens_radius(options.lens, longer / 2) * image.width / width;
  blur.focus_m = options.lens.focus_m;
  return blur;
}

void blur_file(Tool& tool, const Options& options, int number) {
  const std::string file = frame_name(options.input, number);
  Output output(frame_name(options.output, number));
  tool.stats().phase("read");
  Image image = load_exr(file, {.our_names = true});
  tool.depends_on(file);
  FlowFrame flow;
  if (options.shutter_deg > 0) {
    const std::string name = options.flow.empty() ? file : frame_name(options.flow, number);
    if (options.flow.empty()) {
      flow = FlowFrame(image, image.width, image.height, name);
    } else {
      flow = FlowFrame(load_exr(name, {.our_names = true}), image.width, image.height, name);
      tool.depends_on(name);
    }
  }
  if (has_mattes(image))
    tool.warn(file + ": cryptomatte is left out, as it is sharp; frame-render --shutter and --f-stop make it blurred");
  const BlurOptions blur = blur_of(options, image, file);
  tool.stats().phase("blur", true);
  try {
    image = blur_frame(std::move(image), flow, blur);
  } catch (const InputError& error) { throw InputError(file + ": " + error.what()); }
  write_filtered(tool, output, image, number);
}

}  // namespace

int blur_frames(int argc, char** argv) {
  Tool tool("st-filter blur", "Make motion blur and depth of field from a sharp frame, its flow and Z.", argc, argv);
  Options options;
  CLI::App& app = tool.app();
  tool.file_option("input", options.input, "sharp frame, EXR, or a pattern; needs R, G, B, Z and, for motion, its flow")
      ->required();
  tool.file_option("--flow", options.flow,
                   "pixel flow, EXR, or a pattern; if not given: the frame's own channels forward and backward");
  tool.number_option("--shutter", options.shutter_deg, 0, 36000,
                     "time that the shutter is open, degrees of the frame, such as 180 for half of it; 0: no motion "
                     "blur");
  tool.choice_option("--shutter-open", options.open, {"centre", "begin"},
                     "where the frame's time lies in it: in the middle, or where the shutter opens");
  auto* const f_stop = tool.number_option("--f-stop", options.lens.f_stop, 0, 1e6,
                                          "focal length over the diameter of the lens' opening, such as 2.8; 0: "
                                          "everything is sharp");
  tool.number_option("--lens-radius", options.lens.lens_radius_m, 0, 1e3,
                     "radius of the opening in place of --f-stop, m")
      ->excludes(f_stop);
  app.add_option("--focus", options.lens.focus_m, "what is sharp: a distance along the view axis, m, or inf")
      ->type_name("M")
      ->check(CLI::Validator(
          [](std::string& text) {
            double metres = 0;
            return CLI::detail::lexical_cast(text, metres) && metres >= 1e-6
                       ? std::string()
                       : text + ": must be a distance of at least 1e-6 m, or inf";
          },
          "", ""));
  tool.number_option("--sensor-width", options.lens.sensor_width_mm, 0.1, 1e4,
                     "sensor along the picture's longer side, mm, which with the angle of view gives the focal length");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
  tool.common_options(uses_frames);
  return tool.run([&] {
    keep_memory_of_pictures();
    tool.check_patterns({options.input, options.flow, options.output});
    tool.check_frame_output(options.output);
    if (!(options.shutter_deg > 0) && !options.lens.has_lens())
      throw InputError("--shutter, --f-stop: neither blurs anything; give --shutter 180, or --f-stop 2.8 --focus M");
    if (options.lens.has_lens() && !(options.lens.focus_m > 0))
      throw InputError("--f-stop: no distance is sharp: give --focus METRES");
    const std::vector<int>& frames = tool.common().frames;
    for (const int& frame : frames) {
      blur_file(tool, options, frame);
      tool.progress(double(&frame - frames.data() + 1) / double(frames.size()));
    }
    return exit_ok;
  });
}

}  // namespace tempolux::tools
