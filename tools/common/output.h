// tools/common/output.h -- outputs that are either complete under their final name or do not exist.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tempolux::tools {

/// An output under construction. The constructor creates a temporary file in the same folder (".NAME.tmp.HOST.PID"),
/// so that an unwritable place is reported before the work. commit() syncs the file and gives it its final name. An
/// output that is not committed is removed, also after an exception or a signal. Temporary files that a killed run
/// has left for the same target on this host are removed by the next run.
///
/// "-" is standard output; binary data is not written to a terminal. Devices and named pipes are written in place. If
/// `path` is a symbolic link, the file that it points to is replaced.
class Output {
 public:
  enum class Kind { binary, text };  ///< text may go to a terminal

  /// Throws InputError (exit 2) if `path` is empty, a folder, a terminal, already an output of this run, or an input
  /// (protect_input); ResourceError (exit 3) if the file cannot be created.
  explicit Output(const std::string& path, Kind kind = Kind::binary);
  ~Output();
  Output(Output&&) noexcept;
  Output& operator=(Output&&) noexcept;

  const std::string& path() const;            ///< final name as the user gave it
  const std::string& temporary_path() const;  ///< write here; "/dev/stdout" for "-"
  bool is_stdout() const;

  /// Writes bytes through a buffer of 1 MiB; throws ResourceError with the reason.
  void write(const void* data, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// write() as a function, for the writers in formats/; valid as long as the output stays in its place.
  std::function<void(const void* data, std::size_t size)> sink();
  std::uint64_t written() const;  ///< bytes passed to write() so far

  /// Makes all bytes so far readable at temporary_path(). Throws as write().
  void flush();

  /// Flush, fsync, close (checked), rename, fsync the folder. Throws ResourceError. Nothing may be written
  /// afterwards.
  void commit();
  /// commit() without the two fsyncs, which wait for the disk: for many small files that are checked later and made
  /// again if a power cut destroyed them.
  void commit_unsynced();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Declares that this run reads `path`: no output may replace it under any name (InputError, whichever of the two comes
/// first). Affects regular files only.
void protect_input(const std::string& path);
/// The name of this machine, with '_' for '/': HOST in names of temporary files.
std::string host_name();
/// Final names of the outputs committed so far, in order, without "-".
std::vector<std::string> committed_outputs();
/// `message` with every temporary name of this run replaced by the final name.
std::string with_final_names(std::string message);

}  // namespace tempolux::tools
