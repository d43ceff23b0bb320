#include "lib/filter/unmix.h"

#include <algorithm>
#include <array>

#include "lib/core/parallel.h"
#include "lib/filter/surface_weight.h"

namespace tempolux {
namespace {

constexpr int kRadius = 6;  ///< pixels
constexpr std::size_t kMostLayers = kMatteLayers.size();
static_assert(kSeenLayers.size() <= kMostLayers);
/// Weight of a first estimate without a fit: the square of a share of one ray, s = 1/16. The first estimate also holds
/// light of other surfaces, so its weight must be small beside that of any pixel in which several rays see the surface.
constexpr double kFirstEstimate = 1.0 / (Coverage::kRays * Coverage::kRays);

class Unmixing {
 public:
  Unmixing(const LightGroup& group, std::size_t half, const Light& collected, const Coverage& coverage, int frames,
           Light& fitted, std::vector<ColourPlane>& other)
      : surfaces_(group.surfaces),
        raw_(group.raw[half]),
        collected_(collected),
        coverage_(coverage),
        fitted_(fitted),
        other_(other),
        frames_(frames) {}

  void pixel(int x, int y) {
    const bool own = !is_known(x, y);
    const bool other = coverage_.other(x, y) != 0;
    if (!own && !other) return;
    for (std::size_t l = 0; other && l < raw_.layers.size(); ++l)
      for (std::size_t c = 0; c < 3 && !is_black(l); ++c) other_[l][c].at(x, y) = fitted_.layers[l][c].at(x, y);
    sums_ = {};
    count_ = 0;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      const SurfaceEight row(surfaces_, y, dy, x);
      for (int dx = -kRadius; dx <= kRadius; ++dx)
        if (surfaces_.has_pixel(x + dx, y + dy) && row.surface(dx)[0] != 0) add(x + dx, y + dy, own);
    }
    for (std::size_t l = 0; l < raw_.layers.size(); ++l)
      for (std::size_t c = 0; c < 3 && !is_black(l); ++c) {
        const Sums& s = sums_[l][c];
        const double mean = count_ > 0 ? s.plain / count_ : double(mixed(l, c, x, y));
        const double fitted = own ? double(fitted_.weight.at(x, y)) / frames_ : 0;  // in pixels
        const double plain = fitted > 0 ? 0 : kFirstEstimate;
        const double unmixed =
            (s.product + plain * mean + fitted * double(fitted_.layers[l][c].at(x, y))) / (s.square + plain + fitted);
        (own ? fitted_.layers : other_)[l][c].at(x, y) = float(std::max(unmixed, std::min(mean, 0.0)));
      }
  }

 private:
  struct Sums {
    double plain = 0, product = 0, square = 0;
  };

  bool is_black(std::size_t layer) const { return collected_.layers[layer][0].empty(); }
  bool is_known(int x, int y) const { return fitted_.weight.at(x, y) >= kFewestPixels; }
  float albedo(std::size_t c, int x, int y) const { return surfaces_.albedo_at(c, x, y); }
  /// Light of all surfaces of the pixel together: the mean over all frames if the pixel is at an edge in all of them,
  /// else the light of this frame.
  float mixed(std::size_t l, std::size_t c, int x, int y) const {
    const Plane& plane = (collected_.weight.at(x, y) == 0 ? collected_ : raw_).layers[l][c];
    return plane.empty() ? 0 : plane.at(x, y);
  }

  void add(int x, int y, bool own) {
    const float other = coverage_.other(x, y);
    if (is_known(x, y) == own || (!own && other == 0) || (own && collected_.weight.at(x, y) > 0)) return;
    ++count_;
    float share = 1;
    std::array<std::array<double, 3>, kMostLayers> known{};
    const auto take_off = [&](int nx, int ny, float part) {
      share -= part;
      for (std::size_t l = 0; l < raw_.layers.size(); ++l)
        for (std::size_t c = 0; c < 3 && !is_black(l); ++c)
          known[l][c] += double(part * albedo(c, nx, ny) * fitted_.layers[l][c].at(nx, ny));
    };
    float around = 0;
    coverage_.for_each_share(x, y, [&](int dx, int dy, float part) {
      around += part;
      if (surfaces_.has_pixel(x + dx, y + dy) && is_known(x + dx, y + dy)) take_off(x + dx, y + dy, part);
    });
    if (!own) take_off(x, y, std::max(1 - around - other, 0.0f));
    for (std::size_t l = 0; l < raw_.layers.size(); ++l)
      for (std::size_t c = 0; c < 3 && !is_black(l); ++c) {
        const double light = double(mixed(l, c, x, y));
        sums_[l][c].plain += light;
        sums_[l][c].product += double(share) * (light - known[l][c] / double(albedo(c, x, y)));
        sums_[l][c].square += double(share) * double(share);
      }
  }

  const Surfaces& surfaces_;
  const Light &raw_, &collected_;
  const Coverage& coverage_;
  Light& fitted_;
  std::vector<ColourPlane>& other_;
  double frames_, count_ = 0;
  std::array<std::array<Sums, 3>, kMostLayers> sums_{};
};

}  // namespace

std::vector<ColourPlane> unmix(const LightGroup& group, std::size_t half, const Light& collected,
                               const Coverage& coverage, int frames, Light& fitted) {
  const Surfaces& surfaces = group.surfaces;
  std::vector<ColourPlane> other(fitted.layers.size());
  const bool any_other = coverage.has_other();
  for (std::size_t l = 0; l < other.size(); ++l)
    for (std::size_t c = 0; c < 3 && any_other && !fitted.layers[l][c].empty(); ++c)
      other[l][c] = Plane(surfaces.width, surfaces.height);
  // Pixels with known light are only read, all other pixels are only written, so any order gives the same result.
  parallel_chunks(std::size_t(surfaces.height), 8, [&](std::size_t first, std::size_t last) {
    Unmixing unmixing(group, half, collected, coverage, frames, fitted, other);
    for (int y = int(first); y < int(last); ++y)
      for (int x = 0; x < surfaces.width; ++x) unmixing.pixel(x, y);
  });
  return other;
}

}  // namespace tempolux
