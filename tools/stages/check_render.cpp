#include <string>

#include "formats/error.h"
#include "lib/render/data_channels.h"
#include "lib/render/frame_noise.h"
#include "lib/render/pixel_variance.h"
#include "tools/stages/render_frame.h"

namespace tempolux::tools {
namespace {

void check_still(const RenderOptions& options) {
  const auto both = [&](std::string IndirectLightOptions::*file) {
    return (options.light.*file).empty() == (options.still.light.*file).empty();
  };
  const bool files = !options.still.light.photons.empty() || !options.still.light.irradcache.empty() ||
                     !options.still.light.points.empty();
  if (options.still.frame.empty()) {
    if (files) throw InputError("--still-photons, --still-irradcache, --still-points: name the frame with --still");
    return;
  }
  if (!options.base.empty() || options.frame.halves || options.half_float)
    throw InputError("--still: with --base, --halves or --half pixels would not be those of the frame; leave out one");
  if (options.integrator == "path" || !options.light.meshirrad.empty() || !(options.pixel_error != 0))
    throw InputError(
        "--still: needs --pixel-error, which decides what is sampled anew, and no --integrator path or --meshirrad");
  for (const auto file : {&IndirectLightOptions::photons, &IndirectLightOptions::irradcache,
                          &IndirectLightOptions::points, &IndirectLightOptions::high})
    if (!both(file))
      throw InputError(
          "--still: both moments need the same kinds of light files: give each of --photons, --irradcache, --points, "
          "--high together with the --still- option of its name");
}

void check_output(const Tool& tool, const std::string& output) {
  tool.check_frame_output(output);
  for (const char* other : {".png", ".jpg", ".jpeg", ".hdr", ".tif", ".tiff", ".bmp", ".ppm", ".pfm", ".webp", ".avif"})
    if (output.ends_with(other))
      throw InputError("--output " + output +
                       ": a frame is OpenEXR; name it f.exr, then tempolux-info --png f.png f.exr");
}

/// Which files of light go together, and with which --integrator.
void check_light(const RenderOptions& options) {
  const IndirectLightOptions& light = options.light;
  const std::string& integrator = options.integrator;
  if (integrator == "photons" && !(light.irradcache.empty() && light.points.empty()))
    throw InputError("--integrator photons reads no cache and no points; leave them out, or the integrator");
  if (!light.meshirrad.empty() && !(light.irradcache.empty() && light.points.empty() && integrator == "auto"))
    throw InputError(
        "--meshirrad and --irradcache, --points or --integrator: a light texture is all indirect light by itself; "
        "leave out one");
  if (integrator == "photons" && light.photons.empty())
    throw InputError("--integrator photons: name the photon map with --photons FILE");
  if (!light.dynamic.empty() && light.photons.empty())
    throw InputError(
        "--dynamic: what movers change is nothing alone; name the segment's static map with --photons FILE");
  if (!light.high.empty() && light.points.empty() && (light.photons.empty() || !light.dynamic.empty()))
    throw InputError("--high: name the low part of the same map with --points FILE or --photons FILE");
  if (!light.high.empty() && !light.points.empty() && !light.irradcache.empty())
    throw InputError(
        "--high: records of --irradcache hold the high part; give irradcache-build records --high, and the whole "
        "points here");
  if (integrator == "cache" && light.irradcache.empty())
    throw InputError("--integrator cache: name the cache with --irradcache FILE");
  if (integrator == "path" && !options.traces_paths())
    throw InputError("--integrator path reads no photons and no cache; leave them out, or the integrator");
  if (options.light_paths > 0 && integrator != "path")
    throw InputError("--light-paths: only for --integrator path; photons find this light");
  if (options.light_paths > 0 && !options.base.empty())
    throw InputError("--light-paths: adds light to all pixels, also to those of --base; leave out one");
}

void check_base(const RenderOptions& options) {
  if (options.mask.empty() != options.base.empty()) throw InputError("--mask and --base need each other");
  if (!options.base.empty() && options.frame.halves)
    throw InputError(
        "--halves: pixels of --base are the same in both, so that they are not independent; leave out one");
  if (!options.base.empty() && options.half_float)
    throw InputError("--half: would round the pixels of --base, which are kept bit for bit; leave out one");
}

/// Sets the error of a pixel from the options that state it.
void set_pixel_error(RenderOptions& options) {
  FrameOptions& frame = options.frame;
  if (frame.halves && frame.samples % 2 != 0) throw InputError("--spp: halves need an even number of samples");
  if (frame.halves && options.pixel_error > 0)
    throw InputError("--pixel-error: halves take the same samples everywhere; leave out one");
  if (frame.halves && frame.seen_error > 0)
    throw InputError("--seen-error: halves take the same samples everywhere; leave out one");
  const double without = options.traces_paths() ? 0 : options.pixel_error_of_files;
  frame.pixel_error = options.pixel_error < 0 ? without : options.pixel_error;
  if (frame.seen_error > 0 && options.pixel_error < 0) frame.pixel_error = pixel_error_of_codes(frame.seen_error);
  if (frame.seen_error > 0 && !(frame.pixel_error > 0))
    throw InputError("--pixel-error 0: --seen-error needs it to share samples out; leave it out");
  if (frame.halves) frame.pixel_error = 0;
}

}  // namespace

void check(const Tool& tool, RenderOptions& options) {
  check_output(tool, options.output);
  check_light(options);
  options.light.photons_alone = options.integrator == "photons";
  options.light.influence.high *= options.light.influence.low / InfluenceThresholds{}.low;  // keeps ratio()
  check_base(options);
  check_still(options);
  set_pixel_error(options);
  options.frame.sample_halves = wants_sample_halves(options.channels);
  check_channels(options.channels);
}

}  // namespace tempolux::tools
