#include "lib/scene/tangents.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

using Corner = std::uint32_t;  // 3 x triangle + number of the corner (0, 1, 2)

Corner next(Corner c) { return c % 3 == 2 ? c - 2 : c + 1; }
Corner previous(Corner c) { return c % 3 == 0 ? c + 2 : c - 1; }

/// The attributes of a vertex. Corners with equal attributes are one vertex.
struct VertexKey {
  std::array<float, 8> values;  // + 0.0f turns -0 into 0
  VertexKey(Vec3 p, Vec3 n, Vec2 uv)
      : values{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f, n.x + 0.0f, n.y + 0.0f, n.z + 0.0f, uv.x + 0.0f, uv.y + 0.0f} {}
  bool operator==(const VertexKey&) const = default;
};
struct KeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t hash = 0;
    for (const float value : key.values) {
      hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// Unit vector along the component of v perpendicular to the unit vector n; zero if there is none.
Vec3d across(Vec3d v, Vec3d n) { return normalize(v - n * dot(n, v)); }

/// Differences of texture coordinates from corner 0 to corners 1 and 2.
struct Gradient {
  double v1, v2, area;  // twice the signed area: positive if u and v have the corners' orientation
  explicit Gradient(const std::array<Vec2, 3>& at) : v1(double(at[1].y) - at[0].y), v2(double(at[2].y) - at[0].y) {
    area = (double(at[1].x) - at[0].x) * v2 - (double(at[2].x) - at[0].x) * v1;
  }
  /// The direction in which u grows, times |area|. The edges go to corners 1 and 2.
  Vec3d along_u(Vec3d edge1, Vec3d edge2) const { return (edge1 * v2 - edge2 * v1) * (area < 0 ? -1.0 : 1.0); }
};

/// Groups corners that share a tangent. The groups depend on the shape at rest only.
class TangentGroups {
 public:
  TangentGroups(const Primitive& primitive, const Texture& normal_map)
      : primitive_(primitive), normal_map_(normal_map), group_(3 * primitive.triangles.size(), kNone) {
    join_vertices();
    measure();
    join_edges();
    for (Corner c = 0; c < group_.size(); ++c)
      if (has_tangent_[c / 3] && group_[c] == kNone) grow(c);
    lend();
  }

  std::size_t count() const { return side_.size(); }
  std::uint32_t group(Corner c) const { return group_[c]; }
  float side(std::uint32_t group) const { return side_[group]; }
  /// The unit tangent of each group, for vertices with these positions and normals; zero if a group has no direction.
  std::vector<Vec3> tangents(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) const;

 private:
  std::uint32_t vertex(Corner c) const { return primitive_.triangles[c / 3][c % 3]; }
  std::array<Vec2, 3> coordinates(std::size_t triangle) const {
    return corner_coordinates(primitive_, primitive_.triangles[triangle], normal_map_);
  }
  void join_vertices();
  void measure();
  void join_edges();
  void grow(Corner first);
  void lend();

  const Primitive& primitive_;
  const Texture& normal_map_;
  std::vector<std::uint32_t> joined_;  // for each vertex, the first vertex with the same attributes
  std::vector<bool> has_tangent_;      // for each triangle: the triangle and its texture coordinates have area
  // For each triangle: +1 if u and v have the orientation of the corners, -1 if the opposite orientation, 0 if unknown.
  std::vector<std::int8_t> turns_;
  // For each corner: the edge from it to the next corner also belongs to a neighbour; this is the neighbour's corner at
  // which that edge starts. kNone: no neighbour.
  std::vector<std::uint32_t> across_;
  std::vector<std::uint32_t> group_;  // of each corner
  std::vector<float> side_;           // of each group: the sign of its tangents
};

void TangentGroups::join_vertices() {
  const std::vector<Vec2>& uvs = texture_coordinates(primitive_, normal_map_.uv_set);
  std::unordered_map<VertexKey, std::uint32_t, KeyHash> first;
  first.reserve(primitive_.positions.size());
  for (std::uint32_t v = 0; v < primitive_.positions.size(); ++v)
    joined_.push_back(first.try_emplace({primitive_.positions[v], primitive_.normals[v], uvs[v]}, v).first->second);
}

void TangentGroups::measure() {
  for (std::size_t t = 0; t < primitive_.triangles.size(); ++t) {
    const auto& c = primitive_.triangles[t];
    const auto& p = primitive_.positions;
    const bool collapsed = p[c[0]] == p[c[1]] || p[c[1]] == p[c[2]] || p[c[2]] == p[c[0]];
    const double area = collapsed ? 0 : Gradient(coordinates(t)).area;
    turns_.push_back(area > 0 ? 1 : area < 0 ? -1 : 0);
    has_tangent_.push_back(area != 0);
  }
}

/// Joins triangles along edges that they traverse in opposite directions.
void TangentGroups::join_edges() {
  struct Edge {
    std::uint32_t low, high;
    Corner corner;
  };
  std::vector<Edge> edges;
  edges.reserve(group_.size());
  for (Corner c = 0; c < group_.size(); ++c) {
    const std::uint32_t a = joined_[vertex(c)], b = joined_[vertex(next(c))];
    edges.push_back({std::min(a, b), std::max(a, b), c});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.low, x.high, x.corner) < std::tie(y.low, y.high, y.corner);
  });
  across_.assign(group_.size(), kNone);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto starts_low = [&](const Edge& e) { return joined_[vertex(e.corner)] == e.low; };
    if (across_[edges[i].corner] != kNone) continue;
    for (std::size_t j = i + 1; j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high; ++j)
      if (across_[edges[j].corner] == kNone && starts_low(edges[j]) != starts_low(edges[i])) {
        across_[edges[i].corner] = edges[j].corner;
        across_[edges[j].corner] = edges[i].corner;
        break;
      }
  }
}

/// Starts a group at a corner, and adds the corners of its vertex that are joined to it by edges at the vertex.
void TangentGroups::grow(Corner first) {
  const auto group = std::uint32_t(side_.size());
  const std::int8_t turns = turns_[first / 3];
  side_.push_back(turns > 0 ? -1.0f : 1.0f);
  std::vector<Corner> open{first};
  while (!open.empty()) {
    const Corner c = open.back();
    open.pop_back();
    std::int8_t& here = turns_[c / 3];
    if (here == 0) here = turns;  // a triangle without area takes the orientation of the first group that reaches it
    if (group_[c] != kNone || here != turns) continue;
    group_[c] = group;
    // Two neighbours share an edge at this vertex. In the neighbour, the edge before this corner starts at this
    // vertex, and the edge after this corner ends at it.
    if (const Corner over = across_[previous(c)]; over != kNone) open.push_back(over);
    if (const Corner over = across_[c]; over != kNone) open.push_back(next(over));
  }
}

/// Corners that have no group, since their triangles have no area, take the first group of their vertex.
void TangentGroups::lend() {
  std::vector<std::uint32_t> lender(joined_.size(), kNone);
  for (Corner c = 0; c < group_.size(); ++c)
    if (std::uint32_t& group = lender[joined_[vertex(c)]]; group == kNone) group = group_[c];
  for (Corner c = 0; c < group_.size(); ++c)
    if (group_[c] == kNone) group_[c] = lender[joined_[vertex(c)]];
}

std::vector<Vec3> TangentGroups::tangents(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) const {
  std::vector<Vec3d> sums(count(), Vec3d{});
  for (std::size_t t = 0; t < primitive_.triangles.size(); ++t) {
    if (!has_tangent_[t]) continue;
    const auto& corners = primitive_.triangles[t];
    const Vec3d p[] = {Vec3d(positions[corners[0]]), Vec3d(positions[corners[1]]), Vec3d(positions[corners[2]])};
    const Vec3d along_u = Gradient(coordinates(t)).along_u(p[1] - p[0], p[2] - p[0]);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3d normal(normals[corners[c]]);
      const Vec3d before = across(p[(c + 2) % 3] - p[c], normal), after = across(p[(c + 1) % 3] - p[c], normal);
      sums[group_[3 * t + c]] += across(along_u, normal) * std::acos(std::clamp(dot(before, after), -1.0, 1.0));
    }
  }
  std::vector<Vec3> unit;
  for (const Vec3d& sum : sums) unit.push_back(Vec3(normalize(sum)));
  return unit;
}

/// The displacement that a morph target adds to the tangents of each group; empty if the target moves nothing.
std::vector<Vec3> added_by(const MorphTarget& target, const Primitive& primitive, const TangentGroups& groups,
                           const std::vector<Vec3>& at_rest) {
  if (target.positions.empty() && target.normals.empty()) return {};
  std::vector<Vec3> positions = primitive.positions, normals = primitive.normals;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!target.positions.empty()) positions[v] = positions[v] + target.positions[v];
    if (!target.normals.empty())
      if (const Vec3 n = normalize(normals[v] + target.normals[v]); length2(n) > 0.5f) normals[v] = n;
  }
  std::vector<Vec3> added = groups.tangents(positions, normals);
  for (std::size_t g = 0; g < added.size(); ++g) added[g] = added[g] - at_rest[g];
  added.push_back({});
  return added;
}

}  // namespace

void make_tangents(Primitive& primitive, const Texture& normal_map) {
  if (primitive.normals.empty() || texture_coordinates(primitive, normal_map.uv_set).empty()) return;
  const TangentGroups groups(primitive, normal_map);
  std::vector<Vec3> at_rest = groups.tangents(primitive.positions, primitive.normals);
  at_rest.push_back({});  // for vertices without a group
  std::vector<std::vector<Vec3>> added;
  for (const MorphTarget& target : primitive.targets) added.push_back(added_by(target, primitive, groups, at_rest));

  // A vertex belongs to its first group; each further group gets a copy of the vertex.
  constexpr std::uint32_t kNew = kNone - 1;
  std::vector<std::uint32_t> sources(primitive.positions.size());
  std::iota(sources.begin(), sources.end(), 0u);
  std::vector<std::uint32_t> group(sources.size(), kNew), copy(sources.size(), kNone);
  auto triangles = primitive.triangles;
  for (Corner c = 0; c < 3 * triangles.size(); ++c) {
    std::uint32_t v = triangles[c / 3][c % 3];
    const std::uint32_t source = v, wanted = groups.group(c);
    while (group[v] != wanted && group[v] != kNew) {
      if (copy[v] == kNone) {
        copy[v] = std::uint32_t(sources.size());
        sources.push_back(source);
        group.push_back(kNew);
        copy.push_back(kNone);
      }
      v = copy[v];
    }
    group[v] = wanted;
    triangles[c / 3][c % 3] = v;
  }
  if (sources.size() > primitive.positions.size()) take_vertices(primitive, sources);
  primitive.triangles = std::move(triangles);
  const auto number = [&](std::uint32_t v) { return group[v] < groups.count() ? group[v] : groups.count(); };
  for (std::uint32_t v = 0; v < sources.size(); ++v) {
    primitive.tangents.push_back(at_rest[number(v)]);
    primitive.tangent_sides.push_back(group[v] < groups.count() ? groups.side(group[v]) : 1.0f);
    for (std::size_t t = 0; t < added.size(); ++t)
      if (!added[t].empty()) primitive.targets[t].tangents.push_back(added[t][number(v)]);
  }
}

}  // namespace tempolux
