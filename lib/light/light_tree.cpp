#include "lib/light/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/sampling.h"

namespace tempolux {
namespace {

// Rounding must never make a bound exclude what it bounds: cosines are widened by this.
constexpr float kSlack = 4e-6f;
constexpr int kBucketCount = 16;
constexpr int kDepthOfHalving = 32;  // below, halves by count: with 2^31 lights the trail's 64 bits suffice

float safe_sqrt(float x) { return std::sqrt(std::max(0.0f, x)); }
/// cos(max(0, a - b)) of two angles in [0, pi].
float cos_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}

/// The vector turned around the unit axis.
Vec3 rotate(Vec3 v, Vec3 axis, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/// Smallest cone that holds both. Widened a little for rounding.
void join_cones(LightBounds& a, const LightBounds& b) {
  // The lines of two-sided lights have no sign of their own.
  const Vec3 axis_b = a.two_sided && b.two_sided && dot(a.axis, b.axis) < 0 ? -b.axis : b.axis;
  const float angle_a = std::acos(std::clamp(a.cos_spread, -1.0f, 1.0f));
  const float angle_b = std::acos(std::clamp(b.cos_spread, -1.0f, 1.0f));
  const float between = std::atan2(length(cross(a.axis, axis_b)), dot(a.axis, axis_b));
  if (std::min(between + angle_b, kPi) <= angle_a) return;
  if (std::min(between + angle_a, kPi) <= angle_b) {
    a.axis = axis_b;
    a.cos_spread = b.cos_spread;
    return;
  }
  const float spread = (angle_a + between + angle_b) / 2;
  const Vec3 around = normalize(cross(a.axis, axis_b));
  if (spread >= kPi || length2(around) == 0) {
    a.cos_spread = -1;
    return;
  }
  a.axis = normalize(rotate(a.axis, around, spread - angle_a));
  a.cos_spread = std::max(-1.0f, std::cos(spread) - kSlack);
}

LightBounds join(LightBounds a, const LightBounds& b) {
  join_cones(a, b);
  a.box.add(b.box);
  a.weight += b.weight;
  a.cos_reach = std::min(a.cos_reach, b.cos_reach);
  a.two_sided = a.two_sided || b.two_sided;
  return a;
}

/// A group of lights while a split is looked for; its spread from the length of the mean normal, without
/// the arc cosines of exact cones.
struct Group {
  Box3 box;
  Vec3d normals{};
  double weight = 0;
  std::size_t count = 0;

  void add(const LightBounds& b) {
    box.add(b.box);
    normals += Vec3d(b.axis) * (b.weight * (b.cos_spread > 0 ? b.cos_spread : 0));
    weight += b.weight;
    ++count;
  }
  void add(const Group& g) {
    box.add(g.box);
    normals += g.normals;
    weight += g.weight;
    count += g.count;
  }
  /// Weight x size^2 x spread, the cost of [Conty Estevez & Kulla 2018 (3)]: from 1 for one direction to 4.
  double cost() const {
    if (count == 0) return 0;
    const double size = box.diagonal();
    return weight * size * size * (4 - 3 * length(normals) / weight);
  }
};

}  // namespace

struct LightTree::Item {
  LightBounds bounds;
  Vec3 centre;
  std::uint32_t light;
};

LightTree::LightTree(const std::vector<LightBounds>& lights) {
  if (lights.empty()) return;
  TEMPOLUX_CHECK(lights.size() < 0x7fffffffu);
  for (const LightBounds& b : lights) whole_ += b.weight;
  std::vector<Item> items;
  items.reserve(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    items.push_back({lights[i], lights[i].box.centre(), std::uint32_t(i)});
    items.back().bounds.weight /= whole_;
    LightBounds& b = items.back().bounds;
    b.cos_spread = std::max(-1.0f, b.cos_spread - kSlack);
  }
  nodes_.reserve(2 * lights.size());
  trail_.resize(lights.size());
  build(items, 0, items.size(), 0, 0);
}

LightBounds LightTree::build(std::vector<Item>& items, std::size_t first, std::size_t last,
                             std::uint64_t trail, int depth) {
  const std::size_t at = nodes_.size();
  nodes_.emplace_back();
  LightBounds bounds;
  std::uint32_t index;
  if (last - first == 1) {
    bounds = items[first].bounds;
    index = items[first].light;
    trail_[index] = trail;
  } else {
    const std::size_t middle = split(items, first, last, depth < kDepthOfHalving);
    const LightBounds left = build(items, first, middle, trail, depth + 1);
    index = std::uint32_t(nodes_.size());
    bounds = join(left, build(items, middle, last, trail | std::uint64_t(1) << depth, depth + 1));
  }
  Node& node = nodes_[at];
  const Vec3 half = (bounds.box.upper - bounds.box.lower) * 0.5f;
  node.centre = bounds.box.centre();
  node.radius2 = length2(half) * (1 + kSlack);
  node.radius = std::sqrt(node.radius2);
  node.axis = bounds.axis;
  node.cos_spread = bounds.cos_spread;
  node.sin_spread = safe_sqrt(1 - bounds.cos_spread * bounds.cos_spread);
  node.cos_reach = bounds.cos_reach - kSlack;
  node.weight = bounds.weight;
  node.index = index;
  node.leaf = last - first == 1;
  node.two_sided = bounds.two_sided;
  return bounds;
}

/// Where to cut [first, last), at least two items: the cheapest of 15 planes per axis, by the sum of both
/// sides' cost; in the middle of the count if no plane parts the centres.
std::size_t LightTree::split(std::vector<Item>& items, std::size_t first, std::size_t last, bool by_cost) {
  Box3 centres;
  for (std::size_t i = first; i < last; ++i) centres.add(items[i].centre);
  const Vec3 extent = centres.upper - centres.lower;
  double best = INFINITY;
  int best_axis = -1, best_bucket = 0;
  const auto bucket_of = [&](const Item& item, int axis) {
    const float f = (item.centre[axis] - centres.lower[axis]) / extent[axis];
    return std::min(kBucketCount - 1, int(f * kBucketCount));
  };
  for (int axis = 0; axis < 3 && by_cost; ++axis) {
    if (!(extent[axis] > 0)) continue;
    std::array<Group, kBucketCount> buckets;
    for (std::size_t i = first; i < last; ++i)
      buckets[std::size_t(bucket_of(items[i], axis))].add(items[i].bounds);
    std::array<double, kBucketCount> below{};
    Group group;
    for (std::size_t b = 0; b + 1 < kBucketCount; ++b) {
      group.add(buckets[b]);
      below[b] = group.cost();
    }
    group = {};
    for (std::size_t b = kBucketCount - 1; b > 0; --b) {
      group.add(buckets[b]);
      const double cost = (below[b - 1] + group.cost()) / extent[axis];
      if (group.count > 0 && group.count < last - first && cost < best) {
        best = cost;
        best_axis = axis;
        best_bucket = int(b);
      }
    }
  }
  const auto begin = items.begin() + std::ptrdiff_t(first), end = items.begin() + std::ptrdiff_t(last);
  if (best_axis >= 0) {
    const auto cut = std::stable_partition(
        begin, end, [&](const Item& item) { return bucket_of(item, best_axis) < best_bucket; });
    return std::size_t(cut - items.begin());
  }
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t middle = first + (last - first) / 2;
  std::nth_element(begin, items.begin() + std::ptrdiff_t(middle), end, [axis](const Item& a, const Item& b) {
    return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.light < b.light;
  });
  return middle;
}

double LightTree::importance(const Node& node, Vec3 point, Vec3 normal) {
  const Vec3 to = node.centre - point;
  const float distance2 = length2(to);
  // A point among the lights may see them in any direction.
  if (distance2 <= node.radius2) return node.weight / std::max(node.radius2, 1e-18f);
  const float inverse = 1 / std::sqrt(std::max(distance2, 1e-18f));
  const float sin_size = node.radius * inverse, cos_size = safe_sqrt(1 - sin_size * sin_size);
  float cos_axis = -dot(node.axis, to) * inverse;
  if (node.two_sided) cos_axis = std::abs(cos_axis);
  const float sin_axis = safe_sqrt(1 - cos_axis * cos_axis);
  // Angle from the nearest normal, less the angle that the box fills.
  const bool within = cos_axis > node.cos_spread;
  const float cos_x = within ? 1.0f : cos_axis * node.cos_spread + sin_axis * node.sin_spread;
  const float sin_x = within ? 0.0f : sin_axis * node.cos_spread - cos_axis * node.sin_spread;
  const float cos_light = cos_difference(sin_x, cos_x, sin_size, cos_size);
  if (cos_light < node.cos_reach) return 0;
  float factor = inverse * inverse * std::max(cos_light, 1e-3f);
  if (normal != Vec3{}) {
    const float cos_i = dot(normal, to) * inverse;
    const float cos_surface = cos_difference(safe_sqrt(1 - cos_i * cos_i), cos_i, sin_size, cos_size);
    if (cos_surface < -kSlack) return 0;
    factor *= std::max(cos_surface, 1e-3f);
  }
  return node.weight * double(factor);
}

double LightTree::importance(Vec3 point, Vec3 normal) const {
  return nodes_.empty() ? 0 : whole_ * importance(nodes_[0], point, normal);
}

bool LightTree::choose(Vec3 point, Vec3 normal, float u, Choice& choice) const {
  double probability = 1, left_u = u;
  std::uint32_t at = 0;
  while (!nodes_[at].leaf) {
    const std::uint32_t second = nodes_[at].index;
    const double a = importance(nodes_[at + 1], point, normal), b = importance(nodes_[second], point, normal);
    if (!(a + b > 0)) return false;
    const double p = a / (a + b);
    if (left_u < p) {
      left_u = std::min(left_u / p, double(kOneMinusEpsilon));
      probability *= p;
      at = at + 1;
    } else {
      left_u = std::min((left_u - p) / (1 - p), double(kOneMinusEpsilon));
      probability *= b / (a + b);
      at = second;
    }
  }
  choice = {nodes_[at].index, probability};
  return probability > 0;
}

double LightTree::probability(Vec3 point, Vec3 normal, std::uint32_t light) const {
  double probability = 1;
  std::uint32_t at = 0;
  for (std::uint64_t trail = trail_[light]; !nodes_[at].leaf; trail >>= 1) {
    const std::uint32_t second = nodes_[at].index;
    const double a = importance(nodes_[at + 1], point, normal), b = importance(nodes_[second], point, normal);
    if (!(a + b > 0)) return 0;
    probability *= (trail & 1 ? b : a) / (a + b);
    at = trail & 1 ? second : at + 1;
  }
  return probability;
}

}  // namespace tempolux
