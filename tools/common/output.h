// tools/common/output.h -- outputs that are either complete under their final name or not there at all.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace tempolux::tools {

/// An output under construction: a temporary name in the same folder (".NAME.tmp.HOST.PID"), created at
/// once so that an unwritable place is noticed before the work; commit() syncs and renames. Destroyed
/// uncommitted, by an exception or by a signal: removed. What a killed run left for the same target on
/// this host is removed by the next one.
///
/// "-" is standard output; binary data to a terminal is refused. Devices and named pipes are written in
/// place; of a symbolic link the file it points to is replaced.
class Output {
 public:
  enum class Kind { binary, text };  ///< text may go to a terminal

  /// Throws InputError (exit 2) if `path` is empty, a folder, a terminal, an output of this run already, a file that it
  /// reads (protect_input), or exists under no_clobber; ResourceError (exit 3) if the file cannot be created.
  explicit Output(const std::string& path, bool no_clobber = false, Kind kind = Kind::binary);
  ~Output();
  Output(Output&&) noexcept;
  Output& operator=(Output&&) noexcept;

  const std::string& path() const;            ///< final name as given
  const std::string& temporary_path() const;  ///< write here; "/dev/stdout" for "-"
  bool is_stdout() const;

  /// Writes bytes through a buffer of 1 MiB of its own; throws ResourceError with the reason.
  void write(const void* data, std::size_t size);
  std::uint64_t written() const;  ///< bytes, by write() so far
  std::ostream& stream();         ///< the same buffer as a std::ostream; errors throw as above

  /// What was written so far can be read at temporary_path(). Throws as write().
  void flush();

  /// Flush, fsync, close (checked), rename, fsync the folder. Throws ResourceError, and InputError under
  /// no_clobber if the name has been taken meanwhile. Nothing may be written after it.
  void commit();
  /// commit() without the two fsyncs, which cost a disk's turn each: for many small files that are compared with what
  /// they should hold and made again if a power cut took them.
  void commit_unsynced();
  /// commit(), unless a file of the same bytes is there already: that one stays untouched, its time stamp
  /// too, so that make has nothing to do. Returns true if the file was replaced.
  bool commit_if_changed();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Says that this run reads `path`: no output may take its place, under whatever name (InputError, whichever of the two
/// comes first). Only regular files are looked at.
void protect_input(const std::string& path);
/// HOST in the names of temporary files: this machine.
std::string temporary_host();
/// Final names of the outputs committed by this process so far, in order; "-" is not among them.
std::vector<std::string> committed_outputs();
/// `message` with every temporary name of this run replaced by the final name.
std::string with_final_names(std::string message);

}  // namespace tempolux::tools
