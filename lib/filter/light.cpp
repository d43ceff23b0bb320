#include "lib/filter/light.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "formats/error.h"
#include "lib/core/random.h"
#include "lib/filter/picture.h"
#include "lib/filter/rows.h"
#include "lib/filter/surface_weight.h"
#include "lib/image/channel_groups.h"

namespace tempolux {
namespace {

bool is_black(const Image& image, const std::string& layer) {
  for (std::size_t c = 0; c < 3; ++c)
    if (const auto& values = image.find(channel_name(layer, c))->values;
        std::any_of(values.begin(), values.end(), [](float v) { return v != 0; }))
      return false;
  return true;
}

/// Noise of light (radiance / albedo) by layer and colour, made up for frames whose layers have no channels of noise
/// (FrameLight).
class MadeUpNoise {
 public:
  MadeUpNoise(const Image& image, const LightGroup& group) : group_(group) {
    const Surfaces& on = group.surfaces;
    const bool diffuse = !group.layers[0].empty() && has_colour(image, "diffuse.variance");
    const std::string stored = diffuse ? "diffuse.variance" : has_colour(image, "variance") ? "variance" : "";
    for (std::size_t l = 0; l < group.layers.size(); ++l)
      for (std::size_t c = 0; c < 3; ++c) {
        Plane& noise = noise_.emplace_back(on.width, on.height);
        if (group.raw[0].layers[l][c].empty()) continue;
        if (!stored.empty()) take(image.find(channel_name(stored, c))->values, l, c, noise);
        else if (!on.albedo[0].empty()) estimate(group.raw[0].layers[l][c], noise);
      }
  }
  const Plane& of(std::size_t layer, std::size_t c) const { return noise_[3 * layer + c]; }

 private:
  float sign(int x, int y) const { return mix64(std::uint64_t(y) << 32 | std::uint64_t(x)) & 1 ? 1.0f : -1.0f; }

  /// Estimates the variance as the mean of half the squared difference to the four neighbours on the surface. If pixels
  /// differ by noise alone, the expectation of this mean is the variance; smooth light adds little. Pixels that see
  /// several surfaces get no noise.
  void estimate(const Plane& light, Plane& noise) const {
    const Surfaces& on = group_.surfaces;
    for_each_row(on.height, [&](int y) {
      for (int x = 0; x < on.width; ++x) {
        float sum = 0, count = 0;
        for (const auto& [dx, dy] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}})
          if (on.inside.at(x, y) != 0 && on.use.at(x + dx, y + dy) != 0) {
            const float difference = light.at(x, y) - light.at(x + dx, y + dy);
            sum += difference * difference / 2;
            count += 1;
          }
        noise.at(x, y) = count > 0 ? sign(x, y) * std::sqrt(sum / count) : 0;
      }
    });
  }

  /// Reads the variance of the sum of the layers. Layer l gets the share of the standard deviation that it has in the
  /// light.
  void take(const std::vector<float>& variance, std::size_t l, std::size_t c, Plane& noise) const {
    const Surfaces& on = group_.surfaces;
    for_each_row(on.height, [&](int y) {
      for (int x = 0; x < on.width; ++x) {
        float sum = 0;
        for (const ColourPlane& layer : group_.raw[0].layers)
          if (!layer[c].empty()) sum += std::abs(layer[c].at(x, y));
        const float deviation =
            std::sqrt(variance[std::size_t(y) * std::size_t(on.width) + std::size_t(x)]) / on.albedo_at(c, x, y);
        const float share =
            sum > 0 ? std::abs(group_.raw[0].layers[l][c].at(x, y)) / sum : 1 / float(group_.layers.size());
        noise.at(x, y) = deviation < kLargestLight ? sign(x, y) * deviation * share : 0;  // NaN becomes 0
      }
    });
  }

  const LightGroup& group_;
  std::vector<Plane> noise_;
};

}  // namespace

LightGroup::LightGroup(const Image& image, bool seen, std::vector<std::string> names)
    : surfaces(image, seen), layers(std::move(names)), variance(image.width, image.height) {
  take_light(image);
  take_noise(image);
  for (Light& half : raw) {
    half.weight = Plane::unset(image.width, image.height);
    for_each_row(image.height, [&](int y) { std::copy_n(surfaces.use.row(y), image.width, half.weight.row(y)); });
  }
}

/// Reads the light of the layers into the first half; take_noise() makes both halves from it.
void LightGroup::take_light(const Image& image) {
  for (Light& half : raw) half.layers.resize(layers.size());
  for (std::size_t l = 0; l < layers.size(); ++l)
    for (std::size_t c = 0; c < 3 && !is_black(image, layers[l]); ++c) {
      Plane& light = raw[0].layers[l][c] = Plane::unset(image.width, image.height);
      light.take(image.find(channel_name(layers[l], c))->values, image.width);
      for_each_row(image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
          float& value = light.at(x, y);
          value /= surfaces.albedo_at(c, x, y);
          if (!(std::abs(value) < kLargestLight)) value = surfaces.use.at(x, y) = 0;
        }
      });
    }
}

/// Makes the halves: the second is light - noise, the first becomes light + noise.
void LightGroup::take_noise(const Image& image) {
  const auto has_noise = [&](const std::string& layer) { return holds(image, layer + ".noise.R"); };
  std::optional<MadeUpNoise> made_up;
  if (std::none_of(layers.begin(), layers.end(), has_noise)) made_up.emplace(image, *this);
  std::vector<std::vector<std::size_t>> confirmed;
  for (const std::string& layer : layers) confirmed.push_back(confirmed_in(image, layer));
  for (std::size_t c = 0; c < 3; ++c) {
    Plane total(image.width, image.height);
    for (std::size_t l = 0; l < layers.size(); ++l) {
      Plane &a = raw[0].layers[l][c], &b = raw[1].layers[l][c];
      if (a.empty()) continue;
      b = Plane::unset(image.width, image.height);
      const Channel* channel = made_up ? nullptr : image.find(channel_name(layers[l] + ".noise", c));
      for_each_row(image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
          float noise = made_up ? made_up->of(l, c).at(x, y) : 0;
          if (channel)
            noise = channel->values[std::size_t(y) * std::size_t(image.width) + std::size_t(x)] /
                    surfaces.albedo_at(c, x, y);
          if (!(std::abs(noise) < kLargestLight)) noise = surfaces.use.at(x, y) = 0;
          b.at(x, y) = a.at(x, y) - noise;
          a.at(x, y) += noise;
          total.at(x, y) += noise;
        }
      });
      for (const std::size_t p : confirmed[l]) {
        const int x = int(p % std::size_t(image.width)), y = int(p / std::size_t(image.width));
        total.at(x, y) -= (a.at(x, y) - b.at(x, y)) / 2;
        a.at(x, y) = b.at(x, y) = a.at(x, y) / 2 + b.at(x, y) / 2;
      }
    }
    for_each_row(image.height, [&](int y) {
      for (int x = 0; x < image.width; ++x) variance.at(x, y) += 2 * total.at(x, y) * total.at(x, y);
    });
  }
}

bool knows_noise(const Image& image) {
  return has_colour(image, "diffuse.variance") || has_colour(image, "variance") || has_colour(image, "albedo") ||
         std::any_of(kMatteLayers.begin(), kMatteLayers.end(),
                     [&](const std::string& layer) { return holds(image, layer + ".noise.R"); });
}

void check_noise(const Image& image) {
  for (const std::string layer : kFrameLayers)
    if (const std::string noise = layer + ".noise";
        holds(image, noise + ".R") && !(has_colour(image, layer) && has_colour(image, noise)))
      throw InputError("noise of layer " + layer +
                       " is not all there, or the layer is not; write it with --channels layers,halves");
}

FrameLight::FrameLight(const Image& image) {
  check_noise(image);
  for (std::size_t g = 0; g < kGroups; ++g) {
    std::vector<std::string> layers;
    bool noise = g == 0;
    for (const std::string layer :
         g == 0 ? std::span<const char* const>(kMatteLayers) : std::span<const char* const>(kSeenLayers)) {
      noise = noise || holds(image, layer + ".noise.R");
      if (has_colour(image, layer)) layers.push_back(layer);
    }
    if (g == 0 && layers.empty() && has_colour(image, "")) layers.push_back("");
    if (noise && !layers.empty()) groups_[g].emplace(image, g == 1, std::move(layers));
  }
}

bool is_read_to_filter(const std::string& channel) {
  constexpr std::array<const char*, 18> kGroupsRead{"RGBA",   "direct",   "caustic", "indirect", "emission", "specular",
                                                    "volume", "seen",     "albedo",  "Z",        "N",        "id",
                                                    "motion", "coverage", "samples", "variance", "diffuse",  "halves"};
  return std::any_of(kGroupsRead.begin(), kGroupsRead.end(),
                     [&](const char* group) { return is_in_group(channel, group); });
}

}  // namespace tempolux
