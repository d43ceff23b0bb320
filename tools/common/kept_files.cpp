#include "tools/common/kept_files.h"

#include <filesystem>

#include "formats/base_file.h"
#include "formats/error.h"
#include "formats/hash.h"

namespace tempolux::tools {
namespace {

Vec3d vec_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

bool same_segment(const formats::RadsamplesHeader& header, const SceneFrame& frame) {
  return header.segment[0] == frame.segment.first && header.segment[1] == frame.segment.last &&
         float(header.diagonal) == sample_unit(frame);
}

/// Of each record: hash of its cells, samples and anchors.
std::vector<std::string> hashes_of(const formats::RadsamplesFile& file) {
  std::vector<std::string> hashes;
  std::size_t first = 0;
  for (const formats::RadsamplesRecord& record : file.records) {
    Hasher hasher;
    hasher.add(record.rings);
    hasher.add(record.sectors);
    hasher.add_array(std::span(file.samples).subspan(first, record.samples()));
    if (file.header.anchors) hasher.add_array(std::span(file.anchors).subspan(first, record.samples()));
    hashes.push_back(hasher.hex());
    first += record.samples();
  }
  return hashes;
}

bool same_folder(const std::filesystem::path& a, const std::filesystem::path& b) {
  return a.parent_path() == b.parent_path() && a.filename() != b.filename();
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

void KeptFiles::make_base(const std::string& path, const formats::RadsamplesFile& file, const std::vector<std::string>& hashes) {
  path_ = path;
  digest_ = formats::digest_of(file);
  points_hash_ = file.header.points_hash;
  segment_ = file.header.segment;
  records_.clear();
  for (std::uint32_t i = 0; i < hashes.size(); ++i) records_.emplace(hashes[i], i);
}

/// False, and nothing done, if less than half of the samples are the base's.
bool KeptFiles::lay_over_base(const std::string& path, const std::vector<std::string>& hashes, formats::RadsamplesFile& file) const {
  if (path_.empty() || !same_folder(path, path_) || segment_ != file.header.segment || points_hash_ != file.header.points_hash) return false;
  std::vector<std::uint32_t> kept_from(file.records.size(), 0);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < kept_from.size(); ++i)
    if (const auto there = records_.find(hashes[i]); there != records_.end()) {
      kept_from[i] = there->second + 1;
      kept += file.records[i].samples();
    }
  if (kept == 0 || 2 * kept < file.samples.size()) return false;
  file.kept_from = std::move(kept_from);
  file.header.base_name = std::filesystem::path(path_).filename();
  file.header.base_digest = digest_;
  return true;
}

void KeptFiles::write(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points, const std::string& history, Output& output) {
  formats::RadsamplesFile file = to_file(kept);
  file.header.history = history;
  file.header.identity = identity_of(frame);
  file.header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};
  file.header.diagonal = double(sample_unit(frame));
  file.header.segment = {frame.segment.first, frame.segment.last};
  file.header.anchors = true;
  file.header.points_hash = points.places_hash;
  const std::vector<std::string> hashes = hashes_of(file);
  const bool whole = output.is_stdout() || !lay_over_base(output.path(), hashes, file);
  formats::write_radsamples([&](const void* data, std::size_t size) { output.write(data, size); }, file);
  output.commit();
  if (whole && !output.is_stdout()) make_base(output.path(), file, hashes);
}

KeptFrame read_kept(Tool& tool, SceneInput& input, const std::string& file, const SceneFrame& now, const FramePoints& points,
                    std::optional<SceneFrame>& before) {
  tool.depends_on(file, InputRole::replaceable);
  const formats::RadsamplesFile in = formats::load_radsamples(file);
  if (!in.header.base_name.empty()) tool.depends_on(formats::path_of_base(file, in.header.base_name));
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

std::optional<KeptHemispheres> KeptFiles::find(const std::string& file, const SceneFrame& frame, const FramePoints& points, const std::string& history) {
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  try {
    const formats::RadsamplesFile in = formats::load_radsamples(file);
    if (!same_segment(in.header, frame) || in.header.history != history || !(in.header.identity == identity_of(frame)) ||
        in.header.points_hash != points.places_hash)
      return std::nullopt;
    const bool whole = in.header.base_name.empty();
    if (!whole && (!same_folder(file, path_) || in.header.base_name != std::filesystem::path(path_).filename() || in.header.base_digest != digest_))
      return std::nullopt;
    KeptHemispheres kept = from_file(in, vec_of(in.header.origin) - frame.origin);
    for (std::size_t i = 0; i < kept.point_light.size(); ++i)
      if (!(kept.point_light[i] == points.read.points[i].total())) return std::nullopt;
    if (whole) make_base(file, in, hashes_of(in));
    return kept;
  } catch (const InputError&) {
    return std::nullopt;   // cut off or damaged: made again
  }
}

}  // namespace tempolux::tools
