#include "lib/light_texture/mesh_elements.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "formats/error.h"
#include "formats/octahedral.h"
#include "lib/core/arrays.h"
#include "lib/core/parallel_each.h"
#include "lib/core/random.h"
#include "lib/irradcache/clearance.h"

namespace tempolux {
namespace {

constexpr std::size_t kAtOnce = 1024;  ///< photons, or elements, per piece of parallel work
/// Low bits that are dropped from each coordinate (of 16 bits) of a normal when elements are joined: 64 directions
/// remain. One bit more or less changes previews by less than another seed does (docs/notebook/constants.md).
constexpr int kNormalBits = 13;
constexpr float kReach = 3;  ///< radius at which a Gaussian is cut, in standard deviations

struct Corners {
  Vec3 a, b, c;
  Vec3 at(float u, float v) const { return a * (1 - u - v) + b * u + c * v; }
  Vec3 cross_product() const { return cross(b - a, c - a); }
};

Corners corners_of(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle) {
  const Surface& s = frame.surfaces[surface];
  const auto& index = s.primitive->triangles[triangle];
  return {s.position(index[0]), s.position(index[1]), s.position(index[2])};
}

/// An element, or several joined ones, whose flux is filtered.
struct Sample {
  Vec3 position, normal;
  Rgbd flux{0.0};  ///< W
  float area = 0;
  float width = 0;          ///< m: width of the filter around the sample
  std::uint32_t group = 0;  ///< a material, inside or outside of solids: samples share light only within a group
  double squares = 0;       ///< W^2: variance of the flux's luminance
};

/// Irradiance by sample, and the variance of its luminance.
struct Smoothed {
  explicit Smoothed(std::size_t size) : light(size, Rgbd(0.0)), variance(size, 0.0) {}
  std::vector<Rgbd> light;       ///< W/m^2
  std::vector<double> variance;  ///< (W/m^2)^2
};

/// Finds samples by group and place, in cubes that are as wide as the filter's reach.
class Neighbours {
 public:
  Neighbours(const std::vector<Sample>& samples, float reach) : per_m_(1 / reach) {
    for (std::size_t i = 0; i < samples.size(); ++i) cubes_[cube(samples[i])].push_back(std::uint32_t(i));
  }
  template <class Visit>
  void around(const Sample& sample, const Visit& visit) const {
    const Cube at = cube(sample);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = cubes_.find({at[0] + x, at[1] + y, at[2] + z, at[3]});
          if (found == cubes_.end()) continue;
          for (const std::uint32_t i : found->second) visit(i);
        }
  }

 private:
  using Cube = std::array<std::int64_t, 4>;  ///< place in space, group
  struct Hash {
    std::size_t operator()(const Cube& c) const {
      std::uint64_t key = 0;
      for (const std::int64_t number : c) key = mix64(key + std::uint64_t(number));
      return key;
    }
  };
  Cube cube(const Sample& s) const {
    const Vec3 p = s.position * per_m_;
    return {std::int64_t(std::floor(p.x)), std::int64_t(std::floor(p.y)), std::int64_t(std::floor(p.z)), s.group};
  }
  float per_m_;
  std::unordered_map<Cube, std::vector<std::uint32_t>, Hash> cubes_;
};

/// Weight of neighbour b, of the same group, in the filter around a; 0 if b does not count.
float weight(const MeshFilter& filter, const Sample& a, const Sample& b) {
  const float width = a.width;
  const Vec3 d = b.position - a.position;
  if (dot(a.normal, b.normal) < Clearance::kBend || std::abs(dot(d, a.normal)) > width) return 0;
  if (filter.kind == MeshFilter::Kind::box)
    return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= width ? 1.0f : 0.0f;
  const float d2 = dot(d, d) / (width * width);
  return d2 > kReach * kReach ? 0 : std::exp(-0.5f * d2);
}

/// Irradiance of all samples whose width is above 0: flux over area under the kernel.
Smoothed smooth(const std::vector<Sample>& samples, const MeshFilter& filter, const Neighbours& neighbours) {
  Smoothed result(samples.size());
  parallel_each(samples.size(), kAtOnce, [&](std::size_t i) {
    if (!(samples[i].width > 0)) return;
    Rgbd flux{0.0};
    double area = 0, squares = 0;
    neighbours.around(samples[i], [&](std::uint32_t j) {
      const float w = weight(filter, samples[i], samples[j]);
      if (!(w > 0)) return;
      flux += samples[j].flux * double(w);
      area += double(w) * double(samples[j].area);
      squares += double(w) * double(w) * samples[j].squares;
    });
    if (!(area > 0)) return;
    result.light[i] = flux * (1 / area);
    result.variance[i] = squares / (area * area);
  });
  return result;
}

/// Elements joined into fewer samples, because the filter does not resolve them.
struct Joined {
  std::vector<Sample> cubes;
  std::vector<std::uint32_t> of;  ///< by element: the index of its cube
};
/// Joins elements in one cube of this edge [m] that have the same orientation and group.
Joined join(const std::vector<Sample>& samples, float edge) {
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  Joined joined;
  for (const Sample& s : samples) {
    const auto code = formats::encode_normal(array_of(s.normal));
    std::uint64_t key = mix64(std::uint64_t(s.group) << 32 | std::uint64_t(code[0] >> kNormalBits) << 16 |
                              std::uint64_t(code[1] >> kNormalBits));
    for (int c = 0; c < 3; ++c)
      key = mix64(key + std::uint64_t(std::int64_t(std::floor(double(s.position[c]) / double(edge)))));
    const auto [found, is_new] = numbers.try_emplace(key, std::uint32_t(joined.cubes.size()));
    if (is_new) joined.cubes.push_back({Vec3{0, 0, 0}, Vec3{0, 0, 0}, Rgbd{0.0}, 0, 0, s.group, 0});
    joined.of.push_back(found->second);
    Sample& cube = joined.cubes[found->second];
    cube.position = cube.position + s.position * s.area;
    cube.normal = cube.normal + s.normal * s.area;
    cube.flux += s.flux;
    cube.area += s.area;
    cube.squares += s.squares;
  }
  for (Sample& cube : joined.cubes) {
    if (!(cube.area > 0)) continue;
    cube.position = cube.position * (1 / cube.area);
    cube.normal = normalize(cube.normal);
  }
  return joined;
}

/// Smooths each sample with its own width. Samples whose widths are within a factor of two are processed together.
/// Small elements are joined first, so that the cost depends on the widths and not on the number of elements.
Smoothed smooth_all(const std::vector<Sample>& samples, const MeshFilter& filter) {
  Smoothed result(samples.size());
  std::map<int, std::vector<std::uint32_t>> levels;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples[i].width > 0 && samples[i].area > 0)
      levels[std::max(0, std::ilogb(samples[i].width / float(filter.width) * 1.0001f))].push_back(std::uint32_t(i));
  for (const auto& [level, which] : levels) {
    Joined joined = join(samples, std::ldexp(float(filter.width), level - 1));
    float widest = 0;
    for (const std::uint32_t i : which) {
      float& width = joined.cubes[joined.of[i]].width;
      width = std::max(width, samples[i].width);
      widest = std::max(widest, width);
    }
    const Neighbours neighbours(joined.cubes, widest * (filter.kind == MeshFilter::Kind::box ? 1 : kReach));
    const Smoothed smoothed = smooth(joined.cubes, filter, neighbours);
    for (const std::uint32_t i : which) {
      result.light[i] = smoothed.light[joined.of[i]];
      result.variance[i] = smoothed.variance[joined.of[i]];
    }
  }
  return result;
}

/// Scales the irradiance so that each object keeps the flux of each channel that it had before smoothing.
void put_right(const std::vector<Sample>& samples, const std::vector<formats::MeshElement>& elements,
               std::vector<Rgbd>& irradiance) {
  std::map<std::uint16_t, std::pair<Rgbd, Rgbd>> flux;  // before, after
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto& [before, after] = flux.try_emplace(elements[i].object, Rgbd{0.0}, Rgbd{0.0}).first->second;
    before += samples[i].flux;
    after += irradiance[i] * double(samples[i].area);
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (const auto& [before, after] = flux.at(elements[i].object); after[c] > 0)
        irradiance[i][c] *= before[c] / after[c];
}

/// Share of a band that is kept: signal / (signal + noise) [Wiener]. A band is light filtered by a Gaussian of
/// deviation s minus light filtered by a Gaussian of deviation 2 s. `mean_square`: the band's mean square. `variance`:
/// the variance v of the light filtered with s. White noise of density q that is filtered with s and with t has the
/// covariance q / (2 pi (s^2 + t^2)). For t = s this is v, so the noise in the band is v (1 + 1/4 - 2 x 2/5) = .45 v.
double kept_share(double mean_square, double variance) {
  return mean_square > 0 ? std::max(0.0, 1 - 0.45 * variance / mean_square) : 0;
}

/// True if a ray from the place along its normal meets the back of a surface: the place is inside a solid, where no
/// light arrives.
bool inside_solid(const Tracer& tracer, Vec3 place, Vec3 normal) {
  const float above = max_component(abs(place)) * 0x1p-18f;  // the largest rounding error
  Hit hit;
  return tracer.intersect({place + normal * above, normal, above}, hit) &&
         dot(tracer.surface_point(hit).normal_geometric, normal) > 0;
}

std::vector<Sample> samples_of(const Tracer& tracer, std::span<const Rgbd> flux, const MeshFilter& filter,
                               std::span<const float> widths, const std::vector<formats::MeshElement>& elements) {
  std::vector<Sample> samples(elements.size());
  parallel_each(samples.size(), kAtOnce, [&](std::size_t i) {
    const formats::MeshElement& e = elements[i];
    const Vec3 position = vec_of(e.position), normal = vec_of(formats::decode_normal(e.normal));
    const std::uint32_t material = tracer.frame().surfaces[e.surface].material;
    samples[i] = {position,
                  normal,
                  flux[i],
                  e.area,
                  widths.empty() ? float(filter.width) : widths[i],
                  2 * material + inside_solid(tracer, position, normal),
                  0};
  });
  return samples;
}

void put_light(const std::vector<Rgbd>& light, std::vector<formats::MeshElement>& elements) {
  for (std::size_t i = 0; i < elements.size(); ++i)
    elements[i].irradiance = {float(light[i].r), float(light[i].g), float(light[i].b)};
}

}  // namespace

std::uint32_t MeshCuts::operator()(std::uint32_t surface, std::uint32_t triangle) const {
  double longest = 0;
  for (const SceneFrame* frame : measured_) {
    const Corners t = corners_of(*frame, surface, triangle);
    longest = std::max(longest, double(std::max({length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)})));
    if (surface < frame->static_count) break;  // static surfaces are the same in all frames
  }
  return std::uint32_t(std::clamp(std::ceil(longest / cell_), 1.0, double(formats::kMostCuts)));
}

double kernel_width(double area, double photons, double in_kernel) {
  const double width = std::sqrt(in_kernel * area / (4 * std::numbers::pi * std::max(1.0, photons)));
  return width > 0 ? width : 1;
}

double surface_area(const SceneFrame& frame) {
  double area = 0;
  for (std::uint32_t s = 0; s < frame.surfaces.size(); ++s)
    for (std::uint32_t t = 0; t < frame.surfaces[s].primitive->triangles.size(); ++t)
      area += 0.5 * double(length(corners_of(frame, s, t).cross_product()));
  return area;
}

MeshOptions with_widths(const MeshOptions& options, double area, double photons, double cell) {
  MeshOptions result = options;
  if (!(result.filter.width > 0)) result.filter.width = kernel_width(area, photons);
  if (!(result.cell > 0)) result.cell = cell * result.filter.width;
  return result;
}

void MeshSums::add(std::span<const formats::Photon> photons, Vec3 offset) {
  struct Place {
    Side side{};
    std::uint32_t cuts = 0, cell = 0;  ///< cuts 0: no element was found
  };
  std::vector<Place> places(photons.size());
  parallel_each(photons.size(), kAtOnce, [&](std::size_t i) {
    const formats::Photon& photon = photons[i];
    const Vec3 normal = vec_of(formats::decode_normal(photon.normal)), position = vec_of(photon.position) + offset;
    // m: height at which the ray starts. Above the largest rounding error, and at least a thousandth of a cell.
    const float above = std::max(float(cuts_.cell()) * 1e-3f, max_component(abs(position)) * 0x1p-18f);
    Hit hit;
    if (!tracer_.intersect({position + normal * above, -normal, 0, 2 * above}, hit)) return;
    const std::uint32_t cuts = cuts_(hit.surface, hit.triangle);
    const bool back = dot(tracer_.surface_point(hit).normal_geometric, normal) < 0;
    places[i] = {{hit.surface, hit.triangle, std::uint16_t(back)}, cuts, formats::mesh_cell(cuts, hit.u, hit.v)};
  });
  for (std::size_t i = 0; i < photons.size(); ++i) {
    const Place& place = places[i];
    if (place.cuts == 0) {
      ++lost_;
      continue;
    }
    auto& cells = cells_[place.side];
    cells.resize(std::size_t(place.cuts) * place.cuts);
    Cell& cell = cells[place.cell];
    ++cell.photons;
    std::array<double, 3> flux{};
    for (std::size_t c = 0; c < 3; ++c) {  // unsigned: an overflow in a damaged file wraps around
      flux[c] = std::clamp(double(photons[i].flux[c]) / unit_, 0.0, 9e18);
      cell.sums[c] = std::int64_t(std::uint64_t(cell.sums[c]) + std::uint64_t(std::llrint(flux[c])));
    }
    const double y = luminance(Rgbd(flux[0], flux[1], flux[2]));
    cell.squares += y * y;
  }
}

std::vector<formats::MeshElement> all_elements(const SceneFrame& frame, const MeshCuts& cuts) {
  std::vector<formats::MeshElement> elements;
  for (std::uint32_t s = 0; s < frame.surfaces.size(); ++s)
    for (std::uint32_t t = 0; t < frame.surfaces[s].primitive->triangles.size(); ++t) {
      const Corners corners = corners_of(frame, s, t);
      const Vec3 across = corners.cross_product();
      const float doubled = length(across);
      if (!(doubled > 0)) continue;  // no light arrives there
      const std::uint32_t n = cuts(s, t);
      if (elements.size() + 2 * std::uint64_t(n) * n > kMostElements)
        throw InputError("--cell: more than " + std::to_string(kMostElements) + " elements of " +
                         std::to_string(cuts.cell()) + " m; give a larger one");
      for (std::uint16_t side = 0; side < 2; ++side) {
        const Vec3 normal = across * ((side == 1) != frame.surfaces[s].flipped ? -1 / doubled : 1 / doubled);
        for (std::uint32_t cell = 0; cell < n * n; ++cell) {
          formats::MeshElement& e = elements.emplace_back();
          e.surface = s;
          e.triangle = t;
          e.cell = cell;
          e.cuts = std::uint16_t(n);
          e.side = side;
          const auto [u, v] = formats::mesh_cell_centre(n, cell);
          e.position = array_of(corners.at(u, v));
          e.normal = formats::encode_normal(array_of(normal));
          e.area = 0.5f * doubled / float(n) / float(n);
          e.object = std::uint16_t(frame.surfaces[s].object);
        }
      }
    }
  return elements;
}

void put_sums(const MeshSums& sums, std::vector<formats::MeshElement>& elements) {
  for (std::size_t first = 0; first < elements.size();) {
    const formats::MeshElement& side = elements[first];
    const std::size_t count = std::size_t(side.cuts) * side.cuts;
    const auto found = sums.cells().find({side.surface, side.triangle, side.side});
    for (std::size_t i = 0; i < count && found != sums.cells().end(); ++i) {
      elements[first + i].photons = found->second[i].photons;
      elements[first + i].sums = found->second[i].sums;
      elements[first + i].irradiance = {float(found->second[i].squares), 0, 0};
    }
    first += count;
  }
}

void leave_out_dark(std::vector<formats::MeshElement>& elements) {
  std::size_t kept = 0;
  for (std::size_t first = 0; first < elements.size();) {
    const std::size_t last = first + std::size_t(elements[first].cuts) * elements[first].cuts;
    bool lit = false;
    for (std::size_t i = first; i < last; ++i)
      lit |= elements[i].irradiance != std::array<float, 3>{} || elements[i].photons > 0;
    for (std::size_t i = first; i < last && lit; ++i) elements[kept++] = elements[i];
    first = last;
  }
  elements.resize(kept);
}

void smooth_elements(const Tracer& tracer, std::span<const Rgbd> flux, const MeshFilter& filter,
                     std::span<const float> widths, std::vector<formats::MeshElement>& elements) {
  const std::vector<Sample> samples = samples_of(tracer, flux, filter, widths, elements);
  Smoothed smoothed(samples.size());
  if (filter.kind == MeshFilter::Kind::none) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples[i].area > 0) smoothed.light[i] = flux[i] * (1 / double(samples[i].area));
  } else {
    smoothed = smooth_all(samples, filter);
    put_right(samples, elements, smoothed.light);
  }
  put_light(smoothed.light, elements);
}

void smooth_by_scales(const Tracer& tracer, const MeshFlux& flux, double width, std::span<const float> widths,
                      std::vector<formats::MeshElement>& elements) {
  const auto gaussian = [&](double factor) { return MeshFilter{MeshFilter::Kind::gaussian, factor * width}; };
  std::vector<Sample> samples = samples_of(tracer, flux.mean, gaussian(1), widths, elements);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].squares = flux.squares[i];
  const auto widen = [&] {
    for (Sample& s : samples) s.width *= 2;
  };
  const Smoothed fine = smooth_all(samples, gaussian(1));
  widen();
  const Smoothed middle = smooth_all(samples, gaussian(2));
  widen();
  const Smoothed coarse = smooth_all(samples, gaussian(4));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double a = luminance(fine.light[i] - middle.light[i]), b = luminance(middle.light[i] - coarse.light[i]);
    samples[i].flux = Rgbd(a * a, b * b, 0) * double(samples[i].area);
  }
  const Smoothed squares = smooth_all(samples, gaussian(4));  // mean squares of the two bands around each place
  std::vector<Rgbd> light(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double a = kept_share(squares.light[i].r, fine.variance[i]),
                 b = std::max(a, kept_share(squares.light[i].g, middle.variance[i]));
    // Written as a convex sum, so that rounding makes no light negative.
    light[i] = coarse.light[i] * (1 - b) + middle.light[i] * (b - a) + fine.light[i] * a;
    samples[i].flux = flux.mean[i];
  }
  put_right(samples, elements, light);
  put_light(light, elements);
}

}  // namespace tempolux
