// lib/temporal/kept_files.cpp -- decides which samples a .radsamples file holds itself, and whether a file fits a
// frame.
#include "lib/temporal/kept_files.h"

#include <filesystem>

#include "formats/base_file.h"
#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/arrays.h"
#include "lib/temporal/temporal_gather.h"

namespace tempolux {
namespace {

bool same_segment(const formats::RadsamplesHeader& header, const SceneFrame& frame) {
  return header.segment[0] == frame.segment.first && header.segment[1] == frame.segment.last &&
         float(header.diagonal) == sample_unit(frame);
}

/// Hash of a record's cells, samples and anchors.
std::string hash_of(const KeptHemisphere& of) {
  Hasher hasher;
  hasher.add(of.record.rings);
  hasher.add(of.record.sectors);
  hasher.add_array(std::span(of.samples));
  hasher.add_array(std::span(of.anchors));
  return hasher.hex();
}

/// What the records contradict in the scene, in words; "" if they fit the scene.
std::string fault_of(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points) {
  if (kept.point_light.size() != points.anchored)
    return "it has the light of " + std::to_string(kept.point_light.size()) + " points, of " +
           std::to_string(points.anchored);
  for (std::size_t i = 0; i < kept.records.size(); ++i) {
    const formats::RadsamplesRecord& r = kept.records[i].record;
    const bool there =
        r.surface < frame.surfaces.size() && r.triangle < frame.surfaces[r.surface].primitive->triangles.size();
    if (!there || (r.set == formats::SurfaceSet::dynamic_set) != (r.surface >= frame.static_count))
      return "record " + std::to_string(i) + " lies on triangle " + std::to_string(r.triangle) + " of surface " +
             std::to_string(r.surface) + ", which the scene does not have";
  }
  return "";
}

bool same_folder(const std::filesystem::path& a, const std::filesystem::path& b) {
  return a.parent_path() == b.parent_path() && a.filename() != b.filename();
}

}  // namespace

float sample_unit(const SceneFrame& frame) {
  const double unit = frame.segment.world_bounds.diagonal();
  return unit > 0 ? float(unit) : 1.0f;
}

FramePoints::FramePoints(DividedGatherPoints points, const SceneFrame& frame) : DividedGatherPoints(std::move(points)) {
  if (!high_shares.empty())
    high_hash = hash_hex({reinterpret_cast<const char*>(high_shares.data()), high_shares.size() * sizeof(float)});
  anchored = anchored_points(frame, whole.points);
  Hasher hasher;
  for (std::size_t i = 0; i < anchored; ++i) {
    hasher.add(whole.points[i].position);
    hasher.add(whole.points[i].normal);
  }
  places_hash = hasher.hex();
}

void KeptFiles::make_base(const std::string& path, const formats::RadsamplesHeader& header, const std::string& digest,
                          const std::vector<std::string>& hashes) {
  path_ = path;
  digest_ = digest;
  points_hash_ = header.points_hash;
  divided_ = !header.high_hash.empty();
  segment_ = header.segment;
  records_.clear();
  for (std::uint32_t i = 0; i < hashes.size(); ++i) records_.emplace(hashes[i], i);
}

/// Turns the file into an overlay on the base. If the file cannot be one, or less than half of its samples are the
/// base's, leaves it unchanged and returns false.
bool KeptFiles::lay_over_base(const std::string& path, const std::vector<std::string>& hashes,
                              formats::RadsamplesFile& file) const {
  if (path_.empty() || !same_folder(path, path_) || segment_ != file.header.segment ||
      points_hash_ != file.header.points_hash || divided_ == file.header.high_hash.empty())
    return false;
  std::vector<std::uint32_t> kept_from(file.records.size(), 0);
  std::size_t kept = 0, all = 0;
  for (std::size_t i = 0; i < kept_from.size(); ++i) {
    all += file.records[i].samples();
    if (const auto there = records_.find(hashes[i]); there != records_.end()) {
      kept_from[i] = there->second + 1;
      kept += file.records[i].samples();
    }
  }
  if (kept == 0 || 2 * kept < all) return false;
  file.kept_from = std::move(kept_from);
  file.header.base_name = std::filesystem::path(path_).filename();
  file.header.base_digest = digest_;
  return true;
}

void KeptFiles::write(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points,
                      const std::string& history, const std::string& path, const WriteBytes& sink) {
  formats::RadsamplesFile file = head_of(kept);
  file.header.history = history;
  file.header.identity = identity_of(frame);
  file.header.origin = array_of(frame.origin);
  file.header.diagonal = double(sample_unit(frame));
  file.header.segment = {frame.segment.first, frame.segment.last};
  file.header.anchors = true;
  file.header.points_hash = points.places_hash;
  std::vector<std::string> hashes;
  for (const KeptHemisphere& k : kept.records) hashes.push_back(hash_of(k));
  const bool whole = path.empty() || !lay_over_base(path, hashes, file);
  formats::RadsamplesWriter writer(sink, file);
  formats::RadsamplesDigest digest;
  for (const KeptHemisphere& k : kept.records) {
    writer.write(k.samples, k.anchors);
    if (whole) digest.add(k.samples, k.anchors);
  }
  writer.finish();
  if (whole && !path.empty()) make_base(path, file.header, digest.of(file), hashes);
}

formats::RadsamplesFile read_kept(const std::string& file, const SceneFrame& now, KeptHemispheres& kept) {
  formats::RadsamplesFile in = formats::read_radsamples(
      file, [&](const formats::RadsamplesFile& head, std::size_t record,
                std::span<const formats::RadianceSample> samples, std::span<const std::uint32_t> anchors) {
        take_samples(head, record, {samples, anchors}, vec_of(head.header.origin) - now.origin, kept);
      });
  take_head(in, kept);
  return in;
}

void check_kept(const std::string& file, const formats::RadsamplesHeader& header, const SceneFrame& now,
                const FramePoints& points, const KeptHemispheres& kept) {
  const std::string frame = std::to_string(now.frame), kept_frame = std::to_string(header.identity.first_frame);
  const bool same_numbers = header.segment[0] == now.segment.first && header.segment[1] == now.segment.last;
  if (!header.identity.known())
    throw InputError(file + ": does not say of which frame it is; give a file that gather-temporal wrote");
  if (!same_segment(header, now) && same_numbers)
    throw InputError(file + ": of a scene of another size, " + std::to_string(header.diagonal) +
                     " m across in this segment, not " + std::to_string(sample_unit(now)) +
                     " m: another one, or edited since; leave out --previous");
  if (!same_segment(header, now))
    throw InputError(file + ": of frame " + kept_frame + ", in another segment than frame " + frame +
                     "; nothing is kept from one segment to the next: leave out --previous");
  if (!header.anchors || header.points_hash != points.places_hash)
    throw InputError(file + ": its points lay elsewhere than those of frame " + frame +
                     "; make the points of both frames with the same options");
  if (header.high_hash.empty() != points.high_hash.empty())
    throw InputError(
        file + (points.high_hash.empty()
                    ? ": its samples hold the low part of the light alone; give --high, too, or leave out --previous"
                    : ": its samples hold all of the light, not the low part alone; leave out --high or --previous"));
  if (const std::string fault = fault_of(kept, now, points); !fault.empty())
    throw InputError(file + ": " + fault + "; leave out --previous");
}

}  // namespace tempolux
