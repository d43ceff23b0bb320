// tools/common/temporaries.h -- temporary files that vanish when the process is interrupted.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <string>

namespace tempolux::tools {

/// Marks a path for removal by the signal handler. Create the mark before the file. Never mark a file of the user.
/// The path may be a folder whose content is marked afterwards: marks are removed in reverse order.
class Temporary {
 public:
  explicit Temporary(const std::string& path);
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const char* path() const;
  /// From now on the file is not removed, because it has been renamed or passed on.
  void release();
  /// Removes the file now.
  void remove();

  struct Entry;

 private:
  Entry* entry_;
};

/// From now on INT, TERM, HUP and XCPU remove all temporary files and end the process with that signal (the shell sees
/// 128 + n). A signal that was ignored at the start (nohup) stays ignored. PIPE and XFSZ are ignored, so that a write
/// fails with a reason instead.
void install_signal_handlers();

/// Removes temporary files and ends the process by PIPE, as a broken pipe does; returns if PIPE was ignored at the
/// start.
void end_by_broken_pipe();

}  // namespace tempolux::tools
