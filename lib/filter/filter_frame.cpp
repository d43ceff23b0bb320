#include "lib/filter/filter_frame.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "formats/error.h"
#include "lib/filter/choose.h"
#include "lib/filter/fit.h"
#include "lib/filter/remaining_noise.h"
#include "lib/filter/picture.h"
#include "lib/filter/regress.h"
#include "lib/filter/resolve.h"
#include "lib/filter/rows.h"
#include "lib/filter/unmix.h"
#include "lib/image/channel_groups.h"

namespace tempolux {
namespace {

/// Throws InputError if two frames of a window differ in size or layers.
void check_frame(const WindowLight& frame, const WindowLight& other) {
  if (other.width != frame.width || other.height != frame.height)
    throw InputError("frames of " + std::to_string(frame.width) + "x" + std::to_string(frame.height) + " and of " +
                     std::to_string(other.width) + "x" + std::to_string(other.height) +
                     " pixels; all frames of a window have one size");
  const auto &own = frame.light.group(0), &others = other.light.group(0);
  if (own.has_value() != others.has_value() ||
      (own && (own->layers != others->layers || own->surfaces.albedo[0].empty() != others->surfaces.albedo[0].empty())))
    throw InputError("frames of a window have different layers; write all with the same --channels");
}

/// The candidates of one group, by layer.
class Candidates {
 public:
  Candidates(const LightGroup& group, const Coverage& coverage)
      : group_(group), coverage_(coverage), of_layer_(group.layers.size()) {}

  /// Adds candidates made from light of `frames` frames; 1: the group's raw light.
  void add(const BothHalves& collected, int frames) {
    const Plane variance = smoothed(group_.surfaces, group_.variance);
    const Surfaces& on = group_.surfaces;
    BothHalves fitted = fit(on, collected, nullptr, frames == 1 ? kSmallAlike : kSmall, variance);
    fitted = fit(on, fitted, &fitted, kLarge, variance);
    std::array<std::vector<ColourPlane>, 2> other;
    for (std::size_t h = 0; h < 2; ++h) other[h] = unmix(group_, h, collected[h], coverage_, frames, fitted[h]);
    if (frames > 1) add_candidate(collected, other);
    add_candidate(fitted, other);
  }
  /// Adds candidates of radiance, by layer.
  void add(std::vector<Halves> radiance) {
    for (std::size_t l = 0; l < radiance.size(); ++l)
      if (!radiance[l].a[0].empty()) of_layer_[l].push_back(std::move(radiance[l]));
  }
  const std::vector<Halves>& of(std::size_t layer) const { return of_layer_[layer]; }

 private:
  void add_candidate(const BothHalves& light, const std::array<std::vector<ColourPlane>, 2>& other) {
    const Surfaces& on = group_.surfaces;
    const Plane none;
    for (std::size_t l = 0; l < of_layer_.size(); ++l) {
      Halves& candidate = of_layer_[l].emplace_back();
      for (std::size_t h = 0; h < 2; ++h)
        for (std::size_t c = 0; c < 3; ++c) {
          std::vector<float>& values = (h == 0 ? candidate.a : candidate.b)[c];
          values.resize(std::size_t(on.width) * std::size_t(on.height));
          if (const Plane& own = light[h].layers[l][c]; !own.empty())
            resolve({own, other[h].empty() ? none : other[h][l][c], on.albedo[c]}, coverage_, on.width, on.height,
                    values);
        }
    }
  }

  const LightGroup& group_;
  const Coverage& coverage_;
  std::vector<std::vector<Halves>> of_layer_;
};

/// The halves of a layer as radiance.
Halves raw_halves(const Image& image, const LightGroup& group, std::size_t l) {
  const Surfaces& on = group.surfaces;
  Halves raw;
  raw.confirmed = confirmed_in(image, group.layers[l]);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float>& mean = image.find(channel_name(group.layers[l], c))->values;
    raw.a[c] = raw.b[c] = mean;
    if (group.raw[0].layers[l][c].empty()) continue;
    const std::string noise_of = channel_name(group.layers[l] + ".noise", c);
    const Channel* const stored = holds(image, noise_of) ? image.find(noise_of) : nullptr;
    for_each_row(on.height, [&](int y) {
      for (int x = 0; x < on.width; ++x) {
        const std::size_t p = std::size_t(y) * std::size_t(on.width) + std::size_t(x);
        const float noise =
            (group.raw[0].layers[l][c].at(x, y) - group.raw[1].layers[l][c].at(x, y)) / 2 * on.albedo_at(c, x, y);
        raw.a[c][p] += noise;
        raw.b[c][p] -= noise;
      }
    });
    for (const std::size_t p : raw.confirmed)
      if (stored) raw.a[c][p] += stored->values[p], raw.b[c][p] -= stored->values[p];
  }
  return raw;
}

/// R, G and B of all layers together; of the picture itself if it has no layers.
PicturePlanes picture_of(const LayerSums& layers, const Image& image) {
  if (layers[0].empty()) return image.rgb("");
  return {&layers[0], &layers[1], &layers[2]};
}

}  // namespace

WindowLight::WindowLight(const Image& image, bool alone) : width(image.width), height(image.height), light(image) {
  if (const auto& matte = light.group(0); matte && !alone)
    guides = fit(matte->surfaces, matte->raw, nullptr, kSmallAlike, smoothed(matte->surfaces, matte->variance));
}

struct FrameFilter::State {
  const WindowLight& middle;
  const FlowFrame& flow;
  std::optional<float> dark;
  std::size_t before, after, added = 0;
  /// By half, for matte light. Light in mirrors does not move along the pixel flow, so it is not collected.
  std::array<std::optional<Collector>, 2> collectors;
  RemainingNoise remaining;

  void filter_group(std::size_t g, const Coverage& coverage, const Features& features, const PictureLight& picture,
                    Image& image) {
    const LightGroup& group = *middle.light.group(g);
    const Surfaces& on = group.surfaces;
    Candidates candidates(group, coverage);
    candidates.add(group.raw, 1);
    if (g == 0 && collectors[0]) candidates.add({collectors[0]->take(), collectors[1]->take()}, int(1 + added));
    if (features.known()) candidates.add(regress(image, group, features));
    std::vector<std::uint8_t> kinds(image.pixel_count());
    for (int y = 0; y < on.height; ++y)
      for (int x = 0; x < on.width; ++x)
        kinds[std::size_t(y) * std::size_t(on.width) + std::size_t(x)] = on.inside.at(x, y) != 0;
    const Neighbourhood around(std::move(kinds), on.width, on.height);
    for (std::size_t l = 0; l < group.layers.size(); ++l) {
      if (candidates.of(l).empty() || group.raw[0].layers[l][0].empty()) continue;
      const Halves raw = raw_halves(image, group, l), chosen = choose(raw, candidates.of(l), around, picture);
      remaining.add(raw, chosen);
      for (std::size_t c = 0; c < 3; ++c) {
        put_mean(chosen, c, float_channel(image, channel_name(group.layers[l], c))->values);
        if (Channel* noise = float_channel(image, channel_name(group.layers[l] + ".noise", c)))
          std::transform(chosen.a[c].begin(), chosen.a[c].end(), chosen.b[c].begin(), noise->values.begin(),
                         [](float a, float b) { return (a - b) / 2; });
      }
    }
  }

  /// Stores the means of the halves. If the raw light of a pixel is not negative, its result is not negative either:
  /// values that rounding has made negative become 0.
  static void put_mean(const Halves& halves, std::size_t c, std::vector<float>& values) {
    for (std::size_t p = 0; p < values.size(); ++p) {
      const float mean = mean_of(halves.a[c][p], halves.b[c][p]);
      values[p] = values[p] >= 0 ? std::max(mean, 0.0f) : mean;
    }
  }

  void filter(Image& image) {
    if (added != before + after) throw std::invalid_argument("FrameFilter: frames of the window are missing");
    const LayerSums raw = sum_layers(image);
    const Coverage coverage(image);
    const Features features(image);
    const PicturePlanes planes = picture_of(raw, image);
    const PictureLight picture(planes, image.width, image.height, dark ? *dark : dark_of(planes));
    for (std::size_t g = 0; g < FrameLight::kGroups; ++g)
      if (middle.light.group(g)) filter_group(g, coverage, features, picture, image);
    renew_picture(raw, sum_layers(image), image);
  }
};

FrameFilter::FrameFilter(const WindowLight& middle, const FlowFrame& flow, std::size_t before, std::size_t after,
                         std::optional<float> dark)
    : state_(new State{middle, flow, dark, before, after, 0, {}, {}}) {
  if (before + after > 0 && middle.guides)
    for (std::size_t h = 0; h < 2; ++h)
      state_->collectors[h].emplace(WindowFrame{&*middle.light.group(0), &*middle.guides, &flow}, h);
}

FrameFilter::~FrameFilter() = default;

void FrameFilter::add(const WindowLight& frame, const FlowFrame& flow) {
  State& state = *state_;
  if (state.added >= state.before + state.after)
    throw std::invalid_argument("FrameFilter: more frames than the window has");
  check_frame(state.middle, frame);
  const bool is_after = state.added >= state.before, first = state.added == (is_after ? state.before : 0);
  ++state.added;
  if (!frame.guides) return;
  for (std::optional<Collector>& collector : state.collectors) {
    if (first) collector->start(is_after ? 1 : -1);
    collector->add({&*frame.light.group(0), &*frame.guides, &flow});
  }
}

Image FrameFilter::finish(Image image) {
  filter(image);
  leave_numbers(image);
  write_remaining_noise(remaining_error(), image);
  return image;
}

void FrameFilter::filter(Image& image) { state_->filter(image); }

RemainingError FrameFilter::remaining_error() const { return state_->remaining.error(); }

namespace {

/// Largest distance, in pixels, of another pixel that affects a pixel: the sum of the reaches of both fits, of
/// smoothing and the one-surface test (2), of unmix() (6), of resolve() (1), of choose() (six box filters of reach 3:
/// two for the error, four to restore the layer's sum), and of the picture's light (1).
constexpr int reach() { return kSmall.radius * kSmall.stride + kLarge.radius * kLarge.stride + 2 + 6 + 1 + 6 * 3 + 1; }

Image cut_out(const Image& image, int left, int top, int width, int height) {
  Image out{width, height, {}, {}, {}, {}};
  const auto copy = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.resize(out.pixel_count());
    for (int y = 0; y < height; ++y)
      std::copy_n(from.data() + std::size_t(top + y) * std::size_t(image.width) + std::size_t(left), width,
                  to.data() + std::size_t(y) * std::size_t(width));
  };
  for (const Channel& channel : image.channels) {
    if (!is_read_to_filter(channel.name)) continue;
    Channel& part = out.channels.emplace_back(Channel{channel.name, {}, {}});
    copy(channel.values, part.values);
    copy(channel.ids, part.ids);
  }
  return out;
}

}  // namespace

Image filter_alone(Image image) {
  constexpr int kWide = 640, kHigh = 360;
  const float dark = dark_of(picture_of(sum_layers(image), image));
  // The next tiles read raw light up to reach() rows above them, so filtered rows wait here until these tiles are done.
  const int waiting_rows = std::min(image.height, kHigh + reach());
  std::map<std::string, std::vector<float>> waiting;
  int first_waiting = 0;
  const auto row_of = [&](std::vector<float>& values, int y) {
    return values.data() + std::size_t(y) * std::size_t(image.width);
  };
  RemainingError remaining_error;
  for (int top = 0; top < image.height; top += kHigh) {
    const int bottom = std::min(image.height, top + kHigh);
    for (int left = 0; left < image.width; left += kWide) {
      const int x0 = std::max(0, left - reach()), y0 = std::max(0, top - reach());
      const int x1 = std::min(image.width, left + kWide + reach()), y1 = std::min(image.height, top + kHigh + reach());
      Image tile = cut_out(image, x0, y0, x1 - x0, y1 - y0);
      const WindowLight light(tile, true);
      const FlowFrame flow;
      FrameFilter filter(light, flow, 0, 0, dark);
      filter.filter(tile);
      const auto copy = [&](const std::vector<float>& from, std::vector<float>& to, int rows) {
        to.resize(std::size_t(rows) * std::size_t(image.width));
        for (int y = top; y < bottom; ++y)
          std::copy_n(from.data() + std::size_t(y - y0) * std::size_t(tile.width) + std::size_t(left - x0),
                      std::min(kWide, image.width - left), row_of(to, y % rows) + left);
      };
      for (const Channel& channel : tile.channels)
        if (!channel.values.empty() && (is_in_group(channel.name, "layers") || is_in_group(channel.name, "RGBA") ||
                                        channel.name.find(".noise.") != std::string::npos))
          copy(channel.values, waiting[channel.name], waiting_rows);
      const RemainingError of_this = filter.remaining_error();
      for (const auto part : {&RemainingError::whole, &RemainingError::noise})
        for (std::size_t c = 0; c < 3 && !(of_this.*part)[c].empty(); ++c)
          copy((of_this.*part)[c], (remaining_error.*part)[c], image.height);
    }
    for (const int end = bottom < image.height ? bottom - reach() : bottom; first_waiting < end; ++first_waiting)
      for (auto& [name, values] : waiting)
        std::copy_n(row_of(values, first_waiting % waiting_rows), image.width,
                    row_of(float_channel(image, name)->values, first_waiting));
  }
  leave_numbers(image);
  write_remaining_noise(remaining_error, image);
  return image;
}

}  // namespace tempolux
