#include "lib/gather/mesh_elements.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "formats/error.h"
#include "formats/octahedral.h"
#include "lib/core/parallel.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr std::size_t kChunk = 1024;         ///< photons, or elements, in a piece of work
constexpr double kPhotonsInKernel = 256;     ///< noise of an element 1/16
constexpr float kSameWay = 0.866f;           ///< cosine of 30 degrees
constexpr float kReach = 3;                  ///< of a Gaussian, standard deviations

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

/// An element with what is filtered.
struct Sample {
  Vec3 position, normal;
  Rgb flux{0.0f};                            ///< W
  float area = 0;
};

/// Samples by cubes of space as wide as the filter reaches.
class Neighbours {
 public:
  Neighbours(const std::vector<Sample>& samples, float reach) : samples_(samples), per_m_(1 / reach) {
    for (std::size_t i = 0; i < samples.size(); ++i) cubes_[key(cube(samples[i].position))].push_back(std::uint32_t(i));
  }
  template <class Visit>
  void around(Vec3 position, const Visit& visit) const {
    const auto at = cube(position);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const std::array<std::int64_t, 3> there{at[0] + x, at[1] + y, at[2] + z};
          const auto found = cubes_.find(key(there));
          if (found == cubes_.end()) continue;
          for (const std::uint32_t i : found->second)
            if (cube(samples_[i].position) == there) visit(i);   // cubes may share a key
        }
  }

 private:
  std::array<std::int64_t, 3> cube(Vec3 p) const {
    return {std::int64_t(std::floor(p.x * per_m_)), std::int64_t(std::floor(p.y * per_m_)), std::int64_t(std::floor(p.z * per_m_))};
  }
  static std::uint64_t key(const std::array<std::int64_t, 3>& c) {
    return mix64(mix64(mix64(std::uint64_t(c[0])) + std::uint64_t(c[1])) + std::uint64_t(c[2]));
  }
  const std::vector<Sample>& samples_;
  float per_m_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cubes_;
};

/// Weight of a neighbour by place alone; 0: it does not count.
float weight(const MeshFilter& filter, const Sample& a, const Sample& b) {
  const float width = float(filter.width);
  const Vec3 d = b.position - a.position;
  if (dot(a.normal, b.normal) < kSameWay || std::abs(dot(d, a.normal)) > width) return 0;
  if (filter.kind == MeshFilter::Kind::box)
    return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= width ? 1.0f : 0.0f;
  const float d2 = dot(d, d) / (width * width);
  return d2 > kReach * kReach ? 0 : std::exp(-0.5f * d2);
}

/// Irradiance of each sample: flux over area under the kernel; `alike` (may be empty): ln of irradiance by which neighbours are weighed.
std::vector<Rgb> smooth(const std::vector<Sample>& samples, const MeshFilter& filter, const Neighbours& neighbours, const std::vector<float>& alike) {
  std::vector<Rgb> result(samples.size(), Rgb(0.0f));
  parallel_chunks(samples.size(), kChunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Rgbd flux{0.0};
      double area = 0;
      neighbours.around(samples[i].position, [&](std::uint32_t j) {
        float w = weight(filter, samples[i], samples[j]);
        if (w > 0 && !alike.empty()) {
          const float difference = (alike[j] - alike[i]) / filter.range;
          w *= std::exp(-0.5f * difference * difference);
        }
        if (!(w > 0)) return;
        flux += Rgbd(samples[j].flux) * double(w);
        area += double(w) * double(samples[j].area);
      });
      if (area > 0) result[i] = Rgb(flux * (1 / area));
    }
  });
  return result;
}

/// After weighing by likeness each object shall have the flux that it had, by channel.
void put_right(const std::vector<Sample>& samples, const std::vector<std::uint16_t>& objects, std::vector<Rgb>& irradiance) {
  std::map<std::uint16_t, std::pair<Rgbd, Rgbd>> flux;   // before, after
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto& [before, after] = flux.try_emplace(objects[i], Rgbd{0.0}, Rgbd{0.0}).first->second;
    before += Rgbd(samples[i].flux);
    after += Rgbd(irradiance[i]) * double(samples[i].area);
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (const auto& [before, after] = flux.at(objects[i]); after[c] > 0) irradiance[i][c] *= float(before[c] / after[c]);
}

}  // namespace

std::uint32_t mesh_cuts(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, double cell) {
  const Corners t = corners_of(frame, surface, triangle);
  const double longest = double(std::max({length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)}));
  return std::uint32_t(std::clamp(std::ceil(longest / cell), 1.0, double(formats::kMostCuts)));
}

double surface_area(const SceneFrame& frame) {
  double area = 0;
  for (std::uint32_t s = 0; s < frame.surfaces.size(); ++s)
    for (std::uint32_t t = 0; t < frame.surfaces[s].primitive->triangles.size(); ++t)
      area += 0.5 * double(length(corners_of(frame, s, t).cross_product()));
  return area;
}

MeshOptions with_widths(const MeshOptions& options, const SceneFrame& frame, std::uint64_t photons) {
  MeshOptions result = options;
  double& width = result.filter.width;
  if (!(width > 0)) width = std::sqrt(kPhotonsInKernel * surface_area(frame) / (4 * 3.14159265358979 * double(std::max<std::uint64_t>(1, photons))));
  if (!(width > 0)) width = 1;               // of a scene without surfaces
  if (!(result.cell > 0)) result.cell = width;
  return result;
}

void MeshSums::add(std::span<const formats::Photon> photons, Vec3 offset, int times) {
  struct Place {
    Side side{};
    std::uint32_t cuts = 0, cell = 0;        ///< cuts 0: not found
  };
  std::vector<Place> places(photons.size());
  parallel_chunks(photons.size(), kChunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const formats::Photon& photon = photons[i];
      const auto decoded = formats::decode_normal(photon.normal);
      const Vec3 normal{float(decoded[0]), float(decoded[1]), float(decoded[2])};
      const Vec3 position = Vec3{photon.position[0], photon.position[1], photon.position[2]} + offset;
      // Above the surface by what rounding may be, or a thousandth of a cell.
      const float above = std::max(float(cell_) * 1e-3f, max_component(abs(position)) * 0x1p-18f);
      Hit hit;
      if (!tracer_.intersect({position + normal * above, -normal, 0, 2 * above}, hit)) continue;
      const std::uint32_t cuts = mesh_cuts(tracer_.frame(), hit.surface, hit.triangle, cell_);
      const bool back = dot(tracer_.surface_point(hit).normal_geometric, normal) < 0;
      places[i] = {{hit.surface, hit.triangle, std::uint16_t(back)}, cuts, formats::mesh_cell(cuts, hit.u, hit.v)};
    }
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
    cell.photons += std::uint32_t(times);
    for (std::size_t c = 0; c < 3; ++c) {   // unsigned: what overflows in a damaged file wraps, and comes back when it is taken away
      const auto more = std::uint64_t(std::llrint(std::clamp(double(photons[i].flux[c]) / unit_, 0.0, 9e18)));
      cell.sums[c] = std::int64_t(std::uint64_t(cell.sums[c]) + std::uint64_t(std::int64_t(times)) * more);
    }
  }
}

std::vector<formats::MeshElement> light_texture(const SceneFrame& frame, const MeshSums& sums, const MeshFilter& filter) {
  std::vector<formats::MeshElement> elements;
  std::vector<Sample> samples;
  std::vector<std::uint16_t> objects;
  for (std::uint32_t s = 0; s < frame.surfaces.size(); ++s)
    for (std::uint32_t t = 0; t < frame.surfaces[s].primitive->triangles.size(); ++t) {
      const Corners corners = corners_of(frame, s, t);
      const Vec3 across = corners.cross_product();
      const float doubled = length(across);
      if (!(doubled > 0)) continue;          // nothing arrives there
      const std::uint32_t n = mesh_cuts(frame, s, t, sums.cell());
      if (elements.size() + 2 * std::uint64_t(n) * n > kMostElements)
        throw InputError("--cell: more than " + std::to_string(kMostElements) + " elements of " + std::to_string(sums.cell()) + " m; give a larger one");
      for (std::uint16_t side = 0; side < 2; ++side) {
        const auto found = sums.cells().find({s, t, side});
        const Vec3 normal = across * ((side == 1) != frame.surfaces[s].flipped ? -1 / doubled : 1 / doubled);
        for (std::uint32_t cell = 0; cell < n * n; ++cell) {
          formats::MeshElement& e = elements.emplace_back();
          e.surface = s;
          e.triangle = t;
          e.cell = cell;
          e.cuts = std::uint16_t(n);
          e.side = side;
          const auto [u, v] = formats::mesh_cell_centre(n, cell);
          const Vec3 p = corners.at(u, v);
          e.position = {p.x, p.y, p.z};
          e.normal = formats::encode_normal({normal.x, normal.y, normal.z});
          e.area = 0.5f * doubled / float(n) / float(n);
          e.object = std::uint16_t(frame.surfaces[s].object);
          if (found != sums.cells().end()) {
            e.photons = found->second[cell].photons;
            e.sums = found->second[cell].sums;
          }
          Sample& sample = samples.emplace_back();
          sample.position = p;
          sample.normal = normal;
          sample.area = e.area;
          for (int c = 0; c < 3; ++c) sample.flux[c] = float(double(e.sums[std::size_t(c)]) * sums.unit());
          objects.push_back(e.object);
        }
      }
    }
  std::vector<Rgb> irradiance(samples.size(), Rgb(0.0f));
  if (filter.kind == MeshFilter::Kind::none) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples[i].area > 0) irradiance[i] = samples[i].flux * (1 / samples[i].area);
  } else {
    const float reach = float(filter.width) * (filter.kind == MeshFilter::Kind::box ? 1 : kReach);
    const Neighbours neighbours(samples, reach);
    MeshFilter first = filter;
    if (filter.kind == MeshFilter::Kind::bilateral) first.kind = MeshFilter::Kind::gaussian;
    irradiance = smooth(samples, first, neighbours, {});
    if (filter.kind == MeshFilter::Kind::bilateral) {
      std::vector<float> alike;
      for (const Rgb& e : irradiance) alike.push_back(std::log(std::max(1e-30f, (e.r + e.g + e.b) / 3)));
      irradiance = smooth(samples, filter, neighbours, alike);
      put_right(samples, objects, irradiance);
    }
  }
  // Sides that no light reaches are left out.
  std::size_t kept = 0;
  for (std::size_t first = 0; first < elements.size();) {
    const std::size_t last = first + std::size_t(elements[first].cuts) * elements[first].cuts;
    bool lit = false;
    for (std::size_t i = first; i < last; ++i) lit |= !is_black(irradiance[i]) || elements[i].photons > 0;
    for (std::size_t i = first; i < last && lit; ++i) {
      elements[kept] = elements[i];
      elements[kept++].irradiance = {irradiance[i].r, irradiance[i].g, irradiance[i].b};
    }
    first = last;
  }
  elements.resize(kept);
  return elements;
}

}  // namespace tempolux
