// tools/info/mesh_picture.cpp -- tempolux-info --png of a .meshirrad file: its elements, seen from a corner above.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "formats/error.h"
#include "formats/meshirrad/meshirrad.h"
#include "formats/octahedral.h"
#include "lib/core/arrays.h"
#include "lib/core/vec.h"
#include "lib/image/image.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

using formats::MeshElement;

constexpr int kSide = 640;        ///< pixels of the longer side
constexpr double kMargin = 4;     ///< pixels
constexpr double kOverlap = 1.4;  ///< radius of a drawn disc, divided by the radius of a disc of the element's area;
                                  ///< above 1, so that no gaps remain

/// What is shown of an element: R, G, B.
Rgb shown(const MeshElement& e, const std::string& layer) {
  if (layer == "age") return Rgb((float(e.after) - float(e.before)) / 2 / 16);
  if (layer == "window") return Rgb(float(e.before + 1 + e.after) / 33);
  return rgb_of(e.irradiance);
}

/// An orthographic view along -(1, 1, 1): x to the right, y up in the picture, depth towards the eye.
struct View {
  const Vec3d right{std::sqrt(0.5), 0, -std::sqrt(0.5)}, up{-std::sqrt(1 / 6.), std::sqrt(2 / 3.), -std::sqrt(1 / 6.)},
      towards{std::sqrt(1 / 3.), std::sqrt(1 / 3.), std::sqrt(1 / 3.)};
  Vec3d of(const Vec3d& p) const { return {dot(p, right), dot(p, up), dot(p, towards)}; }
};

/// The picture while it is drawn.
struct Canvas {
  Image image;
  std::string layer;
  std::vector<double> depth;
  double scale = 1, left = 0, top = 0;  ///< pixels per metre; view coordinates of the upper left corner
  std::array<Channel*, 3> channels{};
};

void draw(const MeshElement& e, const View& view, Canvas& canvas) {
  const Vec3d n = view.of(Vec3d(vec_of(formats::decode_normal(e.normal))));
  if (e.photons == 0 || n[2] < 0.05) return;
  const Vec3d p = view.of(Vec3d(vec_of(e.position)));
  const double radius = kOverlap * std::sqrt(double(e.area) / 3.14159265358979), reach = radius * canvas.scale + 1;
  const double x0 = (p[0] - canvas.left) * canvas.scale, y0 = (canvas.top - p[1]) * canvas.scale;
  const Rgb value = shown(e, canvas.layer);
  const auto first = [](double at) { return int(std::max(0.0, std::ceil(at - 0.5))); };
  const auto last = [](double at, int size) { return int(std::min(double(size), std::ceil(at - 0.5) + 1)); };
  for (int y = first(y0 - reach); y < last(y0 + reach, canvas.image.height); ++y)
    for (int x = first(x0 - reach); x < last(x0 + reach, canvas.image.width); ++x) {
      const double dx = (x + 0.5 - x0) / canvas.scale, dy = (y0 - y - 0.5) / canvas.scale;
      const double dz = -(dx * n[0] + dy * n[1]) / n[2];  // on the element's plane
      const bool centre = std::abs(x + 0.5 - x0) <= 0.5 && std::abs(y + 0.5 - y0) <= 0.5;
      if (!centre && dx * dx + dy * dy + dz * dz > radius * radius) continue;
      const std::size_t at = std::size_t(y) * std::size_t(canvas.image.width) + std::size_t(x);
      if (p[2] + dz <= canvas.depth[at]) continue;
      canvas.depth[at] = p[2] + dz;
      for (int c = 0; c < 3; ++c) canvas.channels[std::size_t(c)]->values[at] = value[c];
    }
}

}  // namespace

Image mesh_picture(const std::string& path, const std::string& layer) {
  const formats::MeshirradFile file = formats::load_meshirrad(path);
  if (!layer.empty() && layer != "window" && layer != "age")
    throw InputError(path + ": --layer " + layer +
                     ": a .meshirrad file has window and age, without --layer irradiance");
  if (!layer.empty() && file.header.holds != formats::MeshHolds::windows)
    throw InputError(path + ": --layer " + layer +
                     ": holds light of one frame; gather-temporal density writes windows");
  const View view;
  const double infinity = std::numeric_limits<double>::infinity();
  Vec3d lower{infinity, infinity, infinity}, upper{-infinity, -infinity, -infinity};
  for (const MeshElement& e : file.elements)
    if (e.photons > 0) {
      const Vec3d p = view.of(Vec3d(vec_of(e.position)));
      for (int c = 0; c < 3; ++c) lower[c] = std::min(lower[c], p[c]), upper[c] = std::max(upper[c], p[c]);
    }
  if (!(lower[0] <= upper[0])) throw InputError(path + ": no photon arrived, so there is nothing to see");
  Canvas canvas;
  const double longest = std::max({upper[0] - lower[0], upper[1] - lower[1], 1e-9});
  canvas.layer = layer;
  canvas.scale = (kSide - 2 * kMargin) / longest;
  canvas.left = lower[0] - kMargin / canvas.scale, canvas.top = upper[1] + kMargin / canvas.scale;
  canvas.image.width = int(std::ceil((upper[0] - lower[0]) * canvas.scale + 2 * kMargin));
  canvas.image.height = int(std::ceil((upper[1] - lower[1]) * canvas.scale + 2 * kMargin));
  canvas.depth.assign(canvas.image.pixel_count(), -infinity);
  for (const char* name : {"R", "G", "B"}) canvas.image.add(layer.empty() ? name : layer + "." + name);
  for (std::size_t c = 0; c < 3; ++c) canvas.channels[c] = &canvas.image.channels[c];
  for (const MeshElement& e : file.elements) draw(e, view, canvas);
  return std::move(canvas.image);
}

}  // namespace tempolux::tools
