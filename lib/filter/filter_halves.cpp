#include "lib/filter/filter_halves.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "formats/error.h"
#include "lib/filter/choose.h"
#include "lib/filter/collect.h"
#include "lib/filter/fit.h"
#include "lib/filter/picture.h"
#include "lib/filter/resolve.h"
#include "lib/filter/rows.h"
#include "lib/filter/unmix.h"

namespace tempolux {
namespace {

constexpr int kSmallRadius = 2;
constexpr std::array<const char*, 2> kShownLayers{"emission", "specular"};
constexpr std::array<const char*, 2> kHalfNames{".a", ".b"};

std::span<const char* const> layers_of(std::size_t group) {
  return group == 0 ? std::span<const char* const>(kFilteredLayers) : std::span<const char* const>(kShownLayers);
}

void copy(const Image& from, const std::string& name, const std::string& as, Image& to) {
  if (const Channel* channel = from.find(name)) to.channels.push_back({as, channel->values, channel->ids});
}

/// Light that frame-render spread, as one sample alone claimed it (lib/render/spread_outliers.h), is missing in the layer and still in one half: it
/// leaves the brighter half. What was spread to a pixel goes to both.
void spread_in_halves(Image& image) {
  for (std::size_t group = 0; group < FrameHalves::kGroups; ++group)
    for (const char* layer : layers_of(group)) {
      const std::string name = layer;
      std::array<std::array<std::vector<float>*, 3>, 3> planes{};   // a, b, layer
      bool all = true;
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 3; ++k) {
          Channel* channel = float_channel(image, channel_name(name + (k < 2 ? kHalfNames[k] : ""), c));
          all = all && channel;
          planes[k][c] = channel ? &channel->values : nullptr;
        }
      if (!all) continue;
      for (std::size_t p = 0; p < image.pixel_count(); ++p) {
        std::array<float, 3> more;
        float total = 0, a_less_b = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const float a = (*planes[0][c])[p], b = (*planes[1][c])[p];
          more[c] = (*planes[2][c])[p] - (a + b) / 2;
          total += more[c];
          a_less_b += a - b;
        }
        for (std::size_t c = 0; c < 3; ++c) {
          float &a = (*planes[0][c])[p], &b = (*planes[1][c])[p];
          if (total >= 0) {
            a += more[c];
            b += more[c];
          } else {
            float& from = a_less_b > 0 ? a : b;
            from = std::max(from + 2 * more[c], 0.0f);
          }
        }
      }
    }
}

/// The frame as if it had one half of its samples alone, with the variance that the two halves' difference says.
Image half_of(const Image& image, std::size_t group, std::size_t half) {
  Image out;
  out.width = image.width;
  out.height = image.height;
  const std::string seen = group == 1 && image.find("seen.Z") ? "seen." : "";
  for (const char* name : {"Z", "N.X", "N.Y", "N.Z"}) copy(image, seen + name, name, out);
  copy(image, seen.empty() ? "id.object" : "seen.id", "id.object", out);
  copy(image, "coverage", "coverage", out);
  copy(image, "coverage.other", "coverage.other", out);
  const std::size_t count = image.pixel_count();
  for (std::size_t c = 0; c < 3; ++c) {
    if (group == 0) copy(image, channel_name("albedo", c), channel_name("albedo", c), out);
    else if (!seen.empty()) copy(image, channel_name("seen.albedo", c), channel_name("albedo", c), out);
    std::vector<float> difference(count, 0.0f);
    for (const char* layer : layers_of(group)) {
      const std::string name = layer;
      copy(image, channel_name(name + kHalfNames[half], c), channel_name(name, c), out);
      const Channel *a = image.find(channel_name(name + ".a", c)), *b = image.find(channel_name(name + ".b", c));
      for (std::size_t p = 0; a && b && p < count; ++p) difference[p] += a->values[p] - b->values[p];
    }
    for (float& d : difference) d = d * d / 2;   // of one half
    out.channels.push_back({channel_name("diffuse.variance", c), std::move(difference), {}});
  }
  return out;
}

/// Puts what a small fit finds, summed over layers, in the place of the means that values are compared by (filter_frame.cpp: compare_by_fit).
void compare_by(const Fitted& small, const LightFrame& frame, Collected& collected) {
  constexpr float kPlane = 3;
  for_each_row(frame.height, [&](int y) {
    for (int x = 0; x < frame.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        float sum = 0;
        for (const ColourPlane& layer : small.light)
          if (!layer[c].empty()) sum += layer[c].at(x, y);
        collected.mean[c].at(x, y) = sum;
      }
      collected.mean_variance.at(x, y) = kPlane * frame.variance.at(x, y) / std::max(small.support.at(x, y), 1.0f);
    }
  });
}

void swap_means(std::array<Collected, 2>& collected) {
  std::swap(collected[0].mean, collected[1].mean);
  std::swap(collected[0].mean_variance, collected[1].mean_variance);
}

}  // namespace

namespace {

bool has_halves(const Image& image, std::size_t group) {
  const std::span<const char* const> layers = layers_of(group);
  return std::any_of(layers.begin(), layers.end(), [&](const std::string& layer) { return image.find(layer + ".a.R") && image.find(layer + ".b.R"); });
}

}  // namespace

bool has_halves(const Image& image) { return has_halves(image, 0); }

FrameHalves::FrameHalves(Image& image) {
  for (std::size_t group = 0; group < kGroups; ++group)
    for (const std::string layer : layers_of(group))
      for (const char* half : kHalfNames)
        for (std::size_t c = 0; c < 3 && image.find(layer + half + ".R"); ++c)
          if (!float_channel(image, channel_name(layer, c)) || !float_channel(image, channel_name(layer + ".a", c)) ||
              !float_channel(image, channel_name(layer + ".b", c)))
            throw InputError("halves of layer " + layer + " are not all there, or the layer is not; write it with --channels layers,halves");
  spread_in_halves(image);
  for (std::size_t group = 0; group < kGroups; ++group)
    for (std::size_t half = 0; half < 2 && has_halves(image, group); ++half) views_[group][half] = std::make_unique<LightFrame>(half_of(image, group, half), layers_of(group));
}

struct HalvesFilter::State {
  const FrameHalves& middle;
  const FlowFrame& flow;
  FilterOptions options;
  std::size_t before, after, added = 0;
  std::array<std::optional<Collector>, 2> collectors;   ///< of the matte layers, by half; mirrors' light has no flow of its own

  /// Adds to `candidates`, by layer of the group, what small and large windows make of what was collected.
  void fit_both(std::size_t group, std::array<Collected, 2>& collected, const Coverage& coverage, const Image& image, int frames,
                std::vector<std::vector<Halves>>& candidates) const {
    std::array<Fitted, 2> small, large;
    swap_means(collected);
    for (std::size_t h = 0; h < 2; ++h) small[h] = fit(middle.view(group, h), collected[h], {.radius = std::min(kSmallRadius, options.radius)});
    for (std::size_t h = 0; h < 2; ++h) compare_by(small[h], middle.view(group, h), collected[h]);
    swap_means(collected);
    for (std::size_t h = 0; h < 2; ++h) large[h] = fit(middle.view(group, h), collected[h], {.radius = options.radius});
    add_candidate(group, collected, coverage, image, frames, small, kSmallRadius, candidates);
    add_candidate(group, collected, coverage, image, frames, large, options.radius, candidates);
  }

  void add_candidate(std::size_t group, const std::array<Collected, 2>& collected, const Coverage& coverage, const Image& image, int frames,
                     std::array<Fitted, 2>& fitted, int radius, std::vector<std::vector<Halves>>& candidates) const {
    for (auto& of_layer : candidates) of_layer.emplace_back();
    for (std::size_t h = 0; h < 2; ++h) {
      const LightFrame& frame = middle.view(group, h);
      unmix(frame, collected[h], coverage, radius, frames, fitted[h]);
      for (std::size_t l = 0; l < frame.layers.size(); ++l) {
        Halves& candidate = candidates[l].back();
        for (std::size_t c = 0; c < 3; ++c) {
          std::vector<float>& values = (h == 0 ? candidate.a : candidate.b)[c];
          values = image.find(channel_name(frame.layers[l] + kHalfNames[h], c))->values;
          if (fitted[h].light[l][c].empty()) continue;   // black
          const EdgePlane light{fitted[h].light[l][c], fitted[h].other[l][c], frame.albedo[c]};
          if (coverage.known()) resolve(light, coverage, frame.width, frame.height, values);
          else
            for_each_row(frame.height, [&](int y) {
              for (int x = 0; x < frame.width; ++x) values[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)] = light.own_at(x, y);
            });
        }
      }
    }
  }

  void filter_group(std::size_t group, const Coverage& coverage, Image& image) {
    if (!middle.has(group)) return;
    const LightFrame& frame = middle.view(group, 0);
    std::vector<std::vector<Halves>> candidates(frame.layers.size());
    const auto alone = [&](std::size_t h) { return Collector({&middle.view(group, h), &flow}, 1, nullptr).take(); };
    std::array<Collected, 2> collected{alone(0), alone(1)};
    fit_both(group, collected, coverage, image, 1, candidates);
    if (group == 0 && added > 0) {
      collected = {collectors[0]->take(), collectors[1]->take()};
      fit_both(group, collected, coverage, image, int(1 + added), candidates);
    }
    std::vector<std::uint8_t> kinds(image.pixel_count());
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) kinds[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)] = frame.inside.at(x, y) != 0;
    for (std::size_t l = 0; l < frame.layers.size(); ++l) {
      Halves raw;
      for (std::size_t c = 0; c < 3; ++c) {
        raw.a[c] = image.find(channel_name(frame.layers[l] + ".a", c))->values;
        raw.b[c] = image.find(channel_name(frame.layers[l] + ".b", c))->values;
      }
      Colours chosen = choose(raw, candidates[l], kinds, frame.width, frame.height);
      for (std::size_t c = 0; c < 3; ++c)
        float_channel(image, channel_name(frame.layers[l], c))->values = std::move(chosen[c]);
    }
  }
};

HalvesFilter::HalvesFilter(const FrameHalves& middle, const FlowFrame& flow, std::size_t before, std::size_t after, const FilterOptions& options)
    : state_(new State{middle, flow, options, before, after, 0, {}}) {
  if (options.radius < 0 || options.radius > kMargin) throw std::invalid_argument("HalvesFilter: radius");
  if (before + after > 0)
    for (std::size_t h = 0; h < 2; ++h) state_->collectors[h].emplace(WindowFrame{&middle.view(0, h), &flow}, 1.0f, nullptr);
}

HalvesFilter::~HalvesFilter() = default;

void HalvesFilter::add(const FrameHalves& frame, const FlowFrame& flow) {
  State& state = *state_;
  check_frame(state.middle.view(0, 0), frame.view(0, 0));
  const bool is_after = state.added >= state.before;
  const bool first = state.added == (is_after ? state.before : 0);
  for (std::size_t h = 0; h < 2; ++h) {
    if (first) state.collectors[h]->start(state.flow, is_after ? 1 : -1);
    state.collectors[h]->add({&frame.view(0, h), &flow}, 1);
  }
  ++state.added;
}

Image HalvesFilter::finish(Image image) {
  const LayerSums before = sum_layers(image);
  const Coverage coverage(image);
  for (std::size_t group = 0; group < FrameHalves::kGroups; ++group) state_->filter_group(group, coverage, image);
  renew_picture(before, sum_layers(image), image);
  leave_numbers(image);
  return image;
}

}  // namespace tempolux
