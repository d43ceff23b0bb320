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

/// The two cases of unmix.h: the unknown light is that of a pixel's own surface, or that of its other surfaces.
enum class Unknown { own, other };

/// Solves for the unknown light v [radiance / albedo] at one pixel after the other. With m(q) = radiance(q) / albedo(q)
/// and k(q) = K(q) / albedo(q), the sum of unmix.h over n pixels q with its first estimate v_0, which counts as w
/// pixels, is least for
///     v = (sum of s(q) (m(q) - k(q)) + w v_0) / (sum of s(q)^2 + w).
class Unmixing {
 public:
  /// Where the unknown light is written.
  struct Solved {
    Light& own;
    std::vector<ColourPlane>& other;
  };
  Unmixing(const LightGroup& group, std::size_t half, const Light& collected, const Coverage& coverage, int frames,
           const Solved& solved)
      : surfaces_(group.surfaces),
        raw_(group.raw[half]),
        collected_(collected),
        coverage_(coverage),
        fitted_(solved.own),
        other_(solved.other),
        frames_(frames) {}

  /// Writes v at pixel p = (x, y), if it sees unknown light.
  void pixel(int x, int y) {
    const bool has_other = coverage_.other(x, y) != 0;
    if (is_known(x, y) && !has_other) return;
    const Unknown unknown = is_known(x, y) ? Unknown::other : Unknown::own;
    if (has_other) start_with_fit(x, y);  // the result for `other` of a pixel whose own light is unknown, too
    sums_ = {};
    count_ = 0;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      const SurfaceEight row(surfaces_, y, dy, x);
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        const bool same_surface = surfaces_.has_pixel(x + dx, y + dy) && row.surface(dx)[0] != 0;
        if (same_surface && is_like(unknown, x + dx, y + dy)) add_mixture(unknown, x + dx, y + dy);
      }
    }
    std::vector<ColourPlane>& solved = unknown == Unknown::own ? fitted_.layers : other_;
    for_each_channel(
        [&](std::size_t l, std::size_t c) { solved[l][c].at(x, y) = float(solution(unknown, l, c, x, y)); });
  }

 private:
  /// Sums over the pixels q, for one channel of a layer.
  struct Sums {
    double light = 0;          ///< of m(q)
    double share_light = 0;    ///< of s(q) (m(q) - k(q))
    double share_squared = 0;  ///< of s(q)^2
  };

  /// Calls body(layer, channel) for all layers that are not black everywhere.
  template <class Body>
  void for_each_channel(const Body& body) const {
    for (std::size_t l = 0; l < raw_.layers.size(); ++l)
      if (const bool black = collected_.layers[l][0].empty(); !black)
        for (std::size_t c = 0; c < 3; ++c) body(l, c);
  }
  bool is_known(int x, int y) const { return fitted_.weight.at(x, y) >= kFewestPixels; }
  float albedo(std::size_t c, int x, int y) const { return surfaces_.albedo_at(c, x, y); }
  /// m: light of all surfaces of the pixel together. The mean over all frames if the pixel is at an edge in all of
  /// them, else the light of this frame.
  float mixed(std::size_t l, std::size_t c, int x, int y) const {
    const Plane& plane = (collected_.weight.at(x, y) == 0 ? collected_ : raw_).layers[l][c];
    return plane.empty() ? 0 : plane.at(x, y);
  }

  void start_with_fit(int x, int y) {
    for_each_channel([&](std::size_t l, std::size_t c) { other_[l][c].at(x, y) = fitted_.layers[l][c].at(x, y); });
  }

  /// True if the pixel is a mixture with an unknown part of this kind. A pixel that sees its own surface alone in some
  /// frame is no mixture.
  bool is_like(Unknown unknown, int x, int y) const {
    return unknown == Unknown::own ? !is_known(x, y) && !(collected_.weight.at(x, y) > 0)
                                   : is_known(x, y) && coverage_.other(x, y) != 0;
  }

  /// What the known surfaces contribute to a pixel: K by layer and channel, and s, the share of all other surfaces.
  struct Known {
    std::array<std::array<double, 3>, kMostLayers> light{};
    float remaining_share = 1;
  };
  Known known_part(Unknown unknown, int x, int y) const {
    Known known;
    const auto take_off = [&](int nx, int ny, float share) {
      known.remaining_share -= share;
      for_each_channel([&](std::size_t l, std::size_t c) {
        known.light[l][c] += double(share * albedo(c, nx, ny) * fitted_.layers[l][c].at(nx, ny));
      });
    };
    float around = 0;
    coverage_.for_each_share(x, y, [&](int dx, int dy, float share) {
      around += share;
      if (surfaces_.has_pixel(x + dx, y + dy) && is_known(x + dx, y + dy)) take_off(x + dx, y + dy, share);
    });
    if (unknown == Unknown::other) take_off(x, y, std::max(1 - around - coverage_.other(x, y), 0.0f));
    return known;
  }

  /// Adds pixel q = (x, y) to the sums.
  void add_mixture(Unknown unknown, int x, int y) {
    ++count_;
    const Known known = known_part(unknown, x, y);
    const double share = double(known.remaining_share);
    for_each_channel([&](std::size_t l, std::size_t c) {
      const double light = double(mixed(l, c, x, y));
      Sums& sums = sums_[l][c];
      sums.light += light;
      sums.share_light += share * (light - known.light[l][c] / double(albedo(c, x, y)));
      sums.share_squared += share * share;
    });
  }

  /// v at pixel p = (x, y). Of the two first estimates, the fit and the mean of m, one has weight 0.
  double solution(Unknown unknown, std::size_t l, std::size_t c, int x, int y) const {
    const Sums& sums = sums_[l][c];
    const double mean = count_ > 0 ? sums.light / count_ : double(mixed(l, c, x, y));
    const double weight_of_fit = unknown == Unknown::own ? double(fitted_.weight.at(x, y)) / frames_ : 0;  // in pixels
    const double weight_of_mean = weight_of_fit > 0 ? 0 : kFirstEstimate;
    const double v =
        (sums.share_light + weight_of_mean * mean + weight_of_fit * double(fitted_.layers[l][c].at(x, y))) /
        (sums.share_squared + weight_of_mean + weight_of_fit);
    return std::max(v, std::min(mean, 0.0));
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
    Unmixing unmixing(group, half, collected, coverage, frames, {fitted, other});
    for (int y = int(first); y < int(last); ++y)
      for (int x = 0; x < surfaces.width; ++x) unmixing.pixel(x, y);
  });
  return other;
}

}  // namespace tempolux
