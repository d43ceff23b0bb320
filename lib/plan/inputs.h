// lib/plan/inputs.h -- the files of others that a plan was made from, and whether they have changed since.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tempolux {

/// A foreign file or folder as it was seen. A folder's hash is that of the names in it.
struct InputStamp {
  std::uint64_t size = 0, inode = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;  ///< times of the content and of the inode
  std::string hash;                              ///< of the content

  /// Whether the file system says that nothing was written since. Times are compared for equality: a copy with an older
  /// time is a change, and clocks of other machines do not matter.
  bool same_stat(const InputStamp& other) const;
};

/// Stamps by path. Files whose size, times or inode differ from what is known are read and hashed.
class Inputs {
 public:
  /// Reads what an earlier run has written; empty if there is none or it cannot be read as such.
  explicit Inputs(const std::string& file);

  /// Whether an earlier run had this wish and every input has the content that it had then.
  bool unchanged(const std::string& wish);
  /// Hash of a file's content, or of the names in a folder; "" if it is not there.
  std::string hash_of(const std::string& path);
  /// Forgets inputs of the earlier run that this one has not asked for. What is to be written.
  std::string text(const std::string& wish) const;

 private:
  std::string wish_;
  std::map<std::string, InputStamp> known_, used_;
};

}  // namespace tempolux
