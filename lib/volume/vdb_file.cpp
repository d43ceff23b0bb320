#include "lib/volume/vdb_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "formats/error.h"
#include "lib/core/child_process.h"
#include "lib/core/module_folders.h"
#include "lib/volume/vdb_pipe.h"

namespace tempolux {
namespace {

constexpr std::uint64_t kMemory = 400u << 20;  ///< bytes; OpenVDB and its libraries take 150 MB of address space
/// Largest ratio of bytes in memory to bytes in the file: twice the ratio of constant blocks in zip.
constexpr std::uint64_t kExpansion = 64;
constexpr std::uint64_t kSlowest = 10u << 20;  ///< bytes per second that the process must read at least
constexpr std::size_t kMostTogether = 16;      ///< files that one process reads; its start then costs 3 ms per file
/// Bytes of the files that one process reads; they may need kExpansion times as many in memory.
constexpr std::uint64_t kMostAhead = 16u << 20;
/// Voxels. Within half of this distance from index 0, float32 resolves positions to 1/256 of a voxel.
constexpr std::int32_t kFarStep = 1 << 16;

std::uint64_t size_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw InputError(path + ": is not a file");
  return std::uint64_t(status.st_size);
}

/// Reads the process' output from its beginning.
class Printed {
 public:
  Printed(const std::string& path, const std::vector<unsigned char>& bytes) : path_(path), bytes_(bytes) {}
  void take(void* to, std::uint64_t size) {
    if (size > left()) throw InputError(path_ + ": tempolux-vdb gave less than it promised; is it of this version?");
    std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  std::uint64_t left() const { return bytes_.size() - at_; }

 private:
  const std::string& path_;
  const std::vector<unsigned char>& bytes_;
  std::uint64_t at_ = 0;
};

/// Renumbers voxels that are far from index 0, and shifts the transform accordingly: beyond 2^24, float32 does not
/// resolve positions between voxels. The shift is a multiple of kFarStep, so that it rarely changes while the smoke of
/// a sequence moves.
void renumber(std::vector<VoxelBlock>& blocks, Affine& world_from_index) {
  if (blocks.empty()) return;
  GridIndex low = blocks.front().origin;
  for (const VoxelBlock& block : blocks)
    for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], block.origin[a]);
  Vec3d moved{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t steps = (std::int64_t(low[a]) + kFarStep / 2) >> 16;  // rounded to nearest
    moved[int(a)] = double(steps * kFarStep);
    for (VoxelBlock& block : blocks)  // an index above 32 bits becomes the largest one, which VoxelGrid refuses
      block.origin[a] = std::int32_t(std::min<std::int64_t>(block.origin[a] - steps * kFarStep, INT32_MAX - 7));
  }
  world_from_index.translation = world_from_index.point(moved);
}

/// Parses the next volume of the output; after the last one nothing may follow.
VdbVolume parse(Printed& printed, const std::string& path, bool last) {
  VdbPipeHead head;
  printed.take(&head, sizeof head);
  if (head.magic != VdbPipeHead{}.magic)
    throw InputError(path + ": tempolux-vdb is of another version than this tool; install both together");
  VdbVolume volume;
  volume.grid.resize(std::min(head.name_size, printed.left()));
  printed.take(volume.grid.data(), volume.grid.size());
  volume.note.resize(std::min(head.note_size, printed.left()));
  printed.take(volume.note.data(), volume.note.size());
  for (std::size_t r = 0; r < 3; ++r) {
    const double* const row = head.world_from_index.data() + 4 * r;
    volume.world_from_index.row[r] = {row[0], row[1], row[2]};
    volume.world_from_index.translation[int(r)] = row[3];
  }
  const std::uint64_t room = printed.left() / sizeof(VoxelBlock);
  if (head.block_count > room || (last && printed.left() != head.block_count * sizeof(VoxelBlock)))
    throw InputError(path + ": tempolux-vdb gave another number of voxels than it promised");
  std::vector<VoxelBlock> blocks(head.block_count);
  if (!blocks.empty()) printed.take(blocks.data(), blocks.size() * sizeof(VoxelBlock));
  renumber(blocks, volume.world_from_index);
  volume.voxels = std::make_shared<const VoxelGrid>(blocks);
  return volume;
}

/// Runs tempolux-vdb for these files, which have `bytes` bytes together; the largest has `largest`.
ChildResult ask(std::span<const VdbName> names, std::uint64_t bytes, std::uint64_t largest, std::uint64_t max_memory) {
  std::string request;
  for (const VdbName& name : names) {
    if (name.path.find('\n') != std::string::npos || name.grid.find('\n') != std::string::npos)
      throw InputError("a name of a volume holds a line feed; rename it");
    request += name.path + '\n' + name.grid + '\n';
  }
  const std::string program = installed_file("tempolux-vdb", names[0].path + ": reading OpenVDB");
  ChildLimits limits;
  limits.memory_bytes = max_memory ? max_memory : memory_that_fits(kMemory + kExpansion * largest);
  limits.output_bytes = max_memory ? max_memory : memory_that_fits(kMemory + kExpansion * bytes);
  limits.processor_s = int(std::min<std::uint64_t>(1 + bytes / kSlowest, 100'000));
  return run_child(program, {}, {reinterpret_cast<const unsigned char*>(request.data()), request.size()}, limits);
}

}  // namespace

VdbVolume read_vdb(const std::string& path, const std::string& grid, std::uint64_t max_memory) {
  const std::uint64_t size = size_of(path);
  const VdbName name{path, grid};
  const ChildResult result = ask({&name, 1}, size, size, max_memory);
  if (!result.trouble.empty()) throw InputError(path + ": " + result.trouble);
  try {
    Printed printed(path, result.output);
    return parse(printed, path, true);
  } catch (const std::invalid_argument& error) { throw InputError(path + ": " + error.what()); }
}

VdbVolume VdbSeries::read(const VdbName& name, std::uint64_t max_memory) {
  const auto at = std::size_t(std::ranges::find(names_, name) - names_.begin());
  if (at == names_.size()) return read_vdb(name.path, name.grid, max_memory);
  if (!ahead_[at]) read_together(at, max_memory);
  if (!ahead_[at]) return read_vdb(name.path, name.grid, max_memory);
  return *std::exchange(ahead_[at], std::nullopt);
}

/// Fills ahead_ from `first` on with as many volumes as one process may read; with none if a file fails.
void VdbSeries::read_together(std::size_t first, std::uint64_t max_memory) {
  std::uint64_t bytes = 0, largest = 0;
  std::size_t last = first;
  for (struct stat status{}; last < names_.size() && last - first < kMostTogether && !ahead_[last]; ++last) {
    if (::stat(names_[last].path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) break;
    if (bytes + std::uint64_t(status.st_size) > kMostAhead) break;
    bytes += std::uint64_t(status.st_size);
    largest = std::max(largest, std::uint64_t(status.st_size));
  }
  if (last - first < 2) return;
  const ChildResult result = ask(std::span(names_).subspan(first, last - first), bytes, largest, max_memory);
  if (!result.trouble.empty()) return;
  try {
    Printed printed(names_[first].path, result.output);
    std::vector<VdbVolume> volumes;
    for (std::size_t i = first; i < last; ++i) volumes.push_back(parse(printed, names_[i].path, i + 1 == last));
    std::ranges::move(volumes, ahead_.begin() + std::ptrdiff_t(first));
  } catch (const InputError&) {
  } catch (const std::invalid_argument&) {}
}

}  // namespace tempolux
