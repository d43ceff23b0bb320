// formats/lightgrid/lightgrid.h -- read and write .lightgrid files, version 1.
//
// lightgrid.md is the definition of the format. If this code and that text disagree, the text is right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/error.h"
#include "formats/identity.h"

namespace tempolux::formats {

/// What light from far away reaches the surfaces of a cell of space that face alike.
struct LightgridCell {
  std::array<std::int32_t, 3> place{};  ///< floor((position - origin) / edge), each within kFarthest of 0
  std::uint32_t facing = 0;             ///< 0 to 5: +x, -x, +y, -y, +z, -z, where the normal is longest
  float sky = 0, suns = 0;              ///< probabilities, together at most 1; the rest: lights that are somewhere
  std::vector<float> end;               ///< of the parts of the sky, cumulative: ascending, the last is 1

  static constexpr std::int32_t kFarthest = (1 << 19) - 2;
  bool operator==(const LightgridCell&) const = default;
};

struct LightgridHeader {
  std::string history;
  Identity identity;
  std::array<double, 3> origin{};            ///< m, world space
  double edge = 1;                           ///< m, > 0: of a cell
  std::array<std::uint32_t, 2> parts{1, 1};  ///< of the sky, across and down: each 1 to 256
  std::size_t part_count() const { return std::size_t(parts[0]) * parts[1]; }
};

struct LightgridFile {
  LightgridHeader header;
  std::vector<LightgridCell> cells;  ///< ascending by place (x, y, z) and facing
};

/// Writes a file front to back; never seeks. A value out of the format's range is std::invalid_argument: nothing that a
/// reader would refuse is written.
void write_lightgrid(const std::function<void(const void*, std::size_t)>& sink, const LightgridFile& file);

/// Reads and checks a file; "-" is standard input. Every truncation, flipped bit and value out of range is an
/// InputError "FILE: byte OFFSET: REASON; REMEDY". Memory: that of the cells and one block.
LightgridFile load_lightgrid(const std::string& path);

/// Hash of the data without header and history (lightgrid.md, section 6).
std::string digest_of(const LightgridFile& file);

}  // namespace tempolux::formats
