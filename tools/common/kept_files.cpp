#include "tools/common/kept_files.h"

#include <filesystem>

#include "formats/error.h"
#include "formats/hash.h"

namespace tempolux::tools {
namespace {

Vec3d vec_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

bool same_segment(const formats::RadsamplesHeader& header, const SceneFrame& frame) {
  return header.segment[0] == frame.segment.first && header.segment[1] == frame.segment.last &&
         float(header.diagonal) == sample_unit(frame);
}

}  // namespace

float sample_unit(const SceneFrame& frame) {
  const double unit = frame.segment.world_bounds.diagonal();
  return unit > 0 ? float(unit) : 1.0f;
}

FramePoints read_frame_points(Tool& tool, const std::string& file, const SceneFrame& frame) {
  FramePoints points{read_points(tool, file, frame), 0, {}};
  points.anchored = anchored_points(frame, points.read.points);
  Hasher hasher;
  for (std::size_t i = 0; i < points.anchored; ++i) {
    hasher.add(points.read.points[i].position);
    hasher.add(points.read.points[i].normal);
  }
  points.places_hash = hasher.hex();
  return points;
}

void write_kept(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points, const std::string& history, Output& output) {
  formats::RadsamplesFile file = to_file(kept);
  file.header.history = history;
  file.header.identity = identity_of(frame);
  file.header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};
  file.header.diagonal = double(sample_unit(frame));
  file.header.segment = {frame.segment.first, frame.segment.last};
  file.header.anchors = true;
  file.header.points_hash = points.places_hash;
  formats::write_radsamples([&](const void* data, std::size_t size) { output.write(data, size); }, file);
  output.commit();
}

KeptFrame read_kept(Tool& tool, SceneInput& input, const std::string& file, const SceneFrame& now, const FramePoints& points,
                    std::optional<SceneFrame>& before) {
  tool.depends_on(file, InputRole::replaceable);
  const formats::RadsamplesFile in = formats::load_radsamples(file);
  const formats::Identity& identity = in.header.identity;
  if (!identity.known()) throw InputError(file + ": does not say of which frame it is; give a file that gather-temporal wrote");
  const int frame = identity.first_frame;
  if (!same_segment(in.header, now))
    throw InputError(file + ": of frame " + std::to_string(frame) + ", in another segment than frame " + std::to_string(now.frame) +
                     "; nothing is kept from one segment to the next: leave out --previous");
  before.emplace(input.at(frame, false));
  check_identity(tool, file, identity, *before);
  if (!in.header.anchors || in.header.points_hash != points.places_hash)
    throw InputError(file + ": its points lay elsewhere than those of frame " + std::to_string(now.frame) +
                     "; make the points of both frames with the same options");
  return {from_file(in, vec_of(in.header.origin) - now.origin), in.header.history, frame};
}

std::optional<KeptHemispheres> find_kept(const std::string& file, const SceneFrame& frame, const FramePoints& points,
                                         const std::string& history) {
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  try {
    const formats::RadsamplesFile in = formats::load_radsamples(file);
    if (!same_segment(in.header, frame) || in.header.history != history || !(in.header.identity == identity_of(frame)) ||
        in.header.points_hash != points.places_hash)
      return std::nullopt;
    KeptHemispheres kept = from_file(in, vec_of(in.header.origin) - frame.origin);
    for (std::size_t i = 0; i < kept.point_light.size(); ++i)
      if (!(kept.point_light[i] == points.read.points[i].total())) return std::nullopt;
    return kept;
  } catch (const InputError&) {
    return std::nullopt;   // cut off or damaged: made again
  }
}

}  // namespace tempolux::tools
