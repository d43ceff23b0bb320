// lib/temporal/sample_shelf.h -- samples beyond what may stay in memory, in a file.
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

/// Keeps the samples of records (12 bytes each with their anchors) in memory up to a limit, the others in a file
/// without a name, gone when the process ends however it ends. Threads may use different records side by side.
class SampleShelf {
 public:
  /// Where the samples of a record are. Belongs to one record.
  struct Place {
    std::int64_t offset = in_memory;  ///< bytes, in the file
    bool counted = false;             ///< in memory, and counted
    bool on_disk() const { return offset >= 0; }
    static constexpr std::int64_t in_memory = -1;
  };

  /// `limit`: bytes of samples that may stay in memory. `folder`: of the file, which is made when it is needed first.
  /// ResourceError from any of the others if it cannot be made, written or read.
  SampleShelf(std::string folder, std::uint64_t limit);
  ~SampleShelf();
  SampleShelf(const SampleShelf&) = delete;
  SampleShelf& operator=(const SampleShelf&) = delete;

  /// Puts samples away: they stay, or go to the file and are cleared. A record keeps its place from then on.
  void put(Place& place, std::vector<formats::RadianceSample>& samples, std::vector<std::uint32_t>& anchors);
  /// Brings `count` samples back, as they were put; does nothing if they are in memory.
  void fetch(std::size_t count, const Place& place, std::vector<formats::RadianceSample>& samples,
             std::vector<std::uint32_t>& anchors) const;
  /// Clears what was fetched and has not changed.
  void let_go(const Place& place, std::vector<formats::RadianceSample>& samples,
              std::vector<std::uint32_t>& anchors) const;
  /// The record is no more: its place is free for another of as many samples.
  void give_up(std::size_t count, Place& place);

  std::uint64_t bytes_in_memory() const { return in_memory_; }
  std::uint64_t bytes_in_file() const { return end_; }

 private:
  std::int64_t free_place(std::size_t count);

  std::string folder_;
  std::uint64_t limit_;
  std::atomic<std::uint64_t> in_memory_ = 0;
  std::mutex mutex_;  ///< of what follows
  std::int64_t end_ = 0;
  std::map<std::size_t, std::vector<std::int64_t>> free_;  ///< places by number of samples
  int file_ = -1;
};

}  // namespace tempolux
