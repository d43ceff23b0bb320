// lib/temporal/sample_shelf.h -- stores radiance samples in a file if they do not fit into memory.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "formats/radsamples/sample.h"

namespace tempolux {

/// Keeps the samples of records (12 bytes each, with anchors) in memory up to a limit and all others in a nameless
/// file, which vanishes when the process ends, however it ends. Threads may use different records at the same time.
class SampleShelf {
 public:
  /// Where the samples of one record are.
  struct Place {
    std::int64_t offset = in_memory;  ///< in the file, bytes
    bool counted = false;             ///< in memory, and counted against the limit
    bool on_disk() const { return offset >= 0; }
    static constexpr std::int64_t in_memory = -1;
  };

  /// `limit`: bytes of samples that may stay in memory. `folder`: for the file, which is created when it is first
  /// needed. The other functions throw ResourceError if the file cannot be created, written or read.
  SampleShelf(std::string folder, std::uint64_t limit);
  ~SampleShelf();
  SampleShelf(const SampleShelf&) = delete;
  SampleShelf& operator=(const SampleShelf&) = delete;

  /// Stores samples: they stay in memory, or are written to the file and cleared. A record keeps its place in the file.
  void put(Place& place, std::vector<formats::RadianceSample>& samples, std::vector<std::uint32_t>& anchors);
  /// Reads `count` samples back as they were put; does nothing if they are in memory.
  void fetch(std::size_t count, const Place& place, std::vector<formats::RadianceSample>& samples,
             std::vector<std::uint32_t>& anchors) const;
  /// Clears fetched samples that have not changed.
  void let_go(const Place& place, std::vector<formats::RadianceSample>& samples,
              std::vector<std::uint32_t>& anchors) const;
  /// Frees the place of a removed record for another one with as many samples.
  void give_up(std::size_t count, Place& place);

  std::uint64_t bytes_in_memory() const { return in_memory_; }
  std::uint64_t bytes_in_file() const { return end_; }

 private:
  std::int64_t free_place(std::size_t count);

  std::string folder_;
  std::uint64_t limit_;
  std::atomic<std::uint64_t> in_memory_ = 0;
  std::mutex mutex_;  ///< guards the members below
  std::int64_t end_ = 0;
  std::map<std::size_t, std::vector<std::int64_t>> free_;  ///< free places by number of samples
  int file_ = -1;
};

}  // namespace tempolux
