#include "lib/filter/blur.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "formats/error.h"
#include "lib/core/halton.h"
#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"

namespace tempolux {
namespace {

constexpr int kTile = 16;  ///< pixels of a tile's edge
/// A pixel takes 2^3 to 2^5 samples.
constexpr int kFewestBits = 3, kMostBits = 5;
constexpr std::size_t kOthers = 4;  ///< motions of the surfaces around a tile that its pixels try
/// Neighbouring pixels whose motions differ by more pixels show different surfaces.
constexpr float kTorn = 1;

/// A moment of the shutter [frames], a place on the lens, which is a disc of radius 1, and numbers in [0, 1) by which
/// shifts are rounded to pixels.
struct Sample {
  float t, x, y, right, down;
};

/// How a pixel's surface moves in the picture.
struct Motion {
  float u = 0, v = 0;            ///< pixels a frame, right and down
  float bend_u = 0, bend_v = 0;  ///< half the acceleration, pixels a squared frame
  float disc = 0;                ///< radius of the circle of confusion, pixels; negative in front of the focus
  float nearness = 0;            ///< 1 / Z
  std::uint32_t object = 0;      ///< id

  float right(const Sample& s) const { return (bend_u * s.t + u) * s.t + disc * s.x; }
  float down(const Sample& s) const { return (bend_v * s.t + v) * s.t + disc * s.y; }
};

struct Colour {
  float r = 0, g = 0, b = 0, a = 0;
  void add(const Colour& c, float share) {
    r += share * c.r;
    g += share * c.g;
    b += share * c.b;
    a += share * c.a;
  }
};

/// A tile of the picture.
struct Tile {
  Motion least, farthest;  ///< those of its pixels that reach least and farthest
  float reach = 0;         ///< of `farthest`
  bool torn = false;       ///< two neighbouring pixels move differently, so the border of a surface is in the tile
};

/// What the pixels of a tile try.
struct Around {
  std::array<Motion, kOthers> others;
  std::size_t count = 0;
  bool torn = false;  ///< the border of a surface is among what may be seen
  float reach = 0;    ///< pixels; of all that may be seen in the tile
  const std::vector<Sample>* samples = nullptr;
};

/// The surfaces that are found for a sample.
struct Found {
  std::size_t landed = 0, farthest = 0;  ///< pixels
  float landed_nearness = -1, farthest_nearness = INFINITY;
};

float fraction(float x) { return x - std::floor(x); }

/// [Jimenez, Next Generation Post Processing in Call of Duty, 2014]: numbers in [0, 1) that differ most between
/// neighbouring pixels.
float gradient_noise(int x, int y) {
  return fraction(52.9829189f * fraction(0.06711056f * float(x) + 0.00583715f * float(y)));
}

/// A shift is replaced by two shifts of whole pixels, the next smaller one and the next larger one. The larger one gets
/// the share with which the mean square of the two equals the square of the shift. So blur has the right width. (A
/// share that kept the mean would blur a surface by a pixel if the surface moves by a part of a pixel.)
struct Shift {
  int near, far;
  float part, whole;  ///< share = part / whole

  explicit Shift(float shift) {
    const int steps = int(std::abs(shift));
    const float rest = std::abs(shift) - float(steps), sign = std::copysign(1.0f, shift);
    near = int(sign) * steps;
    far = int(sign) * (steps + 1);
    part = rest * (float(2 * steps) + rest);
    whole = float(2 * steps + 1);
  }
  float share() const { return part / whole; }
  int rounded(float u) const { return u * whole < part ? far : near; }
};

/// `count` samples: Halton's sequence in time and in the pixel, a spiral of golden angles on the lens.
std::vector<Sample> samples_of(int count) {
  const RadicalInverse time(2, 0, false), right(3, 0, false), down(5, 0, false);
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const double radius = std::sqrt((i + 0.5) / count), angle = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
    const auto n = std::uint64_t(i);
    samples.push_back({float(time(n)), float(radius * std::cos(angle)), float(radius * std::sin(angle)),
                       float(right(n)), float(down(n))});
  }
  return samples;
}

class Blur {
 public:
  Blur(const Image& image, const FlowFrame& flow, const BlurOptions& options);
  void run(Image& image);

 private:
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }
  Motion motion_of(float z, std::uint32_t object, const FlowFrame& flow, std::size_t p) const;
  float reach(const Motion& m) const;
  float apart(const Motion& a, const Motion& b) const;
  Tile tile_of(int tile_x, int tile_y) const;
  Around around(int tile_x, int tile_y) const;
  void look(const Motion& start, int x, int y, const Sample& sample, Found& found) const;
  void add_between(int x, int y, Shift right, Shift down, float share, Colour& sum) const;
  Colour blurred(const Around& around, int x, int y) const;

  int width_, height_, tiles_x_, tiles_y_;
  BlurOptions options_;
  std::vector<Motion> motion_;
  std::vector<Colour> colour_;
  std::vector<Tile> tiles_;
  std::vector<std::vector<Sample>> samples_;  ///< of 2^kFewestBits samples, twice as many ...
  float longest_ = 0;                         ///< reach of any tile
};

const std::vector<float>& values_of(const Image& image, const char* name) {
  const Channel* channel = image.find(name);
  if (!channel || channel->values.empty())
    throw InputError(std::string("no channel ") + name + ": blur needs R, G, B and Z");
  return channel->values;
}

Blur::Blur(const Image& image, const FlowFrame& flow, const BlurOptions& options)
    : width_(image.width),
      height_(image.height),
      tiles_x_((image.width + kTile - 1) / kTile),
      tiles_y_((image.height + kTile - 1) / kTile),
      options_(options),
      motion_(image.pixel_count()),
      colour_(image.pixel_count()),
      tiles_(std::size_t(tiles_x_) * std::size_t(tiles_y_)) {
  for (int bits = kFewestBits; bits <= kMostBits; ++bits) samples_.push_back(samples_of(1 << bits));
  const auto &r = values_of(image, "R"), &g = values_of(image, "G"), &b = values_of(image, "B"),
             &z = values_of(image, "Z");
  const Channel *const alpha = image.find("A"), *id = image.find("id.object");
  if (id && id->ids.empty()) id = nullptr;
  parallel_pixels(width_, height_, [&](int, int, std::size_t p) {
    motion_[p] = motion_of(z[p], id ? id->ids[p] : 0, flow, p);
    colour_[p] = {r[p], g[p], b[p], alpha ? alpha->values[p] : 0};
  });
  parallel_each(tiles_.size(), 16, [&](std::size_t i) { tiles_[i] = tile_of(int(i) % tiles_x_, int(i) / tiles_x_); });
  for (const Tile& tile : tiles_) longest_ = std::max(longest_, tile.reach);
}

/// A parabola through the places in the previous, this and the next frame. Where one of them is not known, a line.
Motion Blur::motion_of(float z, std::uint32_t object, const FlowFrame& flow, std::size_t p) const {
  Motion m;
  m.object = object;
  m.nearness = z > 0 ? 1 / z : 0;
  if (options_.lens_px > 0)
    m.disc =
        std::clamp(float(options_.lens_px * (1 / options_.focus_m - double(m.nearness))), -kLongestBlur, kLongestBlur);
  if (options_.opens == options_.closes || flow.empty()) return m;
  FlowFrame::Step next = flow.step(p, 1), before = flow.step(p, -1);
  if (!next.known && !before.known) return m;
  if (!next.known) next = {-before.right, -before.down, true};
  if (!before.known) before = {-next.right, -next.down, true};
  m.u = (next.right - before.right) / 2;
  m.v = (next.down - before.down) / 2;
  m.bend_u = (next.right + before.right) / 2;
  m.bend_v = (next.down + before.down) / 2;
  const float way = reach(m) - std::abs(m.disc);
  if (way <= kLongestBlur) return m;
  for (float* part : {&m.u, &m.v, &m.bend_u, &m.bend_v}) *part = std::isfinite(way) ? *part * kLongestBlur / way : 0;
  return m;
}

/// Farthest place from the pixel, pixels.
float Blur::reach(const Motion& m) const { return apart(m, {}); }

/// Largest distance between the places of two motions from one pixel.
float Blur::apart(const Motion& a, const Motion& b) const {
  const auto way = [&](float t) {
    const float u = (a.u - b.u + (a.bend_u - b.bend_u) * t) * t, v = (a.v - b.v + (a.bend_v - b.bend_v) * t) * t;
    return std::sqrt(u * u + v * v);
  };
  return std::max(way(float(options_.opens)), way(float(options_.closes))) + std::abs(a.disc - b.disc);
}

Tile Blur::tile_of(int tile_x, int tile_y) const {
  Tile tile;
  float least = INFINITY;
  const int right = std::min(width_, (tile_x + 1) * kTile), below = std::min(height_, (tile_y + 1) * kTile);
  for (int y = tile_y * kTile; y < below; ++y)
    for (int x = tile_x * kTile; x < right; ++x) {
      const Motion& m = motion_[at(x, y)];
      const float r = reach(m);
      if (r < least) {
        least = r;
        tile.least = m;
      }
      if (r > tile.reach) {
        tile.reach = r;
        tile.farthest = m;
      }
      if (tile.torn) continue;
      tile.torn = (x + 1 < width_ && apart(m, motion_[at(x + 1, y)]) > kTorn) ||
                  (y + 1 < height_ && apart(m, motion_[at(x, y + 1)]) > kTorn);
    }
  return tile;
}

/// Motions of the tiles that reach this one, if a border of surfaces is among them: those that reach farthest, and that
/// differ.
Around Blur::around(int tile_x, int tile_y) const {
  Around around;
  const int tiles = 1 + int(longest_) / kTile;
  const auto each = [&](const auto& body) {
    for (int y = std::max(0, tile_y - tiles); y <= std::min(tiles_y_ - 1, tile_y + tiles); ++y)
      for (int x = std::max(0, tile_x - tiles); x <= std::min(tiles_x_ - 1, tile_x + tiles); ++x) {
        const Tile& tile = tiles_[std::size_t(y) * std::size_t(tiles_x_) + std::size_t(x)];
        const int away = std::max(std::abs(x - tile_x), std::abs(y - tile_y));
        if (tile.reach > float((away - 1) * kTile)) body(tile);
      }
  };
  each([&](const Tile& tile) {
    around.reach = std::max(around.reach, tile.reach);
    around.torn = around.torn || tile.torn;
  });
  const auto wanted = std::bit_ceil(std::uint32_t(2 * around.reach));
  const int bits = around.torn ? kMostBits : std::clamp(std::countr_zero(wanted), kFewestBits, kMostBits);
  around.samples = &samples_[std::size_t(bits - kFewestBits)];
  if (!around.torn) return around;
  std::array<float, kOthers> reaches{};
  const auto add = [&](const Motion& m) {
    const float r = reach(m);
    for (std::size_t i = 0; i < around.count; ++i)
      if (apart(m, around.others[i]) <= kTorn) return;
    if (around.count < kOthers) {
      reaches[around.count] = r;
      around.others[around.count++] = m;
      return;
    }
    const auto nearest = std::size_t(std::ranges::min_element(reaches) - reaches.begin());
    if (r <= reaches[nearest]) return;
    reaches[nearest] = r;
    around.others[nearest] = m;
  };
  each([&](const Tile& tile) {
    add(tile.farthest);
    add(tile.least);
  });
  return around;
}

/// Looks for a pixel that is at (x, y) at the sample's moment, seen through its place of the lens: a fixed point
/// q = p - motion(q) [Bowles et al., Iterative Image Warping, 2012]. Where a surface is stretched, the search ends
/// between two pixels of one object.
void Blur::look(const Motion& start, int x, int y, const Sample& sample, Found& found) const {
  const Motion* m = &start;
  int column = -2, row = -2;
  for (int i = 0; i < 3; ++i) {
    const int qx = x - Shift(m->right(sample)).rounded(sample.right),
              qy = y - Shift(m->down(sample)).rounded(sample.down);
    const bool outside = qx < 0 || qy < 0 || qx >= width_ || qy >= height_;
    const int next_column = std::clamp(qx, 0, width_ - 1), next_row = std::clamp(qy, 0, height_ - 1);
    const bool here = next_column == column && next_row == row;
    const bool beside = std::abs(next_column - column) <= 1 && std::abs(next_row - row) <= 1;
    const std::size_t q = at(next_column, next_row);
    const Motion& next = motion_[q];
    if (here || outside || (i == 2 && beside && next.object == m->object)) {
      if (next.nearness > found.landed_nearness) {
        found.landed = q;
        found.landed_nearness = next.nearness;
      }
      return;
    }
    if (next.nearness < found.farthest_nearness) {
      found.farthest = q;
      found.farthest_nearness = next.nearness;
    }
    column = next_column;
    row = next_row;
    m = &next;
  }
}

/// Adds the colours of the four pixels between which (x, y) is after both shifts.
void Blur::add_between(int x, int y, Shift right, Shift down, float share, Colour& sum) const {
  const auto column = [&](int by) { return std::clamp(x - by, 0, width_ - 1); };
  const auto row = [&](int by) { return std::clamp(y - by, 0, height_ - 1); };
  const int near = column(right.near), far = column(right.far), above = row(down.near), below = row(down.far);
  sum.add(colour_[at(near, above)], share * (1 - right.share()) * (1 - down.share()));
  sum.add(colour_[at(far, above)], share * right.share() * (1 - down.share()));
  sum.add(colour_[at(near, below)], share * (1 - right.share()) * down.share());
  sum.add(colour_[at(far, below)], share * right.share() * down.share());
}

Colour Blur::blurred(const Around& around, int x, int y) const {
  const std::size_t p = at(x, y);
  const float jitter = gradient_noise(x, y), place = gradient_noise(y, x);
  const float angle = 2 * std::numbers::pi_v<float> * jitter, cosine = std::cos(angle), sine = std::sin(angle);
  const float opens = float(options_.opens), open = float(options_.closes - options_.opens);
  Colour sum;
  for (const Sample& one : *around.samples) {
    const Sample sample{opens + open * fraction(one.t + jitter), one.x * cosine - one.y * sine,
                        one.x * sine + one.y * cosine, fraction(one.right + place), fraction(one.down + place)};
    const float share = 1 / float(around.samples->size());
    if (!around.torn) {
      add_between(x, y, Shift(motion_[p].right(sample)), Shift(motion_[p].down(sample)), share, sum);
      continue;
    }
    Found found;
    found.farthest = p;
    found.farthest_nearness = motion_[p].nearness;
    look(motion_[p], x, y, sample, found);
    for (std::size_t o = 0; o < around.count; ++o) look(around.others[o], x, y, sample, found);
    sum.add(colour_[found.landed_nearness >= 0 ? found.landed : found.farthest], share);
  }
  return sum;
}

void Blur::run(Image& image) {
  std::array<float*, 4> planes{};
  for (int c = 0; c < 4; ++c)
    if (Channel* channel = image.find(std::string(1, "RGBA"[c]))) planes[std::size_t(c)] = channel->values.data();
  parallel_each(tiles_.size(), 16, [&](std::size_t i) {
    const int tile_x = int(i) % tiles_x_, tile_y = int(i) / tiles_x_;
    const Around around = this->around(tile_x, tile_y);
    if (around.reach * 256 < 1) return;
    for (int y = tile_y * kTile; y < std::min(height_, (tile_y + 1) * kTile); ++y)
      for (int x = tile_x * kTile; x < std::min(width_, (tile_x + 1) * kTile); ++x) {
        const Colour colour = blurred(around, x, y);
        const float values[] = {colour.r, colour.g, colour.b, colour.a};
        for (std::size_t c = 0; c < 4; ++c)
          if (planes[c]) planes[c][at(x, y)] = values[c];
      }
  });
}

}  // namespace

Image blur_frame(Image image, const FlowFrame& flow, const BlurOptions& options) {
  Blur(image, flow, options).run(image);
  constexpr std::array kSharp{"RGBA", "Z", "N", "P", "id", "motion"};
  std::erase_if(image.channels, [&](const Channel& channel) {
    return std::ranges::none_of(kSharp, [&](const char* group) { return is_in_group(channel.name, group); });
  });
  return image;
}

}  // namespace tempolux
