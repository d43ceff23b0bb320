#include "lib/light/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/sampling.h"

namespace tempolux {
namespace {

// Bounds must stay valid under rounding, so cosines are widened by this.
constexpr float kSlack = 4e-6f;
constexpr int kBucketCount = 16;
// From this depth on, nodes are halved by the number of lights. So no input makes the tree a list.
constexpr int kDepthOfHalving = 32;

inline float safe_sqrt(float x) { return std::sqrt(std::max(0.0f, x)); }
/// cos(max(0, a - b)) of two angles in [0, pi]. Both branches are computed: vector lanes cannot branch.
inline float cos_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  const float difference = cos_a * cos_b + sin_a * sin_b;
  return cos_a > cos_b ? 1.0f : difference;
}

/// Estimate of the mean of |x| from the mean of x and of x^2: right if all x are alike, and for the cosines of normals
/// that are uniform on the sphere (mean 0, square 1/3; 1/2). The mean of max(0, x) is (mean of x + mean of |x|) / 2.
inline float mean_magnitude(float mean, float square) { return safe_sqrt(0.25f * (mean * mean + 3 * square)); }

/// The vector turned around the unit axis.
Vec3 rotate(Vec3 v, Vec3 axis, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/// Smallest cone that holds both, widened a little for rounding.
void join_cones(LightBounds& a, const LightBounds& b) {
  // A two-sided light's axis may be reversed.
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

/// Adds lights of this weight and these means to `a`.
void join_means(LightBounds& a, double weight, Vec3 mean_normal, const std::array<float, 6>& mean_squares) {
  a.weight += weight;
  const float share = a.weight > 0 ? float(weight / a.weight) : 0.0f;
  a.mean_normal += (mean_normal - a.mean_normal) * share;
  for (std::size_t i = 0; i < mean_squares.size(); ++i)
    a.mean_squares[i] += (mean_squares[i] - a.mean_squares[i]) * share;
}

LightBounds join(LightBounds a, const LightBounds& b) {
  join_cones(a, b);
  a.box.add(b.box);
  join_means(a, b.weight, b.mean_normal, b.mean_squares);
  a.cos_reach = std::min(a.cos_reach, b.cos_reach);
  a.two_sided = a.two_sided || b.two_sided;
  a.backs_within.add(b.backs_within);
  return a;
}

/// A group of lights during the search for a split. Its spread is estimated from the length of the mean normal, which
/// costs less than the exact cone's arc cosines.
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
  /// Weight x size^2 x spread, the cost of [Conty Estevez & Kulla 2018 (3)]. Spread is 1 for lights of one direction
  /// and 4 at most.
  double cost() const {
    if (count == 0) return 0;
    const double size = box.diagonal();
    return weight * size * size * (4 - 3 * length(normals) / weight);
  }
};

}  // namespace

void LightBounds::add_weight(Vec3 n, double more) {
  join_means(*this, more, n, {n.x * n.x, n.y * n.y, n.z * n.z, 2 * n.x * n.y, 2 * n.x * n.z, 2 * n.y * n.z});
}

void LightBounds::add_punctual(double more) {
  const float all = 16.0f / 3;  // half of mean_magnitude(0, 16 / 3) is 1
  join_means(*this, more, {}, {all, all, all, 0, 0, 0});
}

struct LightTree::Item {
  LightBounds bounds;
  Vec3 centre;
  std::uint32_t light;
};

/// A node of the binary tree that the constructor builds before it joins nodes to eight children.
struct LightTree::Pair {
  LightBounds bounds;
  std::uint32_t second = 0;  ///< the second child; the first child is the next node
  std::uint32_t light = 0;
  bool leaf = false;
};

LightTree::LightTree(const std::vector<LightBounds>& lights) {
  if (lights.empty()) return;
  TEMPOLUX_CHECK(lights.size() < 0x0fffffffu);
  for (const LightBounds& b : lights) whole_ += b.weight;
  std::vector<Item> items;
  items.reserve(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    items.push_back({lights[i], lights[i].box.centre(), std::uint32_t(i)});
    LightBounds& b = items.back().bounds;
    b.weight /= whole_;
    b.cos_spread = std::max(-1.0f, b.cos_spread - kSlack);
  }
  std::vector<Pair> pairs;
  pairs.reserve(2 * lights.size());
  build_pairs(items, 0, items.size(), 0, pairs);
  place_.resize(lights.size());
  collapse(pairs, 0, 0);
}

LightBounds LightTree::build_pairs(std::vector<Item>& items, std::size_t first, std::size_t last, int depth,
                                   std::vector<Pair>& pairs) {
  const std::size_t at = pairs.size();
  pairs.emplace_back();
  if (last - first == 1) {
    pairs[at] = {items[first].bounds, 0, items[first].light, true};
  } else {
    const std::size_t middle = split(items, first, last, depth < kDepthOfHalving);
    const LightBounds left = build_pairs(items, first, middle, depth + 1, pairs);
    const std::uint32_t second = std::uint32_t(pairs.size());
    pairs[at] = {join(left, build_pairs(items, middle, last, depth + 1, pairs)), second, 0, false};
  }
  return pairs[at].bounds;
}

/// Makes a node of eight children from a binary tree: replaces the child with the largest weight x size^2 by its own
/// two children until there are eight.
void LightTree::collapse(const std::vector<Pair>& pairs, std::uint32_t pair, std::uint32_t parent) {
  std::uint32_t chosen[kWidth] = {pair};
  int count = 1;
  while (count < kWidth) {
    int open = -1;
    double most = -1;
    for (int i = 0; i < count; ++i) {
      const Pair& p = pairs[chosen[i]];
      const double diagonal = p.bounds.box.diagonal(), cost = p.bounds.weight * diagonal * diagonal;
      if (!p.leaf && cost > most) {
        most = cost;
        open = i;
      }
    }
    if (open < 0) break;
    const std::uint32_t opened = chosen[open];
    chosen[open] = opened + 1;
    chosen[count++] = pairs[opened].second;
  }
  const std::uint32_t at = std::uint32_t(nodes_.size());
  nodes_.push_back(Node{});
  nodes_[at].parent = parent;
  nodes_[at].count = std::uint8_t(count);
  for (int i = 0; i < count; ++i) {
    const Pair& p = pairs[chosen[i]];
    const std::uint32_t place = at * kWidth + std::uint32_t(i);
    set_child(nodes_[at], i, p.bounds);
    nodes_[at].leaf[i] = p.leaf;
    nodes_[at].child[i] = p.leaf ? p.light : std::uint32_t(nodes_.size());
    if (p.leaf) place_[p.light] = place;
    else collapse(pairs, chosen[i], place);
  }
}

void LightTree::set_child(Node& node, int lane, const LightBounds& bounds) const {
  const Vec3 centre = bounds.box.centre();
  for (int axis = 0; axis < 3; ++axis) {
    node.centre[axis][lane] = centre[axis];
    node.axis[axis][lane] = bounds.axis[axis];
  }
  node.radius[lane] = 0.5f * length(bounds.box.upper - bounds.box.lower) * (1 + kSlack);
  node.cos_spread[lane] = bounds.cos_spread;
  node.sin_spread[lane] = safe_sqrt(1 - bounds.cos_spread * bounds.cos_spread);
  node.cos_reach[lane] = bounds.cos_reach - kSlack;
  const Box3& backs = bounds.backs_within;
  const float farthest = length(max(abs(backs.lower - centre), abs(backs.upper - centre))) * (1 + kSlack);
  node.backs_within2[lane] = bounds.two_sided ? INFINITY : backs.empty() ? -1 : farthest * farthest;
  node.weight[lane] = bounds.weight;
  for (int axis = 0; axis < 3; ++axis) node.normals[axis][lane] = bounds.mean_normal[axis];
  for (std::size_t i = 0; i < bounds.mean_squares.size(); ++i) node.squares[i][lane] = bounds.mean_squares[i];
}

/// Returns the index at which to divide [first, last), which holds at least two items. The function compares 15 planes
/// per axis and takes the plane with the least sum of both sides' costs. If no plane separates the centres, it takes
/// the median along the longest side.
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
    for (std::size_t i = first; i < last; ++i) buckets[std::size_t(bucket_of(items[i], axis))].add(items[i].bounds);
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
    const auto cut =
        std::stable_partition(begin, end, [&](const Item& item) { return bucket_of(item, best_axis) < best_bucket; });
    return std::size_t(cut - items.begin());
  }
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t middle = first + (last - first) / 2;
  std::nth_element(begin, items.begin() + std::ptrdiff_t(middle), end, [axis](const Item& a, const Item& b) {
    return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.light < b.light;
  });
  return middle;
}

double LightTree::importances(const Node& node, Vec3 point, Vec3 normal, double importance[kWidth]) const {
  float factor[kWidth];
  const float no_normal = normal == Vec3{} ? 1.0f : 0.0f;
  for (int i = 0; i < kWidth; ++i) {
    const float x = node.centre[0][i] - point.x, y = node.centre[1][i] - point.y, z = node.centre[2][i] - point.z;
    const float distance2 = x * x + y * y + z * z, radius = node.radius[i];
    const float inverse = 1 / std::sqrt(std::max(distance2, 1e-18f));
    const float sin_size = std::min(1.0f, radius * inverse), cos_size = safe_sqrt(1 - sin_size * sin_size);
    const float along = -(node.axis[0][i] * x + node.axis[1][i] * y + node.axis[2][i] * z) * inverse;
    const float cos_axis = distance2 <= node.backs_within2[i] ? std::abs(along) : along;
    const float sin_axis = safe_sqrt(1 - cos_axis * cos_axis);
    // Smallest angle between the point's direction and any normal: the angle to the axis minus the spread and the angle
    // of the box.
    const float cos_x = cos_difference(sin_axis, cos_axis, node.sin_spread[i], node.cos_spread[i]);
    const float sin_difference = sin_axis * node.cos_spread[i] - cos_axis * node.sin_spread[i];
    const float sin_x = cos_axis > node.cos_spread[i] ? 0.0f : sin_difference;
    const float cos_light = cos_difference(sin_x, cos_x, sin_size, cos_size);
    const float cos_i = (normal.x * x + normal.y * y + normal.z * z) * inverse;
    const float above = cos_difference(safe_sqrt(1 - cos_i * cos_i), cos_i, sin_size, cos_size);
    const float cos_surface = no_normal > 0 ? 1.0f : above;
    // Mean cosines at the lights and at the surface. The directions to the places of a cube of this radius, uniform,
    // vary by sin_size^2 / 9 in each coordinate.
    const float vary = sin_size * sin_size / 9;
    const float mean = -(node.normals[0][i] * x + node.normals[1][i] * y + node.normals[2][i] * z) * inverse;
    const float square = (node.squares[0][i] * x * x + node.squares[1][i] * y * y + node.squares[2][i] * z * z +
                          node.squares[3][i] * x * y + node.squares[4][i] * x * z + node.squares[5][i] * y * z) *
                             (inverse * inverse) +
                         vary;
    const float both_sides = mean_magnitude(mean, square);
    const float of_lights = distance2 <= node.backs_within2[i] ? both_sides : 0.5f * (mean + both_sides);
    const float of_surface = no_normal > 0 ? 1.0f : 0.5f * (cos_i + mean_magnitude(cos_i, cos_i * cos_i + vary));
    const float likely = inverse * inverse * std::max(std::min(cos_light, of_lights), 1e-3f) *
                         std::max(std::min(cos_surface, of_surface), 1e-3f);
    const float reached = cos_light < node.cos_reach[i] ? 0.0f : likely;
    const float outside = cos_surface < -kSlack ? 0.0f : reached;
    // Inside the sphere around the box the point may see the lights in any direction.
    const float inside = 1 / std::max(radius * radius, 1e-18f);
    factor[i] = distance2 <= radius * radius ? inside : outside;
  }
  double sum = 0;
  for (int i = 0; i < kWidth; ++i) {
    importance[i] = node.weight[i] * double(factor[i]);
    sum += importance[i];
  }
  return sum;
}

LightTree::Start LightTree::start(Vec3 point, Vec3 normal) const {
  Start start;
  if (!nodes_.empty()) start.sum = whole_ * importances(nodes_[0], point, normal, start.each);
  return start;
}

bool LightTree::choose(const Start& start, Vec3 point, Vec3 normal, float u, Choice& choice) const {
  double probability = 1, left = u;
  for (const Node* node = &nodes_[0];;) {
    int lane = 0;
    if (node->count > 1) {
      double below[kWidth];
      const bool first = node == &nodes_[0];
      const double* each = first ? start.each : below;
      const double sum = first ? start.sum / whole_ : importances(*node, point, normal, below);
      if (!(sum > 0)) return false;
      left *= sum;
      // The lane in which the running sum passes `left`. If rounding keeps the sum below `left`, the last lane with a
      // weight.
      for (int i = 0; i < kWidth; ++i) {
        if (!(each[i] > 0)) continue;
        lane = i;
        if (left < each[i]) break;
        left -= each[i];
      }
      left = std::min(left / each[lane], 1 - 0x1p-53);
      probability *= each[lane] / sum;
    }
    if (node->leaf[lane]) {
      choice = {node->child[lane], probability, left};
      return probability > 0;
    }
    node = &nodes_[node->child[lane]];
  }
}

double LightTree::probability(Vec3 point, Vec3 normal, std::uint32_t light) const {
  double probability = 1;
  for (std::uint32_t place = place_[light];; place = nodes_[place / kWidth].parent) {
    const Node& node = nodes_[place / kWidth];
    if (node.count > 1) {
      double each[kWidth];
      const double sum = importances(node, point, normal, each);
      if (!(sum > 0)) return 0;
      probability *= each[place % kWidth] / sum;
    }
    if (place < kWidth) return probability;
  }
}

}  // namespace tempolux
