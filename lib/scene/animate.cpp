// lib/scene/animate.cpp -- evaluates tracks, transforms and poses at a time.
#include "lib/scene/animate.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

using Value = std::array<double, 4>;
using Path = AnimationTrack::Path;
using Interpolation = AnimationTrack::Interpolation;

Value unit(Value q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0)) return {0, 0, 0, 1};  // a spline that passes through zero has no direction there
  for (double& c : q) c /= length;
  return q;
}

Value lerp(const Value& a, const Value& b, double s) {
  Value v;
  for (std::size_t c = 0; c < 4; ++c) v[c] = a[c] + (b[c] - a[c]) * s;
  return v;
}

/// Interpolates along the shorter arc.
Value slerp(const Value& a, Value b, double s) {
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  if (cosine < 0) {
    cosine = -cosine;
    for (double& c : b) c = -c;
  }
  if (a == b) return a;
  if (cosine > 1 - 1e-9) return unit(lerp(a, b, s));  // the sine of smaller angles has too few digits
  const double angle = std::acos(cosine), sine = std::sin(angle);
  const double wa = std::sin((1 - s) * angle) / sine, wb = std::sin(s * angle) / sine;
  Value v;
  for (std::size_t c = 0; c < 4; ++c) v[c] = wa * a[c] + wb * b[c];
  return unit(v);
}

/// Cubic Hermite spline of glTF appendix C. The form v0 + (v1 - v0) (...) + ... gives exactly v0 if v0 = v1 and the
/// tangents are zero.
void spline(const AnimationTrack& track, std::size_t key, double s, double dt_s, std::span<double> out) {
  const std::size_t n = track.components;
  const double* v0 = &track.values[(3 * key + 1) * n];
  const double *out0 = v0 + n, *in1 = v0 + 2 * n, *v1 = v0 + 3 * n;
  const double s2 = s * s, s3 = s2 * s;
  for (std::size_t c = 0; c < n; ++c)
    out[c] = v0[c] + (v1[c] - v0[c]) * (3 * s2 - 2 * s3) + dt_s * ((s3 - 2 * s2 + s) * out0[c] + (s3 - s2) * in1[c]);
}

void set_rotation(std::span<double> out, const Value& q) { std::copy(q.begin(), q.end(), out.begin()); }

bool same_time(double a, double b) { return float(a) == float(b); }

/// For each joint of the node's skin: true if a vertex of the mesh follows the joint.
std::vector<std::uint8_t> joints_used(const Scene& scene, const Node& node) {
  std::vector<std::uint8_t> used(scene.skins[std::size_t(node.skin)].joints.size(), 0);
  for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives)
    for (const Influence& influence : primitive.influences)
      if (influence.weight > 0) used[influence.joint] = 1;
  return used;
}

}  // namespace

void evaluate(const AnimationTrack& track, double time_s, std::span<double> out) {
  const std::vector<double>& times = track.times_s;
  const std::size_t n = track.components;
  const bool is_spline = track.interpolation == Interpolation::cubic_spline;
  const auto value = [&](std::size_t key) { return &track.values[(is_spline ? 3 * key + 1 : key) * n]; };
  const auto hold = [&](std::size_t key) { std::copy_n(value(key), n, out.begin()); };
  const std::size_t next = std::size_t(std::upper_bound(times.begin(), times.end(), time_s) - times.begin());
  if (next < times.size() && same_time(times[next], time_s)) return hold(next);
  if (next == 0) return hold(0);
  const std::size_t key = next - 1;
  if (next == times.size() || same_time(times[key], time_s) || track.interpolation == Interpolation::step)
    return hold(key);
  const double dt_s = times[next] - times[key], s = (time_s - times[key]) / dt_s;
  const double *a = value(key), *b = value(next);
  const bool rotation = track.path == Path::rotation;
  if (is_spline) {
    spline(track, key, s, dt_s, out);
    if (rotation) set_rotation(out, unit({out[0], out[1], out[2], out[3]}));
  } else if (rotation) {
    set_rotation(out, slerp({a[0], a[1], a[2], a[3]}, {b[0], b[1], b[2], b[3]}, s));
  } else {
    for (std::size_t c = 0; c < n; ++c) out[c] = a[c] + (b[c] - a[c]) * s;
  }
}

Value evaluate(const AnimationTrack& track, double time_s) {
  Value value{};
  evaluate(track, time_s, value);
  return value;
}

Animator::Animator(const Scene& scene) : scene_(&scene), tracks_(scene.nodes.size()), joint_used_(scene.nodes.size()) {
  for (const Animation& animation : scene.animations)
    for (const AnimationTrack& track : animation.tracks) {
      anything_animated_ = true;
      anything_hides_ |= track.path == Path::visible;
      (track.path <= Path::visible ? tracks_[std::size_t(track.target)] : property_tracks_).push_back(&track);
    }
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) anything_hides_ |= !scene.nodes[n].visible;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (scene.nodes[n].skin >= 0) joint_used_[n] = joints_used(scene, scene.nodes[n]);
}

Pose Animator::pose(std::size_t n, double time_s, const std::vector<Affine>& world_from_node) const {
  const Node& node = scene_->nodes[n];
  Pose pose{node.weights, {}};
  if (!pose.weights.empty())
    for (const AnimationTrack* track : tracks_[n])
      if (track->path == Path::weights) evaluate(*track, time_s, pose.weights);
  if (node.skin < 0) return pose;
  const Skin& skin = scene_->skins[std::size_t(node.skin)];
  pose.world_from_mesh.resize(skin.joints.size());
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    if (joint_used_[n][j])
      pose.world_from_mesh[j] = world_from_node[std::size_t(skin.joints[j])] * skin.joint_from_mesh[j];
  return pose;
}

Affine Animator::local(std::size_t n, double time_s) const {
  const Node& node = scene_->nodes[n];
  if (node.has_matrix) return node.parent_from_node;
  Vec3d translation = node.translation, scale = node.scale;
  std::array<double, 4> rotation = node.rotation;
  for (const AnimationTrack* track : tracks_[n]) {
    if (track->path == Path::weights || track->path == Path::visible) continue;
    const Value v = evaluate(*track, time_s);
    if (track->path == Path::rotation) rotation = v;
    else (track->path == Path::translation ? translation : scale) = {v[0], v[1], v[2]};
  }
  return affine_from_trs(translation, rotation, scale);
}

std::vector<std::uint8_t> Animator::seen(double time_s) const {
  std::vector<std::uint8_t> seen(scene_->nodes.size(), 1);
  if (!anything_hides_) return seen;
  for (std::size_t n = 0; n < seen.size(); ++n) {
    const Node& node = scene_->nodes[n];
    bool visible = node.visible;
    for (const AnimationTrack* track : tracks_[n])
      if (track->path == Path::visible) visible = evaluate(*track, time_s)[0] != 0;
    seen[n] = visible && (node.parent < 0 || seen[std::size_t(node.parent)]);
  }
  return seen;
}

std::vector<Affine> Animator::world_from_node(double time_s) const {
  std::vector<Affine> world(scene_->nodes.size());
  for (std::size_t n = 0; n < world.size(); ++n) {
    const int parent = scene_->nodes[n].parent;
    world[n] = parent < 0 ? local(n, time_s) : world[std::size_t(parent)] * local(n, time_s);
  }
  return world;
}

}  // namespace tempolux
