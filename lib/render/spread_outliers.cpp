#include "lib/render/spread_outliers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr int kNear = 2;            ///< pixels: the 24 pixels within this distance give the local light
constexpr double kConfirmed = 0.5;  ///< share of the outlier that other samples must find to confirm it

/// The light taken from a pixel, and how far it is spread.
struct Excess {
  std::size_t pixel;
  Layer layer;
  int level;  ///< box filters reach 2^level pixels
  Rgbd radiance;
  int samples;  ///< samples of the outlier's part
};

double radiance_of(const Layers& pixel) {
  double sum = 0;
  for (const Rgb& radiance : pixel.value) sum += channel_mean(Rgbd(radiance));
  return sum;
}

/// Mean of value(pixel) over the pixels around (x, y), without (x, y) itself.
template <class Value>
double around(int width, int height, int x, int y, const Value& value) {
  double sum = 0;
  int n = 0;
  for (int j = std::max(0, y - kNear); j <= std::min(height - 1, y + kNear); ++j)
    for (int i = std::max(0, x - kNear); i <= std::min(width - 1, x + kNear); ++i) {
      if (i == x && j == y) continue;
      sum += value(std::size_t(j) * std::size_t(width) + std::size_t(i));
      ++n;
    }
  return n > 0 ? sum / n : 0;
}

std::vector<double> radiances_of(const std::vector<Layers>& pixels) {
  std::vector<double> radiances(pixels.size());
  parallel_chunks(pixels.size(), 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) radiances[p] = radiance_of(pixels[p]);
  });
  return radiances;
}

/// The error that each pixel may have.
std::vector<double> errors_of(const SampledPixels& samples, const std::vector<double>& radiances) {
  std::vector<double> errors(radiances.size());
  parallel_chunks(radiances.size() / std::size_t(samples.width), 1, [&](std::size_t y, std::size_t) {
    for (int x = 0; x < samples.width; ++x)
      errors[y * std::size_t(samples.width) + std::size_t(x)] =
          samples.error(around(samples.width, samples.height, x, int(y), [&](std::size_t p) { return radiances[p]; }));
  });
  return errors;
}

/// Level of the widest box that is no wider than the picture: three passes of it leave a nearly uniform result.
int last_level(int width, int height) {
  int level = 0;
  while ((2 << (level + 1)) + 1 <= std::max(width, height)) ++level;
  return level;
}

/// The lowest level at which a pixel keeps at most `error` of its excess. After three passes of a box of b values, the
/// middle holds (3 b^2 + 1) / (4 b^3).
int level_of(double excess, double error, int last) {
  int level = 0;
  for (; level < last; ++level) {
    const double box = (2 << level) + 1, middle = (3 * box * box + 1) / (4 * box * box * box);
    if (excess * middle * middle <= error) break;
  }
  return level;
}

/// Three passes of a box filter of 2 r + 1 values, mirrored at the ends, so that the sum stays the same. Values are
/// `step` apart.
void blur_line(double* values, int count, std::size_t step, int r, std::vector<double>& sums,
               std::vector<double>& line) {
  const auto mirrored = [count](int i) {
    while (i < 0 || i >= count) i = i < 0 ? -1 - i : 2 * count - 1 - i;
    return i;
  };
  sums.resize(std::size_t(count + 2 * r + 1));
  line.resize(std::size_t(count));
  bool empty = true;  // with few outliers most lines are empty
  for (int i = 0; i < count; ++i) {
    line[std::size_t(i)] = values[std::size_t(i) * step];
    empty = empty && line[std::size_t(i)] == 0;
  }
  if (empty) return;
  for (int pass = 0; pass < 3; ++pass) {
    sums[0] = 0;
    for (int i = 0; i < count + 2 * r; ++i)
      sums[std::size_t(i) + 1] = sums[std::size_t(i)] + line[std::size_t(mirrored(i - r))];
    for (int i = 0; i < count; ++i)
      line[std::size_t(i)] = (sums[std::size_t(i + 2 * r + 1)] - sums[std::size_t(i)]) / (2 * r + 1);
  }
  for (int i = 0; i < count; ++i) values[std::size_t(i) * step] = line[std::size_t(i)];
}

void blur(std::vector<double>& image, int width, int height, int r) {
  constexpr std::size_t kLines = 16;
  parallel_chunks(std::size_t(height), kLines, [&](std::size_t first, std::size_t last) {
    std::vector<double> sums, line;
    for (std::size_t y = first; y < last; ++y)
      blur_line(image.data() + y * std::size_t(width), width, 1, r, sums, line);
  });
  parallel_chunks(std::size_t(width), kLines, [&](std::size_t first, std::size_t last) {
    std::vector<double> sums, line;
    for (std::size_t x = first; x < last; ++x) blur_line(image.data() + x, height, std::size_t(width), r, sums, line);
  });
}

/// By pixel how much of the spread light of a layer it gets: the median of the layer's light within kNear, plus the
/// error that the pixel may have; 0 where the pixel gets none. The median ignores single bright samples and keeps the
/// rims of surfaces.
std::vector<double> weights_of(const SampledPixels& samples, const std::vector<Layers>& pixels,
                               const std::vector<double>& errors, Layer layer) {
  const int width = samples.width, height = samples.height;
  std::vector<double> weight(pixels.size());
  parallel_chunks(std::size_t(height), 1, [&](std::size_t row, std::size_t) {
    std::vector<double> near;
    for (int x = 0, y = int(row); x < width; ++x) {
      const std::size_t pixel = row * std::size_t(width) + std::size_t(x);
      if (!(pixels[pixel].coverage > 0) || !samples.takes_part(pixel)) continue;
      near.clear();
      for (int j = std::max(0, y - kNear); j <= std::min(height - 1, y + kNear); ++j)
        for (int i = std::max(0, x - kNear); i <= std::min(width - 1, x + kNear); ++i) {
          const double light = channel_mean(Rgbd(pixels[std::size_t(j) * std::size_t(width) + std::size_t(i)][layer]));
          near.push_back(std::isfinite(light) ? std::max(0.0, light) : 0.0);
        }
      const auto middle = near.begin() + std::ptrdiff_t(near.size() / 2);
      std::nth_element(near.begin(), middle, near.end());
      if (std::isfinite(errors[pixel])) weight[pixel] = *middle + errors[pixel];
    }
  });
  return weight;
}

/// Spreads `excess` (one level of one layer) as w blur(excess / blur(w)). Its sum is that of `excess` for any weights
/// w.
void spread(std::span<const Excess> excess, int width, int height, const std::vector<double>& weight,
            const std::vector<double>& blurred, std::vector<Layers>& pixels) {
  const int r = 1 << excess.front().level;
  const std::size_t layer = std::size_t(excess.front().layer);
  for (int c = 0; c < 3; ++c) {
    std::vector<double> given(weight.size());
    bool any = false;
    for (const Excess& e : excess) {
      given[e.pixel] += e.radiance[c] / blurred[e.pixel];
      any = any || e.radiance[c] != 0;
    }
    if (!any) continue;
    blur(given, width, height, r);
    for (std::size_t p = 0; p < pixels.size(); ++p)
      if (weight[p] > 0)
        pixels[p].value[layer][c] = float(double(pixels[p].value[layer][c]) + weight[p] * std::max(0.0, given[p]));
  }
}

void excess_of(const SampledPixels& samples, const std::vector<Layers>& pixels, double error, int x, int y, int last,
               std::vector<Excess>& found) {
  const std::size_t pixel = std::size_t(y) * std::size_t(samples.width) + std::size_t(x);
  if (!samples.takes_part(pixel)) return;
  const BrightestSamples& brightest = samples.brightest[pixel];
  const PartCounts& counts = samples.counts[pixel];
  const FurtherSamples* const further = samples.further_of.empty() || samples.further_of[pixel] == kNone
                                            ? nullptr
                                            : &samples.further[samples.further_of[pixel]];
  const auto look = [&](const BrightestSample& sample, Layers PathParts::*part, int PartCounts::*number) {
    const int count = counts.*number;
    const double claimed = channel_mean(Rgbd(sample.radiance)) / count;
    if (!(claimed > error) || !(error > 0)) return;
    // Two bright samples of many may be chance, so neither confirms the other.
    const double second = channel_mean(Rgbd(sample.second)) / count;
    double others = (channel_mean(Rgbd((samples.parts[pixel].*part)[sample.layer])) - claimed - second) * count;
    int other_count = count - 2;
    if (further) {
      others += channel_mean(Rgbd((further->mean.*part)[sample.layer])) * further->count.*number;
      other_count += further->count.*number;
    }
    others = other_count > 0 ? others / other_count : 0;
    const double beside = around(samples.width, samples.height, x, y,
                                 [&](std::size_t p) { return channel_mean(Rgbd(pixels[p][sample.layer])); });
    const double allowed = error + std::max(others, beside);
    if (!(claimed > allowed) || !std::isfinite(claimed)) return;
    // If further samples found about one such sample's light again, the light is confirmed.
    if (further && (others - beside) * other_count >= kConfirmed * claimed * count) return;
    const double both = claimed - allowed + std::max(0.0, second - allowed);
    Rgbd excess = Rgbd(sample.radiance) * ((1 - allowed / claimed) / count);
    if (second > allowed) excess += Rgbd(sample.second) * ((1 - allowed / second) / count);
    found.push_back({pixel, sample.layer, level_of(both, error, last), excess, count});
  };
  look(brightest.own, &PathParts::own, &PartCounts::own);
  look(brightest.lit, &PathParts::lit, &PartCounts::lit);
  look(brightest.onward, &PathParts::onward, &PartCounts::onward);
}

std::vector<Excess> all_excess(const SampledPixels& samples, const std::vector<Layers>& pixels,
                               const std::vector<double>& errors) {
  const int width = samples.width, last = last_level(width, samples.height);
  std::vector<std::vector<Excess>> by_row(samples.counts.size() / std::size_t(std::max(1, width)));
  parallel_chunks(by_row.size(), 1, [&](std::size_t y, std::size_t) {
    for (int x = 0; x < width; ++x)
      excess_of(samples, pixels, errors[y * std::size_t(width) + std::size_t(x)], x, int(y), last, by_row[y]);
  });
  std::vector<Excess> all;
  for (const std::vector<Excess>& row : by_row) all.insert(all.end(), row.begin(), row.end());
  return all;
}

}  // namespace

void BrightestSample::note(const Layers& sample, bool specular_alone) {
  for (const Layer of : {Layer::specular, Layer::direct, Layer::caustic, Layer::indirect, Layer::volume}) {
    if (specular_alone && of != Layer::specular) continue;
    if (const float sum = channel_sum(sample[of]); sum > brightest) {
      second = layer == of ? radiance : Rgb(0.0f);
      brightest = sum;
      radiance = sample[of];
      layer = of;
    } else if (layer == of && sum > channel_sum(second)) {
      second = sample[of];
    }
  }
}

std::vector<std::size_t> pixels_to_judge(const SampledPixels& samples, const std::vector<Layers>& pixels) {
  std::vector<std::size_t> found;
  for (const Excess& excess : all_excess(samples, pixels, errors_of(samples, radiances_of(pixels))))
    if (excess.samples < kJudges && (found.empty() || found.back() != excess.pixel)) found.push_back(excess.pixel);
  return found;
}

double spread_outliers(const SampledPixels& samples, std::vector<Layers>& pixels) {
  const int width = samples.width, height = samples.height;
  const std::vector<double> radiances = radiances_of(pixels);
  const std::vector<double> errors = errors_of(samples, radiances);
  std::vector<Excess> all = all_excess(samples, pixels, errors);
  if (all.empty()) return 0;
  const double light = std::accumulate(radiances.begin(), radiances.end(), 0.0);
  double moved = 0;
  for (const Excess& e : all) {
    moved += channel_mean(e.radiance);
    for (int c = 0; c < 3; ++c) {
      float& value = pixels[e.pixel][e.layer][c];
      value = float(double(value) - e.radiance[c]);
    }
  }
  std::vector<double> weight, blurred;
  std::stable_sort(all.begin(), all.end(), [](const Excess& a, const Excess& b) {
    return a.layer != b.layer ? a.layer < b.layer : a.level < b.level;
  });
  for (std::size_t first = 0, end; first < all.size(); first = end) {
    for (end = first; end < all.size() && all[end].level == all[first].level && all[end].layer == all[first].layer;)
      ++end;
    const Layer layer = all[first].layer;
    if (first == 0 || layer != all[first - 1].layer) weight = weights_of(samples, pixels, errors, layer);
    blurred = weight;
    blur(blurred, width, height, 1 << all[first].level);
    spread({all.data() + first, end - first}, width, height, weight, blurred, pixels);
  }
  return light > 0 ? moved / light : 0;
}

}  // namespace tempolux
