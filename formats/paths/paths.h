// formats/paths/paths.h -- reads and writes .paths files, version 1.
//
// paths.md defines the format. If this code disagrees with that page, the page is right.
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

/// A light path of a static map that a mover can touch, and the intervals of the segment in which it can.
struct TouchedPath {
  std::uint64_t path = 0;       ///< number of the light path; its group is path mod N_g
  std::uint64_t intervals = 0;  ///< bit i: a mover can touch the path in interval i; never 0

  bool operator==(const TouchedPath&) const = default;
};
static_assert(sizeof(TouchedPath) == 16);

/// The values of the header.
struct PathsHeader {
  std::string history;                            ///< one line per tool, each ending in LF
  Identity identity;                              ///< identity of the segment's static scene, and the segment's frames
  std::array<double, 3> origin{};                 ///< m, world space
  std::uint32_t group_count = 1;                  ///< N_g of the map
  std::uint64_t emitted_count = 0;                ///< number of light paths of the map
  std::uint64_t seed = 0;                         ///< seed of the map's random numbers
  std::string kinds = "direct,caustic,indirect";  ///< kinds of photons in the map
  std::vector<std::string> movers;                ///< by interval, 1 to 64: hash of the movers in its frames
};
inline constexpr std::size_t kMostIntervals = 64;

/// The interval that holds `frame`, which lies in first .. last:
///     floor((frame - first) interval_count / (last - first + 1))
std::size_t interval_of(int frame, int first, int last, std::size_t interval_count);

/// Writes one .paths stream front to back, without seeking, so the output may be a pipe. Throws std::invalid_argument
/// for a value that readers would refuse.
class PathsWriter {
 public:
  /// `sink` receives the pieces of the file, in order. It throws if it cannot write.
  PathsWriter(std::function<void(const void*, std::size_t)> sink, const PathsHeader& header);
  ~PathsWriter();
  /// Appends paths in the order of the map: by group, and by number within a group.
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
