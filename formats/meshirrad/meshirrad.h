// formats/meshirrad/meshirrad.h -- reads and writes .meshirrad files, version 1.
//
// meshirrad.md defines the format. If this code disagrees with that page, the page is right.
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

/// One side of a small triangle of a surface, and the light that arrives there. 80 bytes, the same in memory and on
/// disk.
struct MeshElement {
  std::uint32_t surface = 0, triangle = 0;  ///< numbers in the scene at the frame
  std::uint32_t cell = 0;                   ///< number of the cell in its triangle, below cuts^2
  std::uint16_t cuts = 1;                   ///< pieces into which each edge of the triangle is cut
  std::uint16_t side = 0;                   ///< 0: front, 1: back
  std::array<float, 3> position{};          ///< m, the centre; world space minus the header's origin
  std::array<std::uint16_t, 2> normal{};    ///< octahedral, normal of this side
  float area = 0;                           ///< m^2
  std::uint32_t photons = 0;                ///< number of photons that arrived
  std::array<std::int64_t, 3> sums{};       ///< flux of the photons, R, G, B, in multiples of the header's unit
  /// W/m^2, filtered, >= 0. In a file of counts [0] is the sum of squares, see squares()
  std::array<float, 3> irradiance{};
  std::uint16_t object = 0xffff;
  /// in a file of windows: number of frames before and after this one from which photons come
  std::uint8_t before = 0, after = 0;

  /// In a file of counts: sum over the photons of their squared luminance flux, in unit^2.
  double squares() const { return double(irradiance[0]); }

  bool operator==(const MeshElement&) const = default;
};
static_assert(sizeof(MeshElement) == 80);

/// Largest number of pieces of an edge.
inline constexpr std::uint32_t kMostCuts = 1024;

/// A place in a triangle whose edges are cut into n pieces. `row`: the row of equal v; `column`: the upright cell in
/// this row; `tip`: true for the inverted cell that follows the upright one. x, y: n times the barycentric
/// coordinates, minus column and row.
struct MeshPlace {
  std::uint32_t column = 0, row = 0;
  bool tip = false;
  float x = 0, y = 0;
};
MeshPlace mesh_place(std::uint32_t n, float u, float v);
/// The cell that holds the barycentric coordinates u, v (of corners 1 and 2), in a triangle whose edges are cut into
/// n pieces.
std::uint32_t mesh_cell(std::uint32_t n, float u, float v);
/// Barycentric coordinates u, v of the centre of a cell.
std::array<float, 2> mesh_cell_centre(std::uint32_t n, std::uint32_t cell);

/// The content of a file's elements.
enum class MeshHolds : std::uint8_t {
  frame,    ///< irradiance from the photons of one frame
  counts,   ///< photons of one frame, counted for windows: sums of squares take the place of irradiance
  windows,  ///< irradiance from the photons of several frames; each element has its own window
};

struct MeshirradHeader {
  std::string history;
  Identity identity;
  std::array<double, 3> origin{};  ///< m, world space
  double cell = 1;                 ///< m, > 0: longest edge of an element
  double unit = 1;                 ///< W, > 0: flux of the value 1 in MeshElement::sums
  std::string kinds = "indirect";  ///< kinds of the photons
  MeshHolds holds = MeshHolds::frame;
  bool jump = false;  ///< in a file of counts: true if light jumps between the frame before and this one
  /// the filter that smoothed irradiance: none; or box, gaussian or bilateral, and its width in m
  std::string filter = "none";
};

struct MeshirradFile {
  MeshirradHeader header;
  /// ascending by surface, triangle, side, cell; each side has all of its cells or none
  std::vector<MeshElement> elements;
};

/// Writes a file front to back, without seeking. Throws std::invalid_argument for a value out of the format's range,
/// so every written file is one that readers accept.
void write_meshirrad(const std::function<void(const void*, std::size_t)>& sink, const MeshirradFile& file);

/// Reads and checks a file; "-" is standard input. Every truncation, flipped bit and value out of range is an
/// InputError "FILE: byte OFFSET: REASON; REMEDY". Memory: 80 bytes per element and one block.
MeshirradFile load_meshirrad(const std::string& path);

/// Hash of the data without header and history (meshirrad.md, section 6).
std::string digest_of(const MeshirradFile& file);

}  // namespace tempolux::formats
