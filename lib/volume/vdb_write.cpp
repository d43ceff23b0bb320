#include "lib/volume/vdb_write.h"

#include <cstring>
#include <stdexcept>

#include "formats/error.h"
#include "lib/core/child_process.h"
#include "lib/volume/vdb_pipe.h"

namespace tempolux {

std::vector<unsigned char> vdb_file_of(const ColourGrid& grid) {
  const std::size_t count = std::size_t(grid.counts[0]) * std::size_t(grid.counts[1]) * std::size_t(grid.counts[2]);
  if (grid.values.size() != count) throw std::invalid_argument("vdb_file_of: another number of values than voxels");
  VdbWriteHead head;
  head.counts = grid.counts;
  head.name_size = grid.name.size();
  for (int a = 0; a < 3; ++a) {
    head.voxel[std::size_t(a)] = grid.voxel[a];
    head.first_centre[std::size_t(a)] = grid.lower[a] + 0.5 * grid.voxel[a];
  }
  std::vector<unsigned char> input(sizeof head + grid.name.size() + count * 12);
  std::memcpy(input.data(), &head, sizeof head);
  std::memcpy(input.data() + sizeof head, grid.name.data(), grid.name.size());
  unsigned char* to = input.data() + sizeof head + grid.name.size();
  for (const Rgb& value : grid.values) {
    const float rgb[3] = {value.r, value.g, value.b};
    std::memcpy(to, rgb, sizeof rgb);
    to += sizeof rgb;
  }
  ChildLimits limits;
  limits.memory_bytes = memory_that_fits((std::uint64_t(1) << 30) + 8 * std::uint64_t(input.size()));
  limits.output_bytes = (std::uint64_t(64) << 20) + 2 * std::uint64_t(input.size());
  ChildResult result = run_child(helper_program("tempolux-vdb", "writing OpenVDB"), {"write"}, input, limits);
  if (!result.trouble.empty()) throw ResourceError("writing OpenVDB: tempolux-vdb " + result.trouble);
  return std::move(result.output);
}

}  // namespace tempolux
