// tools/common/temporaries.h -- temporary files that vanish when the process is interrupted.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <string>

namespace tempolux::tools {

/// Marks a path for removal by the signal handler; create before the file. Not for files of others. May be a folder if
/// all that lies in it is marked after it: what is marked last goes first.
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

/// A process that this one has started and waits for: the signal handler ends it by TERM and waits until it has removed
/// its own files. 0: none any more. One at a time.
void end_together_with(pid_t child);

/// From now on INT, TERM, HUP and XCPU remove all temporaries and end the process by that signal (the shell
/// sees 128 + n). A signal that was ignored at the start (nohup) stays ignored. PIPE and XFSZ are ignored,
/// so that a write fails with a reason instead.
void install_signal_handlers();

/// Ends the process as a broken pipe does, by PIPE, temporaries removed; returns if PIPE was ignored at the start.
void end_by_broken_pipe();

}  // namespace tempolux::tools
