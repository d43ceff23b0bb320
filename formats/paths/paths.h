// formats/paths/paths.h -- read and write .paths files, version 1.
//
// paths.md is the definition of the format. If this code and that text disagree, the text is right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/error.h"
#include "formats/identity.h"

namespace tempolux::formats {

/// A photon path of a static map, and when in its segment something that moves can touch it.
struct TouchedPath {
  std::uint64_t path = 0;       ///< number of the path: its group is path mod N_g
  std::uint64_t intervals = 0;  ///< bit i: in interval i of the segment; not 0

  bool operator==(const TouchedPath&) const = default;
};
static_assert(sizeof(TouchedPath) == 16);

/// What the header says.
struct PathsHeader {
  std::string history;                            ///< one line per tool, each ending in LF
  Identity identity;                              ///< of what stands in the segment, and its frames
  std::array<double, 3> origin{};                 ///< m, world space
  std::uint32_t group_count = 1;                  ///< N_g of the map
  std::uint64_t emitted_count = 0;                ///< paths of the map
  std::uint64_t seed = 0;                         ///< of the map's random numbers
  std::string kinds = "direct,caustic,indirect";  ///< kinds of photons in the map
  std::vector<std::string> movers;                ///< by interval, 1 to 64: hash of what moves in its frames
};
inline constexpr std::size_t kMostIntervals = 64;

/// The interval that holds `frame`: floor((frame - first) n / (last - first + 1)) of n intervals. The frame must lie in
/// first .. last.
std::size_t interval_of(int frame, int first, int last, std::size_t interval_count);

/// Writes one .paths stream front to back; never seeks, so a pipe will do. A mistake of the caller is
/// std::invalid_argument: nothing that a reader would refuse is written.
class PathsWriter {
 public:
  /// `sink` is called with pieces of the file, in order; it throws if it cannot write.
  PathsWriter(std::function<void(const void*, std::size_t)> sink, const PathsHeader& header);
  ~PathsWriter();
  /// Paths in the order of the map: groups ascending, in a group ascending.
  void write(std::span<const TouchedPath> paths);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct PathsFile {
  PathsHeader header;
  std::vector<TouchedPath> paths;
};

/// Reads and checks a file; "-" is standard input. Every truncation, flipped bit and value out of range is an
/// InputError "FILE: byte OFFSET: REASON; REMEDY". Memory: 16 bytes per path and one block.
PathsFile load_paths(const std::string& path);

/// Hash of the data without header and history (paths.md, section 5).
std::string digest_of(const PathsFile& file);

}  // namespace tempolux::formats
