// tools/info/info_account.cpp -- tempolux-info: the bias that frames report of their light.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lib/core/formatted.h"
#include "lib/image/exr_io.h"
#include "lib/image/object_names.h"
#include "lib/audit/advice.h"
#include "lib/audit/audit.h"
#include "tools/info/each_file.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

struct AuditedLayer {
  const char *name, *in_words;
  Layer layer;
};
/// Direct light is left out: frames sample it without bias, so its audit only tests the audit itself.
constexpr std::array<AuditedLayer, 3> kLayers{{{"caustic", "caustic light", Layer::caustic},
                                               {"indirect", "indirect light", Layer::indirect},
                                               {"specular", "light in mirrors and glass", Layer::specular}}};
constexpr std::size_t kMatte = 2;  // the first layers are light on surfaces that the camera sees

/// Sums of one layer over the frames.
struct Sum {
  int frames = 0;
  double share = 0, share_square = 0, of_layer = 0, of_layer_square = 0;
  double worst = 0, worst_error = 0;  ///< share of the picture, in the object with the largest bias
  std::string worst_name;

  double mean() const { return share / frames; }
  double error() const { return std::sqrt(share_square) / frames; }
  /// The same limits as is_biased() has for one frame.
  bool biased() const { return std::abs(mean()) > kAuditLimit && std::abs(mean()) > kAuditErrors * error(); }
  /// True if the layer's audited light is a share of the picture below the limit: no error of such a layer is seen.
  bool faint() const { return std::abs(share) < kAuditLimit * std::abs(of_layer); }
  /// Three errors are as much as the whole layer, and more than the limit: the audit met too little of its light.
  bool unknown() const {
    return kAuditErrors * std::sqrt(of_layer_square) > frames && kAuditErrors * error() > kAuditLimit && !biased();
  }
};

/// A percentage with as many decimals as the error needs to show its first digit.
std::string percent(double value, double error) {
  const double digit = error > 0 ? std::floor(std::log10(100 * error)) : 0;
  const int decimals = int(std::clamp(-digit, 0.0, 6.0));
  return formatted("%+.*f +- %.*f %%", decimals, 100 * value, decimals, 100 * error);
}

const double* number(const Image& image, const std::string& name) {
  const auto found = image.numbers.find("tempolux:" + name);
  return found == image.numbers.end() ? nullptr : &found->second;
}

void add(const Image& image, const std::string& layer, const std::string& frame, Sum& sum) {
  const std::string name = "audit." + layer;
  const double *share = number(image, name), *error = number(image, name + "_error"),
               *of = number(image, name + ".of_layer"), *of_error = number(image, name + ".of_layer_error");
  if (!share || !error || !of || !of_error) return;
  ++sum.frames;
  sum.share += *share;
  sum.share_square += *error * *error;
  sum.of_layer += *of;
  sum.of_layer_square += *of_error * *of_error;
  const double *worst = number(image, name + ".worst_object"),
               *worst_error = number(image, name + ".worst_object_error"),
               *id = number(image, name + ".worst_object_id");
  if (!worst || !worst_error || !id || std::abs(*worst) <= std::abs(sum.worst)) return;
  sum.worst = *worst;
  sum.worst_error = *worst_error;
  sum.worst_name = object_in_words(std::uint32_t(*id), object_names_in(image)) + " of " + frame;
}

}  // namespace

FramesAccount account_of_frames(const std::vector<std::string>& files) {
  std::array<Sum, kLayers.size()> sums;
  std::size_t unbiased = 0;
  LitBy lit = LitBy::points;
  const auto read = [](const std::string& file) {
    ExrReadOptions attributes;  // and one channel: an EXR image without any is invalid
    attributes.wanted = [first = true](const std::string&) mutable { return std::exchange(first, false); };
    return load_exr(file, attributes);
  };
  each_file(files, read, [&](const std::string& file, const Image& image) {
    for (std::size_t l = 0; l < kLayers.size(); ++l) add(image, kLayers[l].name, file, sums[l]);
    unbiased += number(image, "audit.unbiased") != nullptr;
    if (number(image, "audit.texture")) lit = LitBy::texture;
  });
  FramesAccount account;
  bool audited = false;
  if (unbiased == files.size()) account.line = "no bias, as camera paths find all light";
  std::string unknown;
  for (std::size_t l = 0; l < kLayers.size(); ++l) {
    const Sum& sum = sums[l];
    audited |= sum.frames > 0 && l < kMatte;
    if (sum.frames > 0 && sum.unknown()) {
      unknown += (unknown.empty() ? "" : " and ") + std::string(kLayers[l].in_words);
      continue;
    }
    if (sum.frames == 0 || (sum.faint() && !sum.biased())) continue;
    std::string text = std::string(kLayers[l].in_words) + " " +
                       percent(sum.of_layer / sum.frames, std::sqrt(sum.of_layer_square) / sum.frames);
    if (sum.biased() && !sum.worst_name.empty())
      text += ", most by " + sum.worst_name + " (" + percent(sum.worst, sum.worst_error) + " of the picture)";
    account.line += (account.line.empty() ? "audit: " : ", ") + text;
    if (sum.biased())
      account.warnings.push_back(std::string(kLayers[l].in_words) + " is off by " + percent(sum.mean(), sum.error()) +
                                 " of the picture; " + advice_on_bias(kLayers[l].layer, AdviceFor::make, lit));
  }
  if (!unknown.empty())
    account.line +=
        (account.line.empty() ? "audit: " : ", ") + unknown + " not known, as too few of the tested paths bring it";
  if (audited && account.line.empty()) account.line = "audit: indirect and caustic light are below 2 % of the picture";
  return account;
}

}  // namespace tempolux::tools
