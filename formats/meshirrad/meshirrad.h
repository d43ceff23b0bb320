// formats/meshirrad/meshirrad.h -- read and write .meshirrad files, version 1.
//
// meshirrad.md is the definition of the format. If this code and that text disagree, the text is right.
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

/// One side of a small triangle of a surface, and the light that arrived there. 80 bytes, in memory as on disk.
struct MeshElement {
  std::uint32_t surface = 0, triangle = 0;  ///< numbers in the scene at the frame
  std::uint32_t cell = 0;                   ///< of cuts^2 in the triangle
  std::uint16_t cuts = 1;                   ///< pieces into which each edge of the triangle is cut
  std::uint16_t side = 0;                   ///< 0: front, 1: back
  std::array<float, 3> position{};          ///< m, its centre; world space minus the header's origin
  std::array<std::uint16_t, 2> normal{};    ///< octahedral, of its side
  float area = 0;                           ///< m^2
  std::uint32_t photons = 0;                ///< that arrived
  std::array<std::int64_t, 3> sums{};       ///< their flux in units of the header, R, G, B
  std::array<float, 3> irradiance{};  ///< W/m^2, filtered; >= 0. Of counts: [0] is the sum of squares, see squares()
  std::uint16_t object = 0xffff;
  std::uint8_t before = 0, after = 0;  ///< of windows: frames before and after this one whose photons are in it

  /// Of counts: sum over the photons of the square of their flux's luminance, unit^2.
  double squares() const { return double(irradiance[0]); }

  bool operator==(const MeshElement&) const = default;
};
static_assert(sizeof(MeshElement) == 80);

/// Most pieces of an edge.
inline constexpr std::uint32_t kMostCuts = 1024;

/// A place in a triangle of n pieces an edge: in the row `row` of equal v the cell that stands at `column`, or the one
/// on its tip; x, y: the place in n times the barycentrics, less column and row.
struct MeshPlace {
  std::uint32_t column = 0, row = 0;
  bool tip = false;
  float x = 0, y = 0;
};
MeshPlace mesh_place(std::uint32_t n, float u, float v);
/// Cell of a triangle of n pieces an edge that holds the place of barycentrics u, v (of corners 1 and 2).
std::uint32_t mesh_cell(std::uint32_t n, float u, float v);
/// Barycentrics u, v of a cell's centre.
std::array<float, 2> mesh_cell_centre(std::uint32_t n, std::uint32_t cell);

/// What the elements of a file hold.
enum class MeshHolds : std::uint8_t {
  frame,    ///< light of the frame's photons
  counts,   ///< the frame's photons, counted for windows of frames: no irradiance, sums of squares in its place
  windows,  ///< light of the photons of several frames, each element's own
};

struct MeshirradHeader {
  std::string history;
  Identity identity;
  std::array<double, 3> origin{};  ///< m, world space
  double cell = 1;                 ///< m, > 0: longest edge of an element
  double unit = 1;                 ///< W, > 0: what 1 in MeshElement::sums is worth
  std::string kinds = "indirect";  ///< of the photons
  MeshHolds holds = MeshHolds::frame;
  bool jump = false;            ///< of counts: light, or what is in it, jumps between the frame before and this one
  std::string filter = "none";  ///< by which irradiance was smoothed: none; box, gaussian or bilateral and its width, m
};

struct MeshirradFile {
  MeshirradHeader header;
  std::vector<MeshElement> elements;  ///< ascending by surface, triangle, side, cell; of each side all cells or none
};

/// Writes a file front to back; never seeks. A value out of the format's range is std::invalid_argument: nothing that a
/// reader would refuse is written.
void write_meshirrad(const std::function<void(const void*, std::size_t)>& sink, const MeshirradFile& file);

/// Reads and checks a file; "-" is standard input. Every truncation, flipped bit and value out of range is an
/// InputError "FILE: byte OFFSET: REASON; REMEDY". Memory: 80 bytes per element and one block.
MeshirradFile load_meshirrad(const std::string& path);

/// Hash of the data without header and history (meshirrad.md, section 6).
std::string digest_of(const MeshirradFile& file);

}  // namespace tempolux::formats
