#include "tools/common/scene_input.h"

#include <algorithm>

#include "formats/error.h"
#include "lib/scene/camera_extras.h"
#include "lib/scene/centre_shutter.h"
#include "lib/scene/content_camera.h"
#include "lib/scene/gltf_load.h"
#include "lib/scene/light_units.h"
#include "lib/volume/medium.h"
#include "tools/common/cli.h"

namespace tempolux::tools {
namespace {

/// Nearest distance of what is sharp, and the widest opening: rays stay finite.
constexpr double kNearestFocus_m = 1e-6, kLeastFStop = 1e-3;

}  // namespace

SceneInput::SceneInput(Tool& tool, const std::string& path, unsigned needs) : tool_(tool) {
  const Common& common = tool.common();
  GltfOptions options;
  options.animation = common.animation;
  if (common.max_memory_bytes > 0) options.textures.max_bytes = common.max_memory_bytes;
  scene_ = load_gltf(path, options);
  add_environment();
  if (needs & light) require_lights(scene_);
  if (needs & a_camera && common.camera == "auto" && !scene_.has_camera())
    scene_.warnings.push_back(path + ": " + add_content_camera(scene_));
  if (needs & a_camera) {
    camera_node_ = scene_.camera_node(common.camera);
    set_lens();
  }
  // Stored light belongs to the camera's time, so tools that look through no camera read its shutter, too.
  CameraExtras without;
  const int camera = camera_node_ < 0 && scene_.has_camera() ? scene_.camera_node(common.camera) : camera_node_;
  set_shutter(camera < 0 ? without : scene_.nodes[std::size_t(camera)].camera_extras);
  for (const std::string& warning : scene_.warnings) tool.warn(warning);
  if (const std::string doubt = doubt_of_light_units(scene_);
      needs & light && common.light_units == "raw" && !doubt.empty())
    tool.warn(doubt);
  for (const std::string& file : scene_.files) tool.depends_on(file);
  time_.fps = common.fps;
  time_.segment_length = common.segment_length;
  time_.light_units = common.light_units;
  volumes_.emplace(tool, scene_);
  if (volumes_->last_frame() > 0) scene_.duration_s = std::max(scene_.duration_s, volumes_->last_frame() / time_.fps);
  tool.say(path + ": light units " + common.light_units + ": punctual lights " +
           (common.light_units == "spec" ? "divided by 683" : "unchanged, factor 1"));
}

SceneInput::~SceneInput() {
  if (!scene_.images) return;
  tool_.stats().count("textures", double(scene_.images->decoded_count()));
  tool_.stats().count("texture_bytes", double(scene_.images->decoded_bytes()));
}

void SceneInput::add_environment() {
  const Common& common = tool_.common();
  const EnvironmentOptions options{common.environment_strength, common.environment_rotation_deg};
  const std::string& value = common.environment;
  if (value.empty()) return;
  if (is_color(value)) {
    std::array<float, 3> color{};
    try {
      color = parse_color(value);
    } catch (const InputError& error) { throw InputError(std::string("--environment: ") + error.what()); }
    scene_.environment =
        std::make_shared<const Environment>(uniform_environment(Rgb(color[0], color[1], color[2]), options));
  } else {
    scene_.environment = std::make_shared<const Environment>(load_environment(value, options));
    scene_.files.push_back(value);
  }
  for (const std::string& warning : scene_.environment->warnings) scene_.warnings.push_back(warning);
  if (!scene_.environment->emits()) tool_.warn(scene_.environment->path + ": is black: it lights nothing");
}

/// Puts what the command line says of the lens in place of what the scene says.
void SceneInput::set_lens() {
  const LensOptions& lens = tool_.common().lens;
  CameraExtras& extras = scene_.nodes[std::size_t(camera_node_)].camera_extras;
  if (lens.f_stop || lens.radius_m) {
    extras.set(&Camera::f_stop, lens.f_stop.value_or(0));
    extras.set(&Camera::lens_radius_m, lens.radius_m.value_or(0));
  }
  if (lens.sensor_width_mm) {
    extras.set(&Camera::sensor_width_mm, *lens.sensor_width_mm);
    extras.set(&Camera::lens_mm, 0);
  }
  const Camera& camera = scene_.cameras[std::size_t(scene_.nodes[std::size_t(camera_node_)].camera)];
  if (camera.kind == Camera::Kind::orthographic && (lens.f_stop.value_or(0) > 0 || lens.radius_m.value_or(0) > 0))
    throw InputError("--f-stop, --lens-radius: the camera is orthographic and has no lens; leave them out");
  if (lens.focus.empty()) return;
  double metres = 0;
  if (CLI::detail::lexical_cast(lens.focus, metres)) {
    if (!(metres >= kNearestFocus_m))
      throw InputError("--focus " + lens.focus + ": must be a distance of at least 1e-6 m, or the name of a node");
    return extras.set(&Camera::focus_m, metres);
  }
  const auto named = std::ranges::find(scene_.nodes, lens.focus, &Node::name);
  if (named == scene_.nodes.end())
    throw InputError("--focus " + lens.focus + ": neither a distance in metres nor the name of a node of " +
                     scene_.path);
  extras.focus_node = int(named - scene_.nodes.begin());
}

/// The same for the shutter.
void SceneInput::set_shutter(CameraExtras& extras) {
  const LensOptions& lens = tool_.common().lens;
  if (lens.shutter_deg) extras.set(&Camera::shutter_frames, *lens.shutter_deg / 360);
  if (!lens.shutter_open.empty())
    set_shutter_position(extras, lens.shutter_open == "begin" ? Camera::Shutter::start : Camera::Shutter::centre);
  centre_shutter(scene_, extras, tool_.common().fps);
}

/// Throws InputError if the camera's lens is open, but it is not known what is sharp.
void SceneInput::check_lens(const SceneFrame& frame) const {
  if (camera_node_ < 0) return;
  const Node& node = scene_.nodes[std::size_t(camera_node_)];
  Camera camera = scene_.cameras[std::size_t(node.camera)];
  node.camera_extras.apply(frame.frame, camera);
  if (!camera.has_lens()) return;
  if (node.camera_extras.focus_node >= 0) camera.focus_m = frame.camera(camera_node_).camera.focus_m;
  const std::string place =
      scene_.path + ": camera \"" + tool_.common().camera + "\" at frame " + std::to_string(frame.frame) + ": ";
  if (!(camera.focus_m >= kNearestFocus_m))
    throw InputError(place +
                     "its lens is open, but no distance is sharp: give --focus METRES or NODE (make: FOCUS), "
                     "or --f-stop 0 (make: FSTOP) for a sharp picture");
  if (!(camera.lens_radius_m > 0) && camera.f_stop < kLeastFStop)
    throw InputError(place + "its f-stop is below 0.001; give --f-stop (make: FSTOP)");
}

/// Distant light enters through a sphere around all surfaces and media of the frame. So with distant light and media
/// each frame has its own bounds, whether it is made alone or in a range. With frozen majorants the majorants' box
/// replaces the media's boxes: photons of all frames of a segment then start from the same sphere.
void SceneInput::enter_segment(int frame, bool read_volumes) {
  const bool inside = segment_ && frame >= segment_->segment().first && frame <= segment_->segment().last;
  const bool adds_media = read_volumes && volumes_->any() && scene_.has_distant_light();
  if (inside && (!adds_media || bounds_of_ == frame)) return;
  Segment segment = segment_of(scene_, frame, time_);
  geometry_ = segment.world_bounds;
  bounds_of_.reset();
  if (adds_media) {
    const auto add = [&](const Box3d& box) {
      segment.world_bounds.add({box.lower + segment.origin, box.upper + segment.origin});
    };
    if (const auto media = volumes_->at(frame, segment.origin)) {
      const Box3& frozen = media->majorants().box();
      if (volumes_->frozen()) add({Vec3d(frozen.lower), Vec3d(frozen.upper)});
      else
        for (const Medium& medium : media->all()) add(medium.bounds());
    }
    bounds_of_ = frame;
  }
  segment_ = std::make_unique<SegmentScene>(scene_, segment, time_);
  emission_.reset();
}

SceneFrame SceneInput::at(int frame, bool asked) {
  const int nearest = frame_in_animation(scene_, frame, time_);
  if (nearest != frame && asked && !warned_range_) {
    tool_.warn(scene_.path + ": frame " + std::to_string(frame) + " is outside the animation; using frame " +
               std::to_string(nearest));
    warned_range_ = true;
  }
  frame = nearest;
  enter_segment(frame, asked);
  SceneFrame at = segment_->at(frame);
  check_lens(at);
  if (asked && volumes_->any()) {
    at.media = volumes_->at(frame, at.origin);
    volumes_->look_for(at, geometry_);
    at.hashes.media = at.media ? at.media->hash() : VolumeInput::hash({});
  }
  return at;
}

std::string SceneInput::media_hash(int frame) {
  enter_segment(frame, false);
  return VolumeInput::hash(volumes_->read(frame, segment_->segment().origin));
}

const EmissionTable& SceneInput::emission(int frame) {
  enter_segment(frame, true);
  if (!emission_) emission_ = build_emission_table(scene_, segment_->segment(), time_);
  return *emission_;
}

void check_identity(Tool& tool, const std::string& file, const formats::Identity& file_identity,
                    const SceneFrame& frame) {
  if (!file_identity.known()) {
    tool.warn(file + ": does not say which scene it was made for; used as it is");
    return;
  }
  const std::string stale = formats::stale_concerns(file_identity, identity_of(frame));
  if (stale.empty()) return;
  tool.refuse_stale(
      file + ": made for another state of the scene: " + stale + " differ at frame " + std::to_string(frame.frame),
      "make it again for this one");
}

}  // namespace tempolux::tools
