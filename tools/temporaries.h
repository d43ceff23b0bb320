// tools/temporaries.h -- temporary files that vanish when the process is interrupted.
#pragma once

#include <atomic>
#include <string>

namespace tempolux::tools {

/// Marks a path for removal by the signal handler; create before the file. Not for files of others.
class Temporary {
 public:
  explicit Temporary(const std::string& path);
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const char* path() const;
  /// Renamed or handed on: no longer removed.
  void release();
  /// Removes the file now.
  void remove();

  struct Entry;

 private:
  Entry* entry_;
};

/// From now on INT, TERM, HUP and XCPU remove all temporaries and end the process by that signal (the shell
/// sees 128 + n). A signal that was ignored at the start (nohup) stays ignored. PIPE and XFSZ are ignored,
/// so that a write fails with a reason instead.
void install_signal_handlers();

}  // namespace tempolux::tools
