#include "lib/plan/frame_pilot.h"

#include <algorithm>
#include <cmath>

#include "lib/pilot/hidden_light.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/pilot/places_seen.h"
#include "lib/pilot/seen_spheres.h"
#include "lib/render/still_pixels.h"

namespace tempolux {
namespace {

constexpr std::size_t kMostViews = 16;
/// Size of the pieces in which still_work() compares two moments, in pixels.
constexpr int kStillWidth = 8 * kPixelsOfPiece, kStillHeight = 4 * kPixelsOfPiece;

CameraView view_at(const SceneFrame& frame, const SceneSource& source, const Wish& wish) {
  PlacedCamera camera = frame.camera(source.camera_node);
  camera.camera.lens_radius_m = camera.camera.f_stop = 0;
  return CameraView(camera, frame.origin, wish.width, wish.height);
}

}  // namespace

std::vector<int> spread(const std::vector<int>& frames) {
  const std::size_t count = std::min(kMostViews, frames.size());
  std::vector<int> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(frames[i * frames.size() / count]);
  return some;
}

FramePilot::FramePilot(const Wish& wish, const SceneSource& source, int number, const std::string& kinds,
                       StaticTree& tree)
    : kinds_(kinds),
      wish_(wish),
      frame_(source.at(number, true)),
      table_(source.emission(frame_.frame)),
      view_(view_at(frame_, source, wish)),
      tracer_(frame_, tree),
      lights_(frame_, table_) {}

FrameWays FramePilot::look(int places, const LightSharing& sharing,
                           const std::function<bool(const FrameWays&)>& enough) {
  const Lights& aimed_lights = aimed();
  const auto look_of = [&](const RoughFrame& rough) {
    FrameWays look;
    look.paths = rough.paths_of_light;
    const bool filtered = wish_.filter != 0;
    const Order order{.pixels = double(wish_.width) * wish_.height,
                      .photons = look.paths,
                      .filtered = filtered,
                      .most_photons = filtered ? std::uint64_t(kMostTimesPhotons) * wish_.photons : 0,
                      .pictures = sharing.pictures,
                      .records = sharing.records};
    look.ways = ways_to_light(rough, order, kinds_.find("caustic") != std::string::npos);
    return look;
  };
  RoughOptions options{kinds_, wish_.pixel_error, wish_.photons, spheres_, 0, places};
  options.without_extent = without_extent_ ? &*without_extent_ : nullptr;
  options.least_hidden = sharing.least_hidden;
  options.enough = [&](const RoughFrame& rough) { return enough(look_of(rough)); };
  const Lights guided = guided_lights({tracer_, lights_, lights_.has_suns()}, view_);
  return look_of(rough_frame({tracer_, guided, lights_.has_suns()}, aimed_lights, view_, options));
}

PreviewPilot FramePilot::preview() { return pilot_preview({tracer_, aimed()}, kinds_, 0); }
double FramePilot::kernel() { return pilot_kernel({tracer_, aimed()}, kinds_, 0); }
SplitChoice FramePilot::split() { return choose_split(pilot_split({tracer_, lights_}, view_, 0)); }
MovingPilot FramePilot::moving() {
  const Lights& lights = aimed();  // a lamp that moves may get most of the light paths
  return pilot_moving({tracer_, lights}, *aimed_table_, view_, 0);
}

double FramePilot::still_work(const FramePilot& before, const Decisions& d) const {
  const CameraView pieces(view_.camera(), frame_.origin, std::min(kStillWidth, wish_.width),
                          std::min(kStillHeight, wish_.height));
  FrameOptions options;
  options.samples = wish_.first_samples;
  options.pixel_error = d.pixel_error;
  const RenderScene now{tracer_, lights_, lights_.has_suns()}, then{before.tracer_, before.lights_, lights_.has_suns()};
  return tempolux::still_work({now, view_, nullptr, 0}, {then, view_, nullptr, 0}, pieces, options, !d.records());
}

double FramePilot::new_share(const PlannedSegment& segment) const {
  const std::vector<int> pictures = spread(segment.views());
  std::vector<PlacedCamera> cameras;
  for (const int frame : pictures)
    if (const auto& view = segment.at(frame).view) cameras.push_back(*view);
  const double steps = double(segment.views().size() - 1) / double(std::max<std::size_t>(2, pictures.size()) - 1);
  return tempolux::new_share(tracer_, cameras, wish_.width, wish_.height) / std::max(1.0, steps);
}

/// Lights whose photons are aimed where the camera looks, as in photon-trace.
const Lights& FramePilot::aimed() {
  if (!aimed_) {
    EmissionTable& table = aimed_table_.emplace(table_);
    aim_at_seen(tracer_, view_, kinds_, table);
    spheres_ = table.aim;
    aimed_.emplace(frame_, table);
    if (may_hide_light(frame_)) without_extent_.emplace(frame_, table, Lights::Which::punctual);
  }
  return *aimed_;
}

}  // namespace tempolux
