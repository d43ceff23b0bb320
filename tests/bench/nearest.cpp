// tests/bench/nearest.cpp -- exact neighbours: PhotonIndex against nanoflann, same photons, same queries.
//
//   nearest [photons] [queries] [rounds]        (1000000 200000 5)
//
// Photons are spread over the walls of a room and a sphere in it; photons and queries are given in Morton
// order (unless said otherwise). One thread, CPU time; the contenders alternate, and the medians over the
// rounds are printed as JSON, ratios against the better nanoflann of the round. "sets" is what find_nearest
// promises (the k nearest, by place in the index); "sorted" adds sort_by_distance: nanoflann's order.
// Bounded: within 1.3 times the mean distance of the k-th neighbour. Results that do not add up to the same
// are an error (exit 1).
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <nanoflann.hpp>
#include <string>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/density/irradiance_estimate.h"
#include "lib/density/morton.h"
#include "tests/support/sphere.h"

namespace {

using namespace tempolux;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

struct SurfacePoint {
  Vec3 position, normal;
};

/// Uniform by area over the unit cube's inside and a sphere of radius 0.3 in it.
SurfacePoint surface_point(std::uint64_t i, std::uint64_t seed) {
  const PathRandom random(seed, i);
  const Vec2 u = random.get2(0, Purpose::test), v = random.get2(1, Purpose::test);
  const float sphere_area = 4 * kPi * 0.09f, side = v.x * (6 + sphere_area);
  if (side >= 6) {
    const Vec3 n = test::sample_sphere(u);
    return {Vec3{0.5f, 0.5f, 0.5f} + 0.3f * n, n};
  }
  const int axis = int(side) % 3;
  const float at = side >= 3 ? 1.0f : 0.0f;
  SurfacePoint point;
  point.position[axis] = at;
  point.position[(axis + 1) % 3] = u.x;
  point.position[(axis + 2) % 3] = u.y;
  point.normal[axis] = 1 - 2 * at;
  return point;
}

std::vector<SurfacePoint> surface_points(std::size_t count, std::uint64_t seed) {
  std::vector<SurfacePoint> points(count);
  std::vector<Vec3> positions(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = surface_point(i, seed);
    positions[i] = points[i].position;
  }
  std::vector<SurfacePoint> ordered;
  for (std::uint32_t i : morton_order(positions)) ordered.push_back(points[i]);
  return ordered;
}

struct Cloud {
  const std::vector<SurfacePoint>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i].position[int(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Nanoflann =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

/// nanoflann's own bounded search needs its own result set: this is its KNNResultSet with a first bound.
struct BoundedResult : nanoflann::KNNResultSet<float, std::uint32_t> {
  float bound;
  BoundedResult(std::size_t k, float bound_) : KNNResultSet(k), bound(bound_) {}
  float worstDist() const { return std::min(bound, KNNResultSet::worstDist()); }
};

struct Contender {
  std::string name;
  std::function<float(Vec3)> search;  // returns something that depends on the result
  std::vector<double> seconds{};
};

void run(const char* title, std::vector<Contender> contenders, const std::vector<SurfacePoint>& queries, int rounds,
         bool last) {
  std::vector<double> sums(contenders.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      const double start = cpu_seconds();
      double sum = 0;
      for (const SurfacePoint& q : queries) sum += double(contenders[c].search(q.position));
      contenders[c].seconds.push_back(cpu_seconds() - start);
      sums[c] = sum;
      if (!(std::abs(sum - sums[0]) <= 1e-6 * sums[0])) {
        std::fprintf(stderr, "nearest: %s: %s disagrees\n", title, contenders[c].name.c_str());
        std::exit(1);
      }
    }
  std::printf("  \"%s\": {", title);
  for (const Contender& c : contenders)
    std::printf("\"%s_mq_per_s\": %.3f, ", c.name.c_str(), double(queries.size()) * 1e-6 / median(c.seconds));
  // contenders 0 and 1 are nanoflann: the better of the two in each round is what counts
  for (std::size_t i = 2; i < contenders.size(); ++i) {
    std::vector<double> ratio;
    for (std::size_t r = 0; r < contenders[i].seconds.size(); ++r)
      ratio.push_back(std::min(contenders[0].seconds[r], contenders[1].seconds[r]) / contenders[i].seconds[r]);
    std::printf("\"%s_ratio\": %.2f, ", contenders[i].name.c_str(), median(ratio));
  }
  std::printf("\"sum\": %.6g}%s\n", sums[0], last ? "" : ",");
}

template <class Build>
std::pair<double, double> build_times(Build build, int rounds) {  // CPU s, wall s
  std::vector<double> cpu, wall;
  for (int round = 0; round < rounds; ++round) {
    const double c = cpu_seconds(), w = wall_seconds();
    build();
    cpu.push_back(cpu_seconds() - c);
    wall.push_back(wall_seconds() - w);
  }
  return {median(cpu), median(wall)};
}

class Benchmark {
 public:
  Benchmark(std::size_t photon_count, std::size_t query_count, int rounds)
      : rounds_(rounds),
        points_(surface_points(photon_count, 1)),
        queries_(surface_points(query_count, 2)),
        flann10_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(10)),
        flann32_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(32)) {
    for (const SurfacePoint& p : points_) {
      formats::Photon photon{.position = {p.position.x, p.position.y, p.position.z}, .flux = {1, 1, 1}};
      photon.normal = formats::encode_normal({p.normal.x, p.normal.y, p.normal.z});
      photons_.push_back(photon);
    }
  }

  void run_all() {
    std::printf("{\n  \"photons\": %zu, \"queries\": %zu, \"rounds\": %d,\n", points_.size(), queries_.size(), rounds_);
    builds();
    index_ = PhotonIndex(photons_);
    bound_ = bound_of(50);
    for (std::size_t k : {std::size_t(50), std::size_t(100)})
      for (bool bounded : {false, true}) nearest(k, bounded);
    random_order();
    within();
    estimates();
    std::printf("}\n");
  }

 private:
  /// 1.3 times the mean distance of the k-th neighbour.
  float bound_of(std::size_t k) {
    double mean = 0;
    for (const SurfacePoint& q : queries_) {
      index_.find_nearest({.point = q.position}, int(k), list_);
      mean += std::sqrt(double(list_.distance2()[list_.farthest()]));
    }
    return float(1.3 * mean / double(queries_.size()));
  }

  void builds() {
    const auto flann10 = build_times([&] { flann10_.buildIndex(); }, rounds_);
    const auto flann32 = build_times([&] { flann32_.buildIndex(); }, rounds_);
    const auto ours = build_times([&] { PhotonIndex{photons_}; }, rounds_);
    std::printf(
        "  \"build\": {\"nanoflann10_cpu_s\": %.4f, \"nanoflann32_cpu_s\": %.4f, "
        "\"ours_cpu_s\": %.4f, \"ours_wall_s\": %.4f},\n",
        flann10.first, flann32.first, ours.first, ours.second);
  }

  float flann_nearest(const Nanoflann& tree, Vec3 p, std::size_t k, float bound2) {
    distance2_.resize(k);
    photon_.resize(k);
    BoundedResult result(k, bound2);
    result.init(photon_.data(), distance2_.data());
    tree.findNeighbors(result, &p.x, nanoflann::SearchParams());
    return result.size() ? distance2_[result.size() - 1] : 0.0f;
  }

  void nearest(std::size_t k, bool bounded) {
    const float radius = bounded ? bound_of(k) : std::numeric_limits<float>::infinity();
    const float bound2 = bounded ? radius * radius : std::numeric_limits<float>::max();
    std::string title = "k";
    title += std::to_string(k);
    if (bounded) title += "_bounded";
    const auto ours = [=, this](Vec3 p, bool sorted) {
      index_.find_nearest({.point = p, .max_radius = radius}, int(k), list_);
      if (sorted) list_.sort_by_distance();
      return list_.count() ? list_.distance2()[list_.farthest()] : 0.0f;
    };
    run(title.c_str(),
        {{"nanoflann10", [=, this](Vec3 p) { return flann_nearest(flann10_, p, k, bound2); }},
         {"nanoflann32", [=, this](Vec3 p) { return flann_nearest(flann32_, p, k, bound2); }},
         {"sets", [=](Vec3 p) { return ours(p, false); }},
         {"sorted", [=](Vec3 p) { return ours(p, true); }}},
        queries_, rounds_, false);
  }

  /// The same without the help of Morton order: successive queries are strangers.
  void random_order() {
    std::vector<SurfacePoint> queries;
    for (std::size_t i = 0; i < queries_.size(); ++i) queries.push_back(surface_point(i, 2));
    const auto flann = [this](const Nanoflann& tree, Vec3 p) {
      return flann_nearest(tree, p, 50, std::numeric_limits<float>::max());
    };
    run("k50_random_order",
        {{"nanoflann10", [=, this](Vec3 p) { return flann(flann10_, p); }},
         {"nanoflann32", [=, this](Vec3 p) { return flann(flann32_, p); }},
         {"sets",
          [this](Vec3 p) {
            index_.find_nearest({.point = p}, 50, list_);
            return list_.distance2()[list_.farthest()];
          }}},
        queries, rounds_, false);
  }

  void within() {
    const auto flann = [this](const Nanoflann& tree, Vec3 p) {
      matches_.clear();
      nanoflann::SearchParams params;
      params.sorted = false;
      return float(tree.radiusSearch(&p.x, bound_ * bound_, matches_, params));
    };
    run("within",
        {{"nanoflann10", [=, this](Vec3 p) { return flann(flann10_, p); }},
         {"nanoflann32", [=, this](Vec3 p) { return flann(flann32_, p); }},
         {"ours",
          [this](Vec3 p) {
            index_.find_within({.point = p, .max_radius = bound_}, list_);
            return float(list_.count());
          }}},
        queries_, rounds_, false);
  }

  /// The whole irradiance estimate with its tests, queries in random order.
  void estimates() {
    std::vector<Vec3> positions, normals;
    for (std::size_t i = 0; i < queries_.size(); ++i) {
      const SurfacePoint p = surface_point(i, 2);
      positions.push_back(p.position);
      normals.push_back(p.normal);
    }
    std::vector<IrradianceEstimate> results(positions.size());
    const auto [cpu, wall] = build_times(
        [&] {
          NeighbourList scratch;
          for (std::size_t i = 0; i < positions.size(); ++i)
            results[i] = estimate_irradiance(index_, positions[i], normals[i], {}, scratch);
        },
        rounds_);
    std::printf("  \"estimate_irradiance_k50\": {\"mq_per_cpu_s\": %.3f, \"mq_per_wall_s\": %.3f}\n",
                double(positions.size()) * 1e-6 / cpu, double(positions.size()) * 1e-6 / wall);
  }

  int rounds_;
  std::vector<SurfacePoint> points_, queries_;
  Cloud cloud_{points_};
  Nanoflann flann10_, flann32_;
  std::vector<formats::Photon> photons_;
  PhotonIndex index_;
  NeighbourList list_;
  float bound_ = 0;
  std::vector<float> distance2_;
  std::vector<std::uint32_t> photon_;
  std::vector<std::pair<std::uint32_t, float>> matches_;
};

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int i, std::size_t otherwise) {
    return argc > i ? std::size_t(std::strtoull(argv[i], nullptr, 10)) : otherwise;
  };
  Benchmark(number(1, 1000000), number(2, 200000), int(number(3, 5))).run_all();
  return 0;
}
