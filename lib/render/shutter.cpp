#include "lib/render/shutter.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lib/scene/segment_between.h"
#include "lib/scene/shutter_times.h"

namespace tempolux {
namespace {

/// States by which the length of ways is measured, and places of the picture and of each mover that are followed.
constexpr int kStates = 17, kColumns = 32, kRows = 18, kVertices = 64;
/// n^2 / m for an error of 1 / 1020 in an edge's coverage: 1020 / 8 (Shutter).
constexpr double kCoverage = 127.5;
/// Most vertices of movers over all moments: 24 bytes each, and as much for trees.
constexpr double kMostVertices = 3e7;

/// A place on a surface.
struct Followed {
  std::uint32_t surface;
  std::array<std::uint32_t, 3> corner;
  float u = 0, v = 0;
  Vec3 in(const SceneFrame& frame) const {
    const Surface& s = frame.surfaces[surface];
    return s.position(corner[0]) * (1 - u - v) + s.position(corner[1]) * u + s.position(corner[2]) * v;
  }
};

/// Places that are seen at a moment, and vertices of all movers.
std::vector<Followed> followed(const SceneFrame& frame, const CameraView& view, StaticTree& tree) {
  std::vector<Followed> places;
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s) {
    const auto& triangles = frame.surfaces[s].primitive->triangles;
    const std::size_t step = std::max<std::size_t>(1, triangles.size() / kVertices);
    for (std::size_t t = 0; t < triangles.size(); t += step) places.push_back({std::uint32_t(s), triangles[t]});
  }
  const Tracer tracer(frame, tree);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) {
      Hit hit;
      const Vec2 at{(float(x) + 0.5f) * float(view.width()) / kColumns,
                    (float(y) + 0.5f) * float(view.height()) / kRows};
      if (tracer.intersect(view.pinhole(at), hit))
        places.push_back({hit.surface, frame.surfaces[hit.surface].primitive->triangles[hit.triangle], hit.u, hit.v});
    }
  return places;
}

double vertices_of_movers(const SceneFrame& frame) {
  double count = 0;
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s)
    count += double(frame.surfaces[s].positions.size());
  return count;
}

/// The scene while a shutter is open.
class OpenTime {
 public:
  explicit OpenTime(const ShutterInput& input)
      : input_(input),
        frame_(input.frame.frame()),
        times_(input.view.camera().camera, frame_.frame, input.time),
        segment_(segment_of(input, times_)),
        stage_(input.scene, segment_, times_.options) {}

  /// At a share of the time, from 0 to 1.
  SceneFrame at(double share) const {
    SceneFrame state = stage_.at(times_.step(share));
    state.frame = frame_.frame;
    state.media = frame_.media;
    return state;
  }
  CameraView view_in(const SceneFrame& state) const {
    return CameraView(state, input_.camera_node, input_.view.width(), input_.view.height());
  }
  EmissionTable emission() const { return build_emission_table(input_.scene, segment_, times_.options); }
  /// True if a lamp moves, or a lamp or a material changes.
  bool lamps_change(const SceneFrame& middle) const {
    return std::ranges::any_of(segment_.changes, [](const PropertyChange& c) { return c.carries != "camera"; }) ||
           std::ranges::any_of(middle.lights, [&](const PlacedLight& light) { return segment_.moves(light.node); });
  }
  bool camera_moves() const;
  double longest_way(const std::vector<Followed>& places) const;

 private:
  static Segment segment_of(const ShutterInput& input, const ShutterTimes& times) {
    Segment segment = segment_between(input.scene, times.first_step(), times.last_step(), times.options);
    segment.origin = input.frame.frame().origin;
    return segment;
  }
  const ShutterInput& input_;
  const SceneFrame& frame_;
  ShutterTimes times_;
  Segment segment_;
  SegmentScene stage_;
};

bool OpenTime::camera_moves() const {
  const std::string first = pinhole_hash(at(0).camera(input_.camera_node));
  for (int s = 1; s < kStates; ++s)
    if (pinhole_hash(at(double(s) / (kStates - 1)).camera(input_.camera_node)) != first) return true;
  return false;
}

/// The longest way [pixels] that one of the places goes in the picture, or within a picture's size beside it.
double OpenTime::longest_way(const std::vector<Followed>& places) const {
  const int width = input_.view.width(), height = input_.view.height();
  const auto is_near = [&](const std::array<double, 2>& r) {
    return r[0] > -width && r[1] > -height && r[0] < 2 * width && r[1] < 2 * height;
  };
  const double most = 2.0 * (width + height);
  std::vector<std::optional<std::array<double, 2>>> last(places.size());
  std::vector<double> ways(places.size());
  for (int s = 0; s < kStates; ++s) {
    const SceneFrame state = at(double(s) / (kStates - 1));
    const CameraView view = view_in(state);
    for (std::size_t p = 0; p < places.size(); ++p) {
      const auto here = view.project(places[p].in(state));
      if (here && last[p] && (is_near(*here) || is_near(*last[p])))
        ways[p] += std::min(most, std::hypot((*here)[0] - (*last[p])[0], (*here)[1] - (*last[p])[1]));
      last[p] = here;
    }
  }
  return ways.empty() ? 0 : std::ranges::max(ways);
}

}  // namespace

/// All moments use the sky guide that was learned at the frame's time.
Moment::Moment(SceneFrame frame, const EmissionTable& emission, const ShutterInput& input, StaticTree& tree)
    : frame_(std::move(frame)),
      tracer_(frame_, tree),
      lights_(Lights(frame_, emission).guided(input.frame.lights.guide())),
      view_(frame_, input.camera_node, input.view.width(), input.view.height()),
      scene_{tracer_, lights_, input.frame.suns_apart, input.frame.camera_inside} {}

std::unique_ptr<const Shutter> Shutter::of(const ShutterInput& input) {
  if (!(input.view.camera().camera.shutter_frames > 0)) return nullptr;
  const OpenTime time(input);
  const SceneFrame middle = time.at(0.5);
  const bool lamps = time.lamps_change(middle);
  if (!lamps && middle.static_count == middle.surfaces.size() && !time.camera_moves()) return nullptr;
  std::unique_ptr<Shutter> shutter(new Shutter);
  shutter->motion_px_ = time.longest_way(followed(middle, time.view_in(middle), shutter->tree_));
  const double wanted = std::clamp(std::ceil(std::max(shutter->motion_px_, std::sqrt(kCoverage * shutter->motion_px_))),
                                   3.0, double(kMostMoments));
  const double most = std::max(9.0, kMostVertices / std::max(1.0, vertices_of_movers(middle)));
  const auto count = std::size_t(std::min(most, lamps ? double(kMomentsOfLamps) : wanted));
  const EmissionTable emission = time.emission();
  shutter->places_ = std::make_unique<StoredPlaces>(middle, input.frame.tracer);
  for (std::size_t i = 0; i < count; ++i) {
    auto moment = std::make_unique<Moment>(time.at((double(i) + 0.5) / double(count)), emission, input, shutter->tree_);
    moment->scene_.stored = shutter->places_.get();
    shutter->moments_.push_back(std::move(moment));
  }
  return shutter;
}

}  // namespace tempolux
