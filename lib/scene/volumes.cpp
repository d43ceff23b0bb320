#include "lib/scene/volumes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "formats/error.h"
#include "lib/core/box_corners.h"
#include "lib/core/json.h"
#include "lib/scene/place_surfaces.h"
#include "lib/volume/vdb_file.h"

namespace tempolux {
namespace {

using Json = nlohmann::json;

constexpr double kSmallest = 1e-12;  ///< least side of a medium's box, m: the inverse of a cell must fit into float32

/// From axes with +z up to glTF's.
constexpr Affine kYUp{{Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{0, -1, 0}}, Vec3d{}};

/// Reads and checks the values of one node's extras.
class Extras {
 public:
  Extras(const Json& object, std::string place) : object_(object), place_(std::move(place)) {}

  const Json* find(const char* key) const {
    const auto found = object_.find(key);
    return found == object_.end() || found->is_null() ? nullptr : &*found;
  }
  [[noreturn]] void fail(const char* key, const std::string& wanted) const {
    throw InputError(place_ + ": extras." + key + ": must be " + wanted);
  }
  float number(const Json& value, const char* key, double least, double most, const std::string& wanted) const {
    if (!value.is_number()) fail(key, wanted);
    const double v = value.get<double>();
    if (!(v >= least && v <= most)) fail(key, wanted);
    return float(v);
  }
  float number(const char* key, float otherwise, double least, double most, const std::string& wanted) const {
    const Json* value = find(key);
    return value ? number(*value, key, least, most, wanted) : otherwise;
  }
  std::string text(const char* key) const {
    const Json* value = find(key);
    if (!value) return {};
    if (!value->is_string()) fail(key, "a text");
    return value->get<std::string>();
  }
  Rgb colour(const char* key, Rgb otherwise) const {
    const std::string wanted = "three numbers from 0 to 1, or one";
    const Json* value = find(key);
    if (!value) return otherwise;
    if (!value->is_array()) return Rgb(number(*value, key, 0, 1, wanted));
    if (value->size() != 3) fail(key, wanted);
    return {number((*value)[0], key, 0, 1, wanted), number((*value)[1], key, 0, 1, wanted),
            number((*value)[2], key, 0, 1, wanted)};
  }
  std::optional<std::pair<int, int>> range(const char* first, const char* last) const {
    const Json *a = find(first), *b = find(last);
    if (!a && !b) return std::nullopt;
    const std::string wanted = "a whole number, together with its companion, first <= last";
    for (const auto& [value, key] : {std::pair{a, first}, std::pair{b, last}})
      if (!value || !value->is_number_integer() || std::abs(value->get<double>()) > 1e9) fail(key, wanted);
    if (a->get<int>() > b->get<int>()) fail(first, wanted);
    return std::pair{a->get<int>(), b->get<int>()};
  }

 private:
  const Json& object_;
  std::string place_;
};

bool leaves_folder(const std::filesystem::path& name) {
  if (name.is_absolute()) return true;
  for (const auto& part : name)
    if (part == "..") return true;
  return false;
}

}  // namespace

std::vector<VolumeSource> volumes_of(const Scene& scene) {
  std::vector<VolumeSource> sources;
  for (const Node& node : scene.nodes) {
    if (node.never_seen || node.extras.empty() || node.extras.find("vdb_pattern") == std::string::npos) continue;
    const Json object = Json::parse(node.extras, nullptr, false);
    if (!object.is_object() || !object.contains("vdb_pattern")) continue;
    const std::string place = node_place(scene, std::size_t(&node - scene.nodes.data()));
    const Extras extras(object, place);
    const std::string pattern = extras.text("vdb_pattern");
    if (pattern.empty()) extras.fail("vdb_pattern", "a file name");
    if (leaves_folder(pattern))
      throw InputError(place +
                       ": extras.vdb_pattern: leaves the scene's folder; put the file there, or name it with --volume");
    VolumeSource source;
    source.place = place;
    source.pattern = (std::filesystem::path(scene.path).parent_path() / pattern).string();
    source.grid = extras.text("vdb_grid");
    source.frames = extras.range("vdb_first", "vdb_last");
    source.options.sigma_t = extras.number("sigma_t_scale", 1, 0, 1e30, "a number from 0 on");
    source.options.albedo = extras.colour("albedo", Rgb(1.0f));
    source.options.g = extras.number("anisotropy", 0, -0.9999, 0.9999, "a number from -0.9999 to 0.9999");
    sources.push_back(std::move(source));
  }
  return sources;
}

std::vector<Medium> read_media(std::span<const VolumeSource> sources, std::span<const std::string> files, Vec3d origin,
                               std::uint64_t max_memory, VdbSeries& series, std::vector<std::string>& notes) {
  std::vector<Medium> media;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const VdbVolume volume = series.read({files[i], sources[i].grid}, max_memory);
    if (!volume.note.empty()) notes.push_back(files[i] + ": " + volume.note);
    if (volume.voxels->empty()) continue;  // the sequence has not begun at this frame
    Affine scene_from_index = sources[i].z_up ? kYUp * volume.world_from_index : volume.world_from_index;
    scene_from_index.translation -= origin;
    try {
      media.emplace_back(volume.voxels, scene_from_index, sources[i].options);
    } catch (const std::invalid_argument& error) { throw InputError(files[i] + ": " + error.what()); }
    const Medium& medium = media.back();
    if (medium.bounds().empty()) {  // sigma_t is 0
      media.pop_back();
      continue;
    }
    if (!(max_component(max(abs(medium.bounds().lower), abs(medium.bounds().upper))) < kMaxCoordinate))
      throw InputError(files[i] + ": its voxels lie beyond 1e15 m");
    if (const Vec3d size = medium.bounds().upper - medium.bounds().lower;
        !(std::min({size.x, size.y, size.z}) > kSmallest))
      throw InputError(files[i] + ": all its voxels lie within 1e-12 m; its transform is in another unit than metres?");
    if (!std::isfinite(medium.grid().largest() * medium.options().sigma_t))
      throw InputError(files[i] + ": its extinction is beyond what numbers can hold; lower " + sources[i].place +
                       "'s sigma_t");
  }
  return media;
}

namespace {

/// Least height of a volume in a picture, as a share of the picture's height.
constexpr double kLeastInPicture = 1.0 / 500;
/// Width of the widest picture, in heights.
constexpr double kWidest = 4;

/// Smallest distance between two boxes, m; 0 if they meet.
double gap_between(const Box3d& a, const Box3d& b) {
  Vec3d gap{};
  for (int axis = 0; axis < 3; ++axis)
    gap[axis] = std::max({0.0, a.lower[axis] - b.upper[axis], b.lower[axis] - a.upper[axis]});
  return length(gap);
}

/// How a camera may see a box.
struct Sight {
  bool in_picture = false;
  double height = 0;  ///< in heights of the picture, at most
};

/// Conservative: the box counts as in the picture unless all its corners lie beyond the same edge.
Sight sight_of(const Box3d& box, const PlacedCamera& placed) {
  const Camera& camera = placed.camera;
  const bool perspective = camera.kind == Camera::Kind::perspective;
  const double half = perspective ? std::tan(camera.yfov_rad / 2) : camera.ymag_m;
  std::array<int, 5> beyond{};
  double nearest = INFINITY;
  const Affine camera_from_scene = inverse(placed.scene_from_camera);
  for_corners(camera_from_scene, box, [&](Vec3d p) {
    const double depth = -p.z, edge = perspective ? half * depth : half;
    const auto [shift_x, shift_y] = camera.lens_shift;
    const double x = p.x - 2 * edge * shift_x, y = p.y - 2 * edge * shift_y;
    beyond[0] += depth <= 0;
    beyond[1] += x > kWidest * edge, beyond[2] += -x > kWidest * edge;
    beyond[3] += y > edge, beyond[4] += -y > edge;
    nearest = std::min(nearest, depth);
  });
  Sight sight;
  sight.in_picture = std::ranges::none_of(beyond, [](int corners) { return corners == 8; });
  const double edge = perspective ? half * nearest : half;
  sight.height = edge > 0 ? box.diagonal() / (2 * edge) : 1;
  return sight;
}

std::string text_of(const Box3d& box) {
  const Vec3d centre = box.centre(), size = box.upper - box.lower;
  char text[200];
  std::snprintf(text, sizeof text, "%.3g x %.3g x %.3g m around (%.3g, %.3g, %.3g)", size.x, size.y, size.z, centre.x,
                centre.y, centre.z);
  return text;
}

}  // namespace

std::string why_unseen(const Box3d& volume, const Box3d& geometry, std::span<const PlacedCamera> cameras,
                       Vec3d origin) {
  if (volume.empty() || geometry.empty()) return {};
  bool in_picture = cameras.empty();
  double height = cameras.empty() ? 1 : 0;
  for (const PlacedCamera& camera : cameras) {
    const Sight sight = sight_of({volume.lower - origin, volume.upper - origin}, camera);
    in_picture |= sight.in_picture;
    height = std::max(height, sight.height);
  }
  const double gap = gap_between(volume, geometry);
  const bool away = gap > geometry.diagonal() || (!in_picture && gap > volume.diagonal());
  if (!away && height >= kLeastInPicture) return {};
  return std::string(away ? "nothing sees it: its voxels lie outside of the scene" : "it is smaller than a pixel") +
         ": they fill " + text_of(volume) + ", the scene " + text_of(geometry) + "; is its transform in metres?";
}

}  // namespace tempolux
