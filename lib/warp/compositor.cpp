#include "lib/warp/compositor.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

/// a += w (b - c) for `stride` floats, a multiple of 8. Differences keep the bits of equal colours, whatever the
/// weights.
void add_difference(float* a, float w, const float* b, const float* c, std::size_t stride) {
  for (std::size_t i = 0; i < stride; i += 8)
    for (std::size_t j = 0; j < 8; ++j) a[i + j] += w * (b[i + j] - c[i + j]);
}

/// The weighted mean of the colours of a key's pixels.
void mean_of(const KeyFrame& key, const Taps& taps, std::size_t stride, float* mean) {
  const float* first = key.colour(taps.pixel[0]);
  std::copy_n(first, stride, mean);
  for (int t = 1; t < taps.count; ++t)
    add_difference(mean, taps.weight[std::size_t(t)], key.colour(taps.pixel[std::size_t(t)]), first, stride);
}

}  // namespace

Compositor::Compositor(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options)
    : target_(target), keys_(keys), options_(options), stride_(keys[0].view->key().stride()) {
  for (std::size_t k = 0; k < keys.size(); ++k) {
    // Between two keys the weight is linear in time: a key's weight is the other key's distance over the sum of both.
    const double other = keys.size() < 2 ? 1 : keys[1 - k].frames_away;
    const double sum = keys.size() < 2 ? 1 : keys[0].frames_away + keys[1].frames_away;
    time_weight_[k] = float(sum > 0 ? other / sum : 0.5);
    same_camera_[k] = !keys[k].cut_off && keys[k].view->same_camera();
  }
}

void Compositor::look_up(LookedUp& points) const {
  points.wanted.place(*target_.camera);
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    if (keys_[k].cut_off) points.found[k].result.fill(LookUp::outside);
    else keys_[k].view->find(points.wanted, points.found[k]);
  }
}

void Compositor::start(ComposedPixel& pixel) const {
  pixel.parts = {};
  pixel.failed = {LookUp::found, LookUp::found};
  pixel.missing = pixel.undersampled = pixel.resampled = false;
}

/// True if the pixel can be copied from the key to the bit: in the pixel and its neighbours, target and key show the
/// same unmoved surfaces.
bool Compositor::shows_the_same(std::size_t p, const KeyView& view) const {
  const SeenSurfaces &here = *target_.seen, &there = view.key().seen();
  const int x = int(p % std::size_t(here.width)), y = int(p / std::size_t(here.width));
  for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, here.height - 1); ++ny)
    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, here.width - 1); ++nx) {
      const std::size_t q = std::size_t(ny) * std::size_t(here.width) + std::size_t(nx);
      const std::uint32_t object = here.object_at(q);
      if (!view.sees_the_same(object) || !may_be_same(there.object_at(q), object)) return false;
      const float z = here.depth[q], other = there.depth[q];
      if (z != other && !(std::abs(z - other) <= 1e-4f * z)) return false;
    }
  return true;
}

bool Compositor::copy_unmoved(std::size_t p, ComposedPixel& pixel) const {
  int unmoved = 0;
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    if (!same_camera_[k] || !shows_the_same(p, *keys_[k].view)) continue;
    const float* colour = keys_[k].view->key().colour(p);
    std::copy_n(colour, stride_, pixel.of_key[k].begin());
    pixel.parts[k] = 1;
    // a + w (b - a) keeps the bits of two equal colours.
    for (std::size_t c = 0; c < stride_; ++c)
      pixel.colour[c] = unmoved == 0 ? colour[c] : pixel.colour[c] + time_weight_[k] * (colour[c] - pixel.colour[c]);
    ++unmoved;
  }
  return unmoved > 0;
}

/// Computes the weights of the keys that show point i; false if no key shows it.
bool Compositor::weigh(const LookedUp& points, std::size_t i, ComposedPixel& pixel,
                       std::array<float, 2>& weight) const {
  bool sharp = false, any = false;
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    weight[k] = 0;
    if (const LookUp result = points.found[k].result[i]; result != LookUp::found) {
      pixel.failed[k] = std::max(pixel.failed[k], result);
      continue;
    }
    const float magnified = points.found[k].magnification[i];
    weight[k] = std::max(time_weight_[k], 1e-6f) / std::clamp(magnified, 1.0f, 64.0f);
    sharp |= double(magnified) <= options_.most_magnified;
    any = true;
    ++pixel.parts[k];
  }
  pixel.missing |= !any;
  pixel.undersampled |= any && !sharp;
  return any;
}

void Compositor::centre(std::size_t p, const LookedUp& points, std::size_t i, ComposedPixel& pixel) const {
  start(pixel);
  if (copy_unmoved(p, pixel)) return;
  pixel.resampled = true;
  std::array<float, 2> weight{};
  if (!weigh(points, i, pixel, weight)) {
    std::fill_n(pixel.colour.begin(), stride_, 0.0f);
    return;
  }
  for (std::size_t k = 0; k < keys_.size(); ++k)
    if (weight[k] > 0) mean_of(keys_[k].view->key(), points.found[k].taps[i], stride_, pixel.of_key[k].data());
  const std::size_t first = weight[0] > 0 ? 0 : 1;
  std::copy_n(pixel.of_key[first].begin(), stride_, pixel.colour.begin());
  if (weight[0] > 0 && weight[1] > 0)
    add_difference(pixel.colour.data(), weight[1] / (weight[0] + weight[1]), pixel.of_key[1].data(),
                   pixel.of_key[0].data(), stride_);
}

void Compositor::mean(std::size_t p, const LookedUp& points, ComposedPixel& pixel) const {
  start(pixel);
  if (copy_unmoved(p, pixel)) return;
  pixel.resampled = true;
  for (float* sums : {pixel.colour.data(), pixel.square.data(), pixel.of_key[0].data(), pixel.of_key[1].data()})
    std::fill_n(sums, stride_, 0.0f);
  alignas(32) std::array<std::array<float, kMostChannels>, 2> here;
  for (std::size_t i = 0; i < points.wanted.count; ++i) {
    std::array<float, 2> weight{};
    if (!weigh(points, i, pixel, weight)) continue;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      if (!(weight[k] > 0)) continue;
      mean_of(keys_[k].view->key(), points.found[k].taps[i], stride_, here[k].data());
      add(here[k].data(), pixel.of_key[k].data());
    }
    const std::size_t first = weight[0] > 0 ? 0 : 1;
    if (weight[0] > 0 && weight[1] > 0)
      add_difference(here[0].data(), weight[1] / (weight[0] + weight[1]), here[1].data(), here[0].data(), stride_);
    add(here[first].data(), pixel.colour.data());
    for (std::size_t c = 0; c < stride_; ++c) pixel.square[c] += here[first][c] * here[first][c];
  }
  const auto count = float(points.wanted.count);
  for (std::size_t c = 0; c < stride_; ++c) {
    pixel.colour[c] /= count;
    pixel.square[c] /= count;
  }
  for (std::size_t k = 0; k < keys_.size(); ++k)
    for (std::size_t c = 0; c < stride_ && pixel.parts[k] > 1; ++c) pixel.of_key[k][c] /= float(pixel.parts[k]);
}

void Compositor::add(const float* colour, float* sum) const {
  for (std::size_t i = 0; i < stride_; i += 8)
    for (std::size_t j = 0; j < 8; ++j) sum[i + j] += colour[i + j];
}

}  // namespace tempolux
