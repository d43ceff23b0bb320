// lib/plan/stages.cpp -- the presets.
#include "lib/plan/stages.h"

#include <sstream>

namespace tempolux {
namespace {

struct Preset {
  std::uint64_t photons;
  const char* points;
  const char* records;  ///< further words
  double pixel_error;
  int first_samples;  ///< of a pixel
};
constexpr Preset kDraft{100'000, "--point-count 10k --light-samples 2", "--error-bound 0.3", 0.05, 2};
constexpr std::uint64_t kPreviewPhotons = 25'000;  ///< per frame, as in the paper
constexpr Preset kFinal{700'000, "", "", 0.016, 4};

}  // namespace

Wish with_preset(Wish wish) {
  const Preset& preset = wish.quality == Quality::draft ? kDraft : kFinal;
  if (wish.photons == 0) wish.photons = wish.method == FrameMethod::preview ? kPreviewPhotons : preset.photons;
  if (wish.pixel_error == 0) wish.pixel_error = preset.pixel_error;
  if (wish.threshold < 0) wish.threshold = wish.seen();
  if (wish.points.empty()) wish.points = preset.points;
  if (wish.records.empty()) wish.records = preset.records;
  // Pixel options of the user replace those of the preset, and turn the filter off. Halves of all layers take 1 kB per
  // pixel, 2 GB at 1920x1080, so larger pictures are not filtered by default.
  if (wish.filter == Wish::kAutoFilter)
    wish.filter = wish.pixels.empty() && wish.width * wish.height <= 1920 * 1080 ? 1 : 0;
  wish.first_samples = preset.first_samples;
  if (wish.pixels.empty()) {
    wish.pixels = "--spp " + std::to_string(preset.first_samples);
    wish.preset_pixels = true;
  }
  return wish;
}

}  // namespace tempolux
