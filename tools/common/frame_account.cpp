#include "tools/common/frame_account.h"

#include <algorithm>
#include <cstdio>

namespace tempolux::tools {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

void add(const Noise& noise, const std::string& name, std::map<std::string, double>& numbers) {
  if (!(noise.codes >= 0)) return;
  numbers[name + ".codes"] = noise.codes;
  numbers[name + ".codes_error"] = noise.codes_error;
  numbers[name + ".linear"] = noise.linear;
  numbers[name + ".linear_error"] = noise.linear_error;
}

std::string noise_line(const RenderedFrame& rendered) {
  const FrameNoise& noise = rendered.noise;
  std::string line = "noise " + number(noise.image.codes) + " +- " + number(noise.image.codes_error) + " codes";
  for (std::size_t l = 0; l < kLayerCount; ++l)
    if (noise.layer[l].codes > 0) line += ", " + std::string(kLayerNames[l]) + " " + number(noise.layer[l].codes);
  return line + "; " + number(rendered.samples_per_pixel) + " samples a pixel";
}

}  // namespace

std::map<std::string, double> account_of(const RenderedFrame& rendered) {
  std::map<std::string, double> numbers;
  const FrameNoise& noise = rendered.noise;
  if (!noise.known()) return numbers;
  add(noise.image, "noise", numbers);
  for (std::size_t l = 0; l < kLayerCount; ++l)
    if (noise.layer[l].linear > 0) add(noise.layer[l], "noise." + std::string(kLayerNames[l]), numbers);
  numbers["noise.exposure"] = noise.exposure;
  numbers["noise.pixels"] = double(noise.pixels);
  return numbers;
}

void say_account(Tool& tool, const RenderedFrame& rendered, const FrameOptions& asked) {
  for (const auto& [name, value] : account_of(rendered)) {
    std::string key = name;
    std::replace(key.begin(), key.end(), '.', '_');
    tool.stats().set(key, value);
  }
  if (asked.pixel_error > 0) tool.stats().set("at_pixel_limit", rendered.at_limit);
  if (!rendered.noise.known()) return;
  tool.say(noise_line(rendered));
  if (asked.seen_error > 0 && rendered.noise.image.codes > asked.seen_error)
    tool.warn("--seen-error " + number(asked.seen_error) + ": " + number(rendered.noise.image.codes) + " codes are left, and " + number(100 * rendered.at_limit) +
              " % of the pixels are at --pixel-limit " + std::to_string(asked.adaptive_limit) + "; raise it, or give files of light (--points, --irradcache)");
}

}  // namespace tempolux::tools
