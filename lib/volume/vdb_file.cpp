#include "lib/volume/vdb_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "formats/error.h"
#include "lib/core/child_process.h"
#include "lib/volume/vdb_pipe.h"

namespace tempolux {
namespace {

constexpr std::uint64_t kMemory = 400u << 20;        ///< OpenVDB and its libraries take 150 MB of address space
constexpr std::uint64_t kExpansion = 64;             ///< bytes in memory for one in the file: twice that of constant blocks in zip
constexpr std::uint64_t kSlowest = 10u << 20;        ///< bytes of the file read in a second, at least

std::uint64_t size_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw InputError(path + ": is not a file");
  return std::uint64_t(status.st_size);
}

/// Takes pieces off the front of what the helper printed.
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

VdbVolume parse(const std::string& path, const std::vector<unsigned char>& bytes) {
  Printed printed(path, bytes);
  VdbPipeHead head;
  printed.take(&head, sizeof head);
  if (head.magic != VdbPipeHead{}.magic)
    throw InputError(path + ": tempolux-vdb is of another version than this tool; install both together");
  VdbVolume volume;
  volume.grid.resize(std::min(head.name_size, printed.left()));
  printed.take(volume.grid.data(), volume.grid.size());
  for (std::size_t r = 0; r < 3; ++r) {
    const double* const row = head.world_from_index.data() + 4 * r;
    volume.world_from_index.row[r] = {row[0], row[1], row[2]};
    volume.world_from_index.translation[int(r)] = row[3];
  }
  if (head.block_count != printed.left() / sizeof(VoxelBlock) || printed.left() % sizeof(VoxelBlock) != 0)
    throw InputError(path + ": tempolux-vdb gave another number of voxels than it promised");
  std::vector<VoxelBlock> blocks(head.block_count);
  if (!blocks.empty()) printed.take(blocks.data(), blocks.size() * sizeof(VoxelBlock));
  volume.voxels = std::make_shared<const VoxelGrid>(blocks);
  return volume;
}

}  // namespace

VdbVolume read_vdb(const std::string& path, const std::string& grid, std::uint64_t max_memory) {
  if (path.find('\n') != std::string::npos || grid.find('\n') != std::string::npos)
    throw InputError("a name of a volume holds a line feed; rename it");
  const std::uint64_t size = size_of(path);
  const std::string program = helper_program("tempolux-vdb", path + ": reading OpenVDB");
  ChildLimits limits;
  limits.memory_bytes = max_memory ? max_memory : kMemory + kExpansion * size;
  limits.output_bytes = limits.memory_bytes;
  limits.processor_s = int(std::min<std::uint64_t>(1 + size / kSlowest, 100'000));
  const std::string request = path + '\n' + grid + '\n';
  const ChildResult result =
      run_child(program, {}, {reinterpret_cast<const unsigned char*>(request.data()), request.size()}, limits);
  if (!result.trouble.empty()) throw InputError(path + ": " + result.trouble);
  try {
    return parse(path, result.output);
  } catch (const std::invalid_argument& error) {
    throw InputError(path + ": " + error.what());
  }
}

}  // namespace tempolux
