#include "tools/common/volume_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "formats/error.h"
#include "formats/hash.h"

namespace tempolux::tools {
namespace {

constexpr std::size_t kMostKept = std::size_t(1) << 30;  ///< bytes of voxels kept in memory for later frames

/// The value for volume i of n: its own, or the common one, or none.
template <class T>
const T* value_for(const std::vector<T>& values, std::size_t i, std::size_t n, const char* option) {
  if (values.empty()) return nullptr;
  if (values.size() != 1 && values.size() != n)
    throw InputError(std::string(option) + ": is given " + std::to_string(values.size()) + " times for " +
                     std::to_string(n) + " volumes; give it once, or once for each");
  return &values[values.size() == 1 ? 0 : i];
}

/// The file of a volume at a frame.
std::string file_of(const VolumeSource& source, int frame) {
  const int at = source.frames ? std::clamp(frame, source.frames->first, source.frames->second) : frame;
  return has_frame_pattern(source.pattern) ? frame_name(source.pattern, at) : source.pattern;
}

/// True if all volumes have the same file at both frames.
bool same_files(const std::vector<VolumeSource>& sources, int a, int b) {
  return a == b || std::ranges::all_of(
                       sources, [&](const VolumeSource& source) { return file_of(source, a) == file_of(source, b); });
}

std::vector<VolumeSource> sources_of(const VolumeOptions& options) {
  std::vector<VolumeSource> sources;
  const std::size_t n = options.files.size();
  for (std::size_t i = 0; i < n; ++i) {
    VolumeSource source;
    source.place = "--volume " + options.files[i];
    source.pattern = options.files[i];
    const std::size_t end = source.pattern.find(".vdb:");
    if (end != std::string::npos && !source.pattern.ends_with(".vdb")) {
      source.grid = source.pattern.substr(end + 5);
      source.pattern.resize(end + 4);
    }
    if (const auto* sigma = value_for(options.sigma_t, i, n, "--sigma-t")) source.options.sigma_t = *sigma;
    if (const auto* albedo = value_for(options.albedo, i, n, "--albedo"))
      source.options.albedo = Rgb((*albedo)[0], (*albedo)[1], (*albedo)[2]);
    if (const auto* g = value_for(options.phase_g, i, n, "--phase-g")) source.options.g = *g;
    if (max_component(source.options.albedo) > 1) throw InputError("--albedo: a share of light is at most 1");
    if (options.frames) source.frames = *options.frames;
    source.z_up = options.up == "z";
    sources.push_back(std::move(source));
  }
  return sources;
}

}  // namespace

VolumeInput::VolumeInput(Tool& tool, const Scene& scene) : tool_(tool) {
  const VolumeOptions& options = tool.common().volume;
  const bool none = options.files.size() == 1 && options.files.front() == "none";
  if (options.files.empty()) sources_ = volumes_of(scene);
  else if (!none) sources_ = sources_of(options);
  if ((options.files.empty() || none) && (!options.sigma_t.empty() || !options.albedo.empty() ||
                                          !options.phase_g.empty() || options.frames || options.up != "y"))
    throw InputError(
        "--volume-frames, --volume-up, --sigma-t, --albedo and --phase-g say what --volume FILE is; name one");
}

int VolumeInput::last_frame() const {
  int last = -1;
  for (const VolumeSource& source : sources_) {
    if (!source.frames) return -1;
    last = std::max(last, source.frames->second);
  }
  return last;
}

std::vector<Medium> VolumeInput::read(int frame, Vec3d origin) {
  for (const auto& [at, kept] : kept_)
    if (kept.origin == origin && same_files(sources_, at, frame)) return kept.media;
  std::vector<Medium> media = parse(frame, origin);
  std::size_t bytes = 0;
  for (const Medium& medium : media) bytes += medium.grid().byte_count();
  if (kept_bytes_ + bytes <= kMostKept && kept_.emplace(frame, Kept{origin, media}).second) kept_bytes_ += bytes;
  return media;
}

FrozenMajorants VolumeInput::freeze(int first, int last) {
  Box3d box;
  double finest = INFINITY;
  for (int frame = first; frame <= last; ++frame)
    for (const Medium& medium : read(frame, {})) {
      box.add(medium.bounds());
      finest = std::min(finest, medium.voxel_size());
    }
  FrozenMajorants frozen{first, last, {}};
  if (box.empty()) return frozen;
  frozen.grid = majorant_cells(box, finest);
  for (int frame = first; frame <= last; ++frame) raise_majorants(read(frame, {}), frozen.grid);
  return frozen;
}

const MajorantGrid* VolumeInput::majorants_for(int frame, Vec3d origin) {
  const std::string& file = tool_.common().volume.majorants;
  if (file.empty()) return nullptr;
  if (!majorants_) {
    majorants_ = load_majorants(file);
    tool_.depends_on(file);
  }
  if (frame < majorants_->first_frame || frame > majorants_->last_frame)
    throw InputError(file + ": holds for frames " + std::to_string(majorants_->first_frame) + " to " +
                     std::to_string(majorants_->last_frame) + ", not for " + std::to_string(frame) +
                     "; name that of its segment");
  scene_majorants_ = moved(majorants_->grid, origin);
  return &scene_majorants_;
}

std::vector<Medium> VolumeInput::parse(int frame, Vec3d origin) {
  std::vector<std::string> files;
  for (const VolumeSource& source : sources_) {
    files.push_back(file_of(source, frame));
    if (!source.frames && has_frame_pattern(source.pattern) && !std::filesystem::exists(files.back()))
      throw InputError(files.back() + ": cannot be opened: there is no such file; frame " + std::to_string(frame) +
                       " is read, as its segment or a filter's window holds it; name the "
                       "frames that have files, such as --volume-frames 0-47 (make: in VOLUME_OPTIONS)");
    tool_.depends_on(files.back());
  }
  if (!series_) {
    std::vector<VdbName> names;
    for (const int f : tool_.common().frames)
      for (const VolumeSource& source : sources_)
        if (const VdbName name{file_of(source, f), source.grid}; std::ranges::find(names, name) == names.end())
          names.push_back(name);
    series_.emplace(std::move(names));
  }
  for (const std::string& file : files)
    if (std::ranges::find(files_, file) == files_.end()) files_.push_back(file);
  std::vector<std::string> notes;
  std::vector<Medium> media = read_media(sources_, files, origin, tool_.common().max_memory_bytes, *series_, notes);
  for (const std::string& note : notes) warn_once(note.substr(note.find(": grid ")), note);
  return media;
}

void VolumeInput::warn_once(const std::string& kind, const std::string& warning) {
  if (warned_.insert(kind).second) tool_.warn(warning);
}

void VolumeInput::look_for(const SceneFrame& frame, const Box3d& geometry) {
  if (!frame.media) return;
  std::vector<PlacedCamera> cameras;
  for (std::size_t n = 0; n < frame.scene->nodes.size(); ++n) {
    if (frame.scene->nodes[n].camera < 0) continue;
    try {
      cameras.push_back(frame.camera(int(n)));
    } catch (const InputError&) { continue; }  // a camera without a direction
  }
  Box3d box;
  for (const Medium& medium : frame.media->all())
    box.add({medium.bounds().lower + frame.origin, medium.bounds().upper + frame.origin});
  if (const std::string why = why_unseen(box, geometry, cameras, frame.origin); !why.empty())
    warn_once("unseen", sources_.front().place + ": the smoke of frame " + std::to_string(frame.frame) + ": " + why);
}

std::string VolumeInput::hash(const std::vector<Medium>& media) {
  Hasher hasher;
  hasher.add("media 1");
  for (const Medium& medium : media) hasher.add(std::string_view(medium.hash()));
  return hasher.hex();
}

std::shared_ptr<const Media> VolumeInput::at(int frame, Vec3d origin) {
  if (!any()) return nullptr;
  if (last_ && last_->frame == frame && last_->origin == origin) return last_->media;
  std::vector<Medium> media = read(frame, origin);
  std::shared_ptr<const Media> made;
  if (const MajorantGrid* const majorants = majorants_for(frame, origin)) {
    try {
      if (!majorants->empty() || !media.empty()) made = std::make_shared<const Media>(std::move(media), *majorants);
    } catch (const std::invalid_argument& error) {
      throw InputError(tool_.common().volume.majorants + ": " + error.what() + " at frame " + std::to_string(frame) +
                       "; run scene-plan again");
    }
  } else if (!media.empty()) {
    made = std::make_shared<const Media>(std::move(media));
  }
  last_ = At{frame, origin, made};
  return made;
}

}  // namespace tempolux::tools
