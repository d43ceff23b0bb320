#include "tools/stages/frame_account.h"

#include <cmath>

#include "lib/core/formatted.h"

namespace tempolux::tools {
namespace {

std::string number(double value) { return formatted("%.3g", value); }

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

/// Finds the object or the tile (`kind`) in which the frame's light of a layer differs most from the audit's, summed
/// over pixels. Differences below kAuditErrors standard errors do not count; nullptr if none counts.
const AuditEntry* worst_of(const std::vector<AuditEntry>& audit, Layer layer, const std::string& kind) {
  const AuditEntry* worst = nullptr;
  for (const AuditEntry& entry : audit) {
    if (entry.layer != layer || !entry.part.starts_with(kind) ||
        std::abs(entry.bias.value) <= kAuditErrors * entry.bias.error)
      continue;
    const auto light = [](const AuditEntry& of) { return std::abs(of.bias.value) * double(of.pixels); };
    if (!worst || light(entry) > light(*worst)) worst = &entry;
  }
  return worst;
}

std::string percent(double value, double error) { return formatted("%+.3g +- %.2g %%", 100 * value, 100 * error); }

/// An object by its name in the file; other parts by their description.
std::string in_words(const AuditEntry& part, const std::vector<std::string>& object_names) {
  const bool named = part.object < object_names.size() && !object_names[part.object].empty();
  return named ? part.part + " \"" + object_names[part.object] + "\"" : part.part;
}

std::string audit_line(const AuditEntry& of, const std::vector<AuditEntry>& audit,
                       const std::vector<std::string>& object_names) {
  const std::string name = of.layer == Layer::specular ? "light in mirrors and glass "
                                                       : std::string(kLayerNames[std::size_t(of.layer)]) + " light ",
                    share = percent(of.share(), of.share_error()) + " of the picture";
  if (kAuditErrors * of.of_layer_error() > 1 && kAuditErrors * of.share_error() > kAuditLimit && !is_biased(of))
    return name + "not known, as too few of the tested paths bring it (" + share + ")";
  std::string line = name + percent(of.of_layer(), of.of_layer_error()) + " (" + share + ")";
  for (const char* kind : {"object", "tile"})
    if (const AuditEntry* worst = worst_of(audit, of.layer, kind))
      line += ", " + in_words(*worst, object_names) + " " + percent(worst->of_layer(), worst->of_layer_error());
  return line;
}

void add(const std::vector<AuditEntry>& audit, std::map<std::string, double>& numbers) {
  for (const AuditEntry& entry : audit) {
    if (entry.part != "picture") continue;
    const std::string name = "audit." + std::string(kLayerNames[std::size_t(entry.layer)]);
    numbers[name] = entry.share();
    numbers[name + "_error"] = entry.share_error();
    if (entry.shown - entry.bias.value > 0) {
      numbers[name + ".of_layer"] = entry.of_layer();
      numbers[name + ".of_layer_error"] = entry.of_layer_error();
    }
    for (const char* kind : {"object", "tile"})
      if (const AuditEntry* worst = worst_of(audit, entry.layer, kind)) {
        const std::string of = name + ".worst_" + kind;
        numbers[of] = worst->share();
        numbers[of + "_error"] = worst->share_error();
        if (worst->object != kNone) numbers[of + "_id"] = worst->object;
      }
  }
}

Layer noisiest(const FrameNoise& noise) {
  std::size_t most = 0;
  for (std::size_t l = 1; l < kLayerCount; ++l)
    if (noise.layer[l].codes > noise.layer[most].codes) most = l;
  return Layer(most);
}

}  // namespace

std::map<std::string, double> account_of(const RenderedFrame& rendered, const std::vector<AuditEntry>& audit) {
  std::map<std::string, double> numbers;
  add(audit, numbers);
  const FrameNoise& noise = rendered.noise;
  if (!noise.known()) return numbers;
  add(noise.image, "noise", numbers);
  for (std::size_t l = 0; l < kLayerCount; ++l)
    if (noise.layer[l].linear > 0) add(noise.layer[l], "noise." + std::string(kLayerNames[l]), numbers);
  numbers["noise.exposure"] = noise.exposure;
  numbers["noise.pixels"] = double(noise.pixels);
  return numbers;
}

void add_noise_of_kept(const Image& from, const StillPixels& still, FrameNoise& noise) {
  const auto number = [&](const std::string& name) {
    const auto found = from.numbers.find("tempolux:" + name);
    return found == from.numbers.end() ? 0.0 : found->second;
  };
  const double anew = still.share_anew();
  const auto join = [&](const std::string& name, const Noise& change, Noise& of) {
    const Noise base{number(name + ".linear"), number(name + ".linear_error"), number(name + ".codes"),
                     number(name + ".codes_error")};
    const auto square = [](bool known, double value) { return known && value > 0 ? value * value : 0; };
    const auto joined = [&](double Noise::*value) {
      const double kept = square(true, base.*value) + square(still.noise.known(), change.*value);
      return std::sqrt(anew * square(noise.known(), of.*value) + (1 - anew) * kept);
    };
    of = {joined(&Noise::linear), joined(&Noise::linear_error), joined(&Noise::codes), joined(&Noise::codes_error)};
  };
  join("noise", still.noise.image, noise.image);
  for (std::size_t l = 0; l < kLayerCount; ++l)
    join("noise." + std::string(kLayerNames[l]), still.noise.layer[l], noise.layer[l]);
  if (!(noise.exposure > 0)) noise.exposure = number("noise.exposure");
  noise.pixels += std::size_t(number("noise.pixels"));
}

void report_account(Tool& tool, const RenderedFrame& rendered, const std::vector<AuditEntry>& audit,
                    const FrameOptions& asked, const std::vector<std::string>& object_names, LitBy lit) {
  for (const auto& [name, value] : account_of(rendered, audit)) tool.stats().set(name, value);
  if (asked.pixel_error > 0) tool.stats().set("at_pixel_limit", rendered.at_limit);
  for (const AuditEntry& entry : audit) {
    if (entry.part != "picture") continue;
    const std::string line = "audit: " + audit_line(entry, audit, object_names);
    tool.say(line);
    if (is_biased(entry) && entry.layer != Layer::direct)
      tool.warn(line + "; " + advice_on_bias(entry.layer, AdviceFor::tools, lit));
  }
  if (!rendered.noise.known()) return;
  tool.say(noise_line(rendered));
  if (!(asked.seen_error > 0 && rendered.noise.image.codes > asked.seen_error)) return;
  const std::string left =
      "--seen-error " + number(asked.seen_error) + ": " + number(rendered.noise.image.codes) + " codes are left, ";
  if (2 * rendered.noise.stored_codes > std::sqrt(3) * asked.seen_error)
    tool.warn(left + number(rendered.noise.stored_codes) +
              " of them by records and photons; give these more rays and paths (irradcache-build --rays, photon-trace "
              "--photons)");
  else
    tool.warn(left + "most in layer " + kLayerNames[std::size_t(noisiest(rendered.noise))] + ", and " +
              number(100 * rendered.at_limit) + " % of the pixels are at the limit of " +
              std::to_string(asked.adaptive_limit) + " samples; " + advice_on_samples(noisiest(rendered.noise)));
}

}  // namespace tempolux::tools
