// lib/core/child_process.h -- a helper program that does what must not be done in this process.
//
// Some libraries crash, hang or ask for gigabytes when a file is damaged or hostile. They are linked by a small program
// of their own instead. It is started once for each job, gets its input through a pipe, prints its result into another,
// and may do no more than its limits allow. If it dies, one line says how, and this process goes on.
//
// Nothing here costs anything until a helper is started. Starting one takes about a millisecond: posix_spawn copies no
// memory, however much this process has.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/core/module_folders.h"

namespace tempolux {

/// What a helper may use. Each has a value that is right for a small job; large ones say how much they need.
struct ChildLimits {
  std::uint64_t memory_bytes = 1ull << 30;  ///< its whole address space, libraries (some 20 MB) included: RLIMIT_AS
  std::uint64_t output_bytes = 1ull << 30;  ///< what it may print; more ends it
  int processor_s = 60;                     ///< time on a processor: RLIMIT_CPU
  int wall_s = 300;                         ///< from start to end; against helpers that wait for ever
};

/// What became of a helper.
struct ChildResult {
  std::vector<unsigned char> output;  ///< all that it printed, also when it died: its work so far
  /// Why the output is not whole, as the end of a sentence that begins with the helper's name: "died by signal 11
  /// (Segmentation fault)", "was ended by its guard ...", "took more than 60 s of processor time", "printed more than
  /// 1024 bytes", "ended with code 1", or the first line that it wrote to its standard error when it ended with another
  /// code than 0. Empty: it ended with code 0.
  std::string trouble;
};

/// The memory that a helper may have by default: `wanted`, but at most half of what this process may fill (the
/// machine's memory, or the limit of a container), as what the helper prints lies in this process at the same time. At
/// least 512 MiB, since RLIMIT_AS counts libraries too, which stay on disk. So a file that claims to need more than
/// there is ends its helper, not the machine.
std::uint64_t memory_that_fits(std::uint64_t wanted);

/// Path of a helper program that was installed or built with this one. Throws InputError "PURPOSE needs NAME, which was
/// not built or not installed (looked in ...); REMEDY".
std::string helper_program(const std::string& name, const std::string& purpose,
                           const std::string& remedy = "install all of tempolux together",
                           const std::vector<std::string>& folders = default_module_folders());

/// Runs a program to its end: writes `input` to its standard input, closes that, reads its standard output and standard
/// error, waits. The program gets `arguments` after its name, this process's environment, no other open files, and
/// default signals; it can write no file (RLIMIT_FSIZE is 0) and leaves no core. No child is left behind, whatever
/// happens: a helper that breaks a limit is killed. Should this process be killed, the helper meets the end of its
/// input, a closed output, or its limit of processor time.
///
/// The limits are set when it has started and before `input` is sent. So what may do harm, names of files included,
/// goes into the input, and a helper reads that before anything else.
///
/// May be called by several threads at once. Changes nothing of this process (directory, signals, limits). If the
/// program ends without reading all input, the rest is dropped: the output says whether it knew enough.
///
/// Throws ResourceError if no process can be started or the result does not fit memory. In builds with address or
/// thread sanitizers memory is not limited: these take terabytes of address space themselves. Helpers give up opening
/// files, sockets and programs by themselves (modules/guard.h); one that tries to is ended by SIGSYS.
ChildResult run_child(const std::string& program, const std::vector<std::string>& arguments,
                      std::span<const unsigned char> input, const ChildLimits& limits);

}  // namespace tempolux
