// lib/plan/inputs.h -- the user's files that a plan was made from, and whether they have changed.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tempolux {

/// State of an input file or folder. The content of a folder is the list of the names in it.
struct InputStamp {
  std::uint64_t size = 0, inode = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;  ///< of the content and of the inode
  std::string hash;                              ///< of the content

  /// True if the file system reports no change. Times must be equal, so a copy with an older time counts as a change,
  /// and the clocks of other machines do not matter.
  bool same_stat(const InputStamp& other) const;
};

/// Stamps by path. A file whose size, times or inode differ from its stamp is read and hashed.
class Inputs {
 public:
  /// Reads the stamps of an earlier run; empty if the file is missing or invalid.
  explicit Inputs(const std::string& file);

  /// True if the earlier run had this wish and no input has changed since.
  bool unchanged(const std::string& wish);
  /// Hash of a file's content, or of the names in a folder; "" if it does not exist.
  std::string hash_of(const std::string& path);
  /// Hash of the names and contents of all inputs that this run has used.
  std::string contents() const;
  /// The stamps of all inputs that this run has used, as the text of a file that the constructor reads.
  std::string text(const std::string& wish) const;

 private:
  std::string wish_;
  std::map<std::string, InputStamp> known_, used_;
};

}  // namespace tempolux
