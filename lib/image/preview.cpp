#include "lib/image/preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "formats/error.h"
#include "lib/core/random.h"
#include "lib/core/vec.h"
#include "lib/image/foreign_names.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr double kAutoTarget = 0.9;  // linear value that the 98th percentile is mapped to
constexpr double kAutoPercentile = 0.98;
constexpr std::uint32_t kNothingId = 0xffffffffu;

using Planes = std::vector<const std::vector<float>*>;

/// The planes LAYER.a, LAYER.b ...; empty unless all exist.
Planes planes_of(const Image& image, const std::string& layer, std::initializer_list<const char*> names) {
  Planes planes;
  for (const char* name : names) {
    const Channel* channel = image.find(layer_channel(layer, name));
    if (!channel || channel->values.empty()) return {};
    planes.push_back(&channel->values);
  }
  return planes;
}

/// The meaning of a layer's name in this image.
struct Content {
  enum class Kind { colour, depth, vector, motion, ids } kind;
  Planes planes;  // 3, 2 or 1; empty for ids
  const std::vector<std::uint32_t>* ids = nullptr;
};

Content find_content(const Image& image, const std::string& layer) {
  using Kind = Content::Kind;
  if (auto planes = planes_of(image, layer, {"R", "G", "B"}); !planes.empty()) return {Kind::colour, planes};
  if (const Channel* channel = image.find(layer)) {
    if (!channel->ids.empty()) return {Kind::ids, {}, &channel->ids};
    const bool depth = layer == "Z" || (layer.ends_with(".Z") && !image.find(layer.substr(0, layer.size() - 1) + "X"));
    return {depth ? Kind::depth : Kind::colour, {&channel->values}};
  }
  if (auto planes = planes_of(image, layer, {"X", "Y", "Z"}); !planes.empty()) return {Kind::vector, planes};
  if (auto planes = planes_of(image, layer, {"u", "v"}); !planes.empty()) return {Kind::motion, planes};
  std::string known;
  for (const Channel& channel : image.channels) known += (known.empty() ? "" : " ") + channel.name;
  throw InputError("no layer or channel \"" + (layer.empty() ? "RGB" : layer) + "\"; the image has " + known);
}

/// A layer counts as signed if its negative values have more than this share of the sum of all magnitudes. In
/// differences of noise they have half. Light has no negative values, except by rounding and in the lobes of a sharp
/// pixel filter.
constexpr double kSigned = 0.02;

bool is_signed(const Planes& planes) {
  double below = 0, all = 0;
  for (const auto* plane : planes)
    for (const float v : *plane)
      if (std::isfinite(v)) all += double(std::abs(v)), below += double(std::max(-v, 0.0f));
  return below > kSigned * all;
}

/// The pixel's component of largest magnitude, with its sign.
float largest_component(const Planes& planes, std::size_t pixel) {
  float largest = 0;
  for (const auto* plane : planes)
    if (std::abs((*plane)[pixel]) > std::abs(largest)) largest = (*plane)[pixel];
  return largest;
}

/// The value of rank ceil(fraction n) among n values; 0 without values. Reorders the values.
float percentile(std::vector<float>& values, double fraction) {
  if (values.empty()) return 0;
  const double rank = std::ceil(fraction * double(values.size()));
  const auto at = values.begin() + std::ptrdiff_t(std::max(rank, 1.0)) - 1;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double stops_of(const Content& content) {
  if (content.kind != Content::Kind::colour && content.kind != Content::Kind::motion) return 0;
  const Planes& planes = content.planes;
  const bool by_luminance = planes.size() == 3 && !is_signed(planes);
  std::vector<float> values;
  values.reserve(planes[0]->size());
  for (std::size_t i = 0; i < planes[0]->size(); ++i) {
    const float value = by_luminance ? luminance(Rgb((*planes[0])[i], (*planes[1])[i], (*planes[2])[i]))
                                     : std::abs(largest_component(planes, i));
    if (std::isfinite(value)) values.push_back(value);
  }
  float bright = percentile(values, kAutoPercentile);
  if (!(bright > 0) && !values.empty()) bright = *std::max_element(values.begin(), values.end());
  return bright > 0 ? std::log2(kAutoTarget / double(bright)) : 0;
}

std::uint8_t to_byte(float unit) { return std::uint8_t(std::lround(255 * std::clamp(unit, 0.0f, 1.0f))); }

using Encoded = std::array<float, 3>;  // sRGB-encoded, not yet clipped to [0, 1]

/// Makes a picture of the colours shade(i) of all pixels i; colours that are not finite become black.
template <class Shade>
Picture shade_pixels(const Image& image, Shade shade) {
  Picture picture{image.width, image.height, std::vector<std::uint8_t>(image.pixel_count() * 3)};
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    const Encoded pixel = shade(i);
    const bool finite = std::isfinite(pixel[0]) && std::isfinite(pixel[1]) && std::isfinite(pixel[2]);
    for (std::size_t c = 0; c < 3; ++c) picture.rgb[3 * i + c] = finite ? to_byte(pixel[c]) : 0;
  }
  return picture;
}

Picture colour_picture(const Image& image, const Planes& planes, float scale) {
  if (is_signed(planes)) {
    return shade_pixels(image, [&](std::size_t i) {
      const float d = largest_component(planes, i), t = linear_to_srgb(scale * std::abs(d));
      const Encoded end = d > 0 ? Encoded{1, 0.2f, 0} : Encoded{0, 0.25f, 1};
      return Encoded{0.5f + t * (end[0] - 0.5f), 0.5f + t * (end[1] - 0.5f), 0.5f + t * (end[2] - 0.5f)};
    });
  }
  return shade_pixels(image, [&](std::size_t i) {
    Encoded pixel;
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = (*planes[planes.size() == 3 ? c : 0])[i];
      pixel[c] = std::isfinite(value) ? linear_to_srgb(scale * value) : NAN;
    }
    return pixel;
  });
}

Picture depth_picture(const Image& image, const std::vector<float>& depth) {
  const auto something = [](float z) { return z < kNothingDepth && z > -kNothingDepth; };
  std::vector<float> values;
  std::copy_if(depth.begin(), depth.end(), std::back_inserter(values), something);
  const float near = percentile(values, 0.01), far = percentile(values, 0.99);
  return shade_pixels(image, [&](std::size_t i) {
    if (!something(depth[i])) return Encoded{0, 0, 0};
    const float t = far > near ? std::clamp((depth[i] - near) / (far - near), 0.0f, 1.0f) : 0.0f;
    const float grey = 1 - 0.9f * t;
    return Encoded{grey, grey, grey};
  });
}

Picture vector_picture(const Image& image, const Planes& planes) {
  std::array<float, 3> low{-1, -1, -1}, high{1, 1, 1};
  const bool unit = std::all_of(planes.begin(), planes.end(), [](const auto* plane) {
    return std::all_of(plane->begin(), plane->end(), [](float v) { return std::abs(v) <= 1.001f; });
  });
  for (std::size_t c = 0; !unit && c < 3; ++c) {
    low[c] = INFINITY;
    high[c] = -INFINITY;
    for (float v : *planes[c])
      if (std::isfinite(v)) low[c] = std::min(low[c], v), high[c] = std::max(high[c], v);
    if (!(high[c] > low[c])) low[c] -= 1, high[c] += 1;
  }
  return shade_pixels(image, [&](std::size_t i) {
    Encoded pixel;
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = ((*planes[c])[i] - low[c]) / (high[c] - low[c]);
    return pixel;
  });
}

Picture id_picture(const Image& image, const std::vector<std::uint32_t>& ids) {
  return shade_pixels(image, [&](std::size_t i) {
    if (ids[i] == kNothingId) return Encoded{0, 0, 0};
    const std::uint64_t bits = mix64(ids[i] + 1ull);
    const auto part = [&](int shift) { return 0.25f + 0.75f * float(bits >> shift & 0xff) / 255; };
    return Encoded{part(0), part(8), part(16)};
  });
}

}  // namespace

double auto_exposure_stops(const Image& image, const std::string& layer) {
  return stops_of(find_content(image, layer));
}

Picture make_picture(const Image& image, const PreviewOptions& options) {
  const Content content = find_content(image, options.layer);
  const double stops = options.exposure_stops ? *options.exposure_stops : stops_of(content);
  const auto scale = float(std::exp2(stops));
  const Planes& planes = content.planes;
  switch (content.kind) {
    case Content::Kind::depth: return depth_picture(image, *planes[0]);
    case Content::Kind::vector: return vector_picture(image, planes);
    case Content::Kind::ids: return id_picture(image, *content.ids);
    case Content::Kind::motion:
      return shade_pixels(image, [&](std::size_t i) {
        return Encoded{0.5f + 0.5f * scale * (*planes[0])[i], 0.5f + 0.5f * scale * (*planes[1])[i], 0.5f};
      });
    case Content::Kind::colour: break;
  }
  return colour_picture(image, planes, scale);
}

}  // namespace tempolux
