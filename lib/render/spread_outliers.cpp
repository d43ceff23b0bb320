#include "lib/render/spread_outliers.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel_each.h"
#include "lib/core/statistics.h"
#include "lib/render/pixels_around.h"

namespace tempolux {
namespace {

constexpr double kConfirmed = 0.5;  ///< an outlier is confirmed if the other samples find this share of its light

/// An outlier: light that a pixel may give away.
struct Excess {
  std::size_t pixel;
  Layer layer;
  Rgbd radiance;
  int samples;       ///< samples of the outlier's part
  double seen2 = 0;  ///< visible squared error of the pixel if the light stays, over the square of the allowed error
  double light() const { return channel_mean(radiance); }
};

/// Calls body(pixel) for the 24 pixels around (x, y), as far as they take part.
template <class Body>
void for_each_near(const SampledPixels& samples, int x, int y, const Body& body) {
  for_each_around(samples.width, samples.height, x, y, kNearPixels, [&](std::size_t pixel, int, int) {
    if (samples.takes_part(pixel)) body(pixel);
  });
}

/// Level of the widest box, of radius 2^level, that is no wider than the picture. Its three passes leave a nearly
/// uniform picture.
int last_level(int width, int height) {
  int level = 0;
  while ((2 << (level + 1)) + 1 <= std::max(width, height)) ++level;
  return level;
}

/// Three passes of a box filter of 2 r + 1 values over a line of `count` values, which lie `step` apart in memory. The
/// line is mirrored at its ends, so the sum stays the same. sums, line: memory that calls reuse.
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

/// blur_line() of all rows, then of all columns.
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

/// Moves outliers that can be spread with box radius r from `waiting` to `spread`, in their order. An outlier of light
/// L spreads over the 3 x 3 cells of r x r pixels around it. Let S be the sum of the allowed errors e in these cells, U
/// the light that they have received before, and n their number of pixels, 9 r^2 inside the picture. Three boxes of b =
/// 2 r + 1 pixels leave the share m^2 of the light in the middle pixel, m = (3 b^2 + 1) / (4 b^3). If 1 / m^2 is less
/// than 9 r^2, n, S and U are reduced by the factor between them. The outlier is spread if
///     L <= S: its light per pixel is below the allowed error; and
///     n L / S (2 U / S + L / S) <= seen2: the squared error that it adds over e^2, n ((U + L)^2 - U^2) / S^2, is at
///     most its visible squared error as a single bright pixel.
/// Cells outside the picture add nothing to S and n, because blur() mirrors their light back.
void take_fitting(std::vector<Excess>& waiting, const std::vector<double>& errors, const std::vector<double>& got,
                  int width, int r, std::vector<Excess>& spread) {
  struct Cell {
    double room = 0, used = 0, pixels = 0;
  };
  const std::size_t w = std::size_t(width), side = std::size_t(r);
  const int columns = (width + r - 1) / r, rows = int((errors.size() / w + side - 1) / side);
  std::vector<Cell> cells(std::size_t(columns * rows));
  const double box = 2 * r + 1, middle = (3 * box * box + 1) / (4 * box * box * box);
  const double share = std::min(1.0, 1 / (9.0 * r * r * middle * middle));
  for (std::size_t p = 0; p < errors.size(); ++p) {
    Cell& cell = cells[p / w / side * std::size_t(columns) + p % w / side];
    cell.room += share * errors[p];
    cell.used += share * got[p];
    cell.pixels += share;
  }
  std::vector<Excess> stay;
  for (const Excess& excess : waiting) {
    const int i = int(excess.pixel % w / side), j = int(excess.pixel / w / side);
    Cell around;
    for (int v = std::max(0, j - 1); v <= std::min(rows - 1, j + 1); ++v)
      for (int u = std::max(0, i - 1); u <= std::min(columns - 1, i + 1); ++u) {
        around.room += cells[std::size_t(v * columns + u)].room;
        around.used += cells[std::size_t(v * columns + u)].used;
        around.pixels += cells[std::size_t(v * columns + u)].pixels;
      }
    const double light = excess.light() / around.room, used = around.used / around.room;
    const bool fits = around.room > 0 && light <= 1 && around.pixels * light * (2 * used + light) <= excess.seen2;
    if (fits) cells[std::size_t(j * columns + i)].used += excess.light();
    (fits ? spread : stay).push_back(excess);
  }
  waiting = std::move(stay);
}

/// Takes `excess` out of its pixels and adds w blur(excess / blur(w)) to `pixels`, with the weights w. The sum of each
/// layer stays the same for any w. Adds the light that each pixel receives to `all`.
void spread(std::span<const Excess> excess, const SampledPixels& samples, int r, const std::vector<double>& weight,
            std::vector<double>& all, std::vector<Layers>& pixels) {
  std::vector<double> blurred = weight, given;
  blur(blurred, samples.width, samples.height, r);
  for (std::size_t layer = 0; layer < kLayerCount; ++layer)
    for (int c = 0; c < 3; ++c) {
      given.assign(weight.size(), 0);
      bool any = false;
      for (const Excess& e : excess) {
        if (std::size_t(e.layer) != layer || e.radiance[c] == 0) continue;
        float& value = pixels[e.pixel].value[layer][c];
        value = float(double(value) - e.radiance[c]);
        given[e.pixel] += e.radiance[c] / blurred[e.pixel];
        any = true;
      }
      if (!any) continue;
      blur(given, samples.width, samples.height, r);
      for (std::size_t p = 0; p < pixels.size(); ++p) {
        const double got = weight[p] * std::max(0.0, given[p]);
        pixels[p].value[layer][c] = float(double(pixels[p].value[layer][c]) + got);
        all[p] += got / 3;
      }
    }
}

/// Appends the outliers of pixel (x, y), at most one for each part. error: the pixel's allowed error.
void excess_of(const SampledPixels& samples, const std::vector<Layers>& pixels, double error, int x, int y,
               std::vector<Excess>& found) {
  const std::size_t pixel = std::size_t(y) * std::size_t(samples.width) + std::size_t(x);
  const BrightestSamples& brightest = samples.brightest[pixel];
  const PartCounts& counts = samples.counts[pixel];
  const auto found_further = samples.further.find(pixel);
  const FurtherSamples* const further = found_further == samples.further.end() ? nullptr : &found_further->second;
  const auto look = [&](const BrightestSample& sample, Layers PathParts::*part, int PartCounts::*number) {
    const int count = counts.*number;
    const double claimed = channel_mean(Rgbd(sample.radiance)) / count;
    if (!(claimed > error) || !(error > 0)) return;
    // The two brightest samples may both be outliers, so neither confirms the other.
    const double second = channel_mean(Rgbd(sample.second)) / count;
    double others = (channel_mean(Rgbd((samples.parts[pixel].*part)[sample.layer])) - claimed - second) * count;
    int other_count = count - 2;
    if (further) {
      others += channel_mean(Rgbd((further->mean.*part)[sample.layer])) * further->count.*number;
      other_count += further->count.*number;
    }
    others = other_count > 0 ? others / other_count : 0;
    double beside = 0;
    int near = 0;
    for_each_near(samples, x, y, [&](std::size_t p) {
      beside += channel_mean(Rgbd(pixels[p][sample.layer]));
      ++near;
    });
    beside /= std::max(1, near);
    const double allowed = error + std::max(others, beside);
    if (!(claimed > allowed) || !std::isfinite(claimed)) return;
    // The light is confirmed if the other samples found about as much light as this one sample.
    if (further && (others - beside) * other_count >= kConfirmed * claimed * count) return;
    Rgbd excess = Rgbd(sample.radiance) * ((1 - allowed / claimed) / count);
    if (second > allowed) excess += Rgbd(sample.second) * ((1 - allowed / second) / count);
    found.push_back({.pixel = pixel, .layer = sample.layer, .radiance = excess, .samples = count});
  };
  look(brightest.own, &PathParts::own, &PartCounts::own);
  look(brightest.lit, &PathParts::lit, &PartCounts::lit);
  look(brightest.onward, &PathParts::onward, &PartCounts::onward);
}

/// The outliers of all pixels, in the order of the pixels.
std::vector<Excess> all_excess(const SampledPixels& samples, const std::vector<Layers>& pixels,
                               const std::vector<double>& errors) {
  const std::size_t width = std::size_t(samples.width);
  return parallel_found<Excess>(pixels.size(), width, [&](std::size_t p, std::vector<Excess>& found) {
    excess_of(samples, pixels, errors[p], int(p % width), int(p / width), found);
  });
}

/// Sets Excess::seen2 to ((T - M) / e(T))^2. M is the pixel's radiance without the outlier. T is M plus the outlier's
/// light, cut at white, because a display shows nothing above white; T = M if M is above white. e(T) is the allowed
/// error at T. White is the median radiance of the pixels over .18, as at the exposure at which seen errors are
/// measured.
void note_what_is_seen(const SampledPixels& samples, const std::vector<Layers>& pixels, std::vector<Excess>& outliers) {
  std::vector<double> radiances;
  for (std::size_t p = 0; p < pixels.size(); ++p)
    if (samples.takes_part(p)) radiances.push_back(std::max(0.0, radiance_of(pixels[p])));
  if (radiances.empty()) return;
  const double white = upper_median(radiances) / 0.18;
  for (Excess& outlier : outliers) {
    const double under = std::max(0.0, radiance_of(pixels[outlier.pixel]) - outlier.light()),
                 top = std::min(under + outlier.light(), std::max(white, under)), error = samples.error(top);
    outlier.seen2 = error > 0 ? (top - under) * (top - under) / (error * error) : 0;
  }
}

}  // namespace

void BrightestSample::note(const Layers& sample) {
  for (const Layer of : {Layer::specular, Layer::direct, Layer::caustic, Layer::indirect, Layer::volume}) {
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

std::vector<double> allowed_errors(const SampledPixels& samples, const std::vector<Layers>& pixels) {
  std::vector<double> errors(pixels.size());
  parallel_chunks(std::size_t(samples.height), 1, [&](std::size_t row, std::size_t) {
    std::vector<double> near;
    const auto note = [&](std::size_t p) {
      const double radiance = radiance_of(pixels[p]);
      near.push_back(std::isfinite(radiance) ? radiance : 0);
    };
    for (int x = 0, y = int(row); x < samples.width; ++x) {
      const std::size_t pixel = row * std::size_t(samples.width) + std::size_t(x);
      if (!(pixels[pixel].coverage > 0) || !samples.takes_part(pixel)) continue;
      near.clear();
      note(pixel);
      for_each_near(samples, x, y, note);
      const double error = samples.error(upper_median(near));
      if (std::isfinite(error)) errors[pixel] = error;
    }
  });
  return errors;
}

std::vector<std::size_t> pixels_to_judge(const SampledPixels& samples, const std::vector<Layers>& pixels,
                                         const std::vector<double>& errors) {
  std::vector<std::size_t> found;
  for (const Excess& excess : all_excess(samples, pixels, errors))
    if (excess.samples < kJudges && (found.empty() || found.back() != excess.pixel)) found.push_back(excess.pixel);
  return found;
}

double spread_outliers(const SampledPixels& samples, const std::vector<double>& errors, std::vector<Layers>& pixels) {
  const int last = last_level(samples.width, samples.height);
  std::vector<Excess> waiting = all_excess(samples, pixels, errors), taken;
  double light = 0, moved = 0;
  for (const Layers& pixel : pixels) light += radiance_of(pixel);
  std::stable_sort(waiting.begin(), waiting.end(),
                   [](const Excess& a, const Excess& b) { return a.light() < b.light(); });
  note_what_is_seen(samples, pixels, waiting);
  std::vector<double> got(errors.size(), 0.0);
  for (int level = 0; level <= last && !waiting.empty(); ++level) {
    taken.clear();
    take_fitting(waiting, errors, got, samples.width, 1 << level, taken);
    if (taken.empty()) continue;
    for (const Excess& e : taken) moved += e.light();
    spread(taken, samples, 1 << level, errors, got, pixels);
  }
  return light > 0 ? moved / light : 0;
}

}  // namespace tempolux
