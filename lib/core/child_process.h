// lib/core/child_process.h -- runs a child program that does work too dangerous for this process.
//
// Some libraries crash, hang or allocate gigabytes on damaged or hostile files. Each is linked by a small program of
// its own. The program is started once per job, reads its input from a pipe, writes its result to another, and has
// limits of memory and time. If it dies, one line explains how, and this process continues.
//
// Starting a child takes about a millisecond: posix_spawn copies no memory, however much this process has.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tempolux {

/// Limits of a child. The defaults suit a small job; large jobs set their own.
struct ChildLimits {
  std::uint64_t memory_bytes = 1ull << 30;  ///< address space including libraries (about 20 MB): RLIMIT_AS
  std::uint64_t output_bytes = 1ull << 30;  ///< a child that prints more is killed
  std::uint64_t file_bytes = 0;             ///< largest file that it may write: RLIMIT_FSIZE
  int processor_s = 60;                     ///< RLIMIT_CPU
  int wall_s = 300;                         ///< from start to end; stops children that wait for ever
};

/// Result of a child process.
struct ChildResult {
  std::vector<unsigned char> output;  ///< all its output, also if it died later
  /// The reason why the output is incomplete, as the end of a sentence that begins with the program's name: "died by
  /// signal 11 (Segmentation fault)", "was ended by its guard ...", "took more than 60 s of processor time", "printed
  /// more than 1024 bytes", "ended with code 1", or the first line of its standard error if its exit code was not 0.
  /// Empty: it ended with code 0.
  std::string trouble;
  std::string words;  ///< the beginning of its standard error
};

/// Memory limit of a child that needs `wanted` bytes: at most half of machine_memory(), since this process also holds
/// the child's output, but at least 512 MiB, since RLIMIT_AS counts libraries that are not in memory. So a file that
/// claims to need too much memory ends the child, not the machine.
std::uint64_t memory_that_fits(std::uint64_t wanted);

/// Runs a program (installed_file) to its end: writes `input` to its standard input and closes it, reads its standard
/// output and standard error, and waits. The program gets `arguments` after its name, this process's environment, no
/// other open files, and default signals. It leaves no core. A child that exceeds a limit is killed; no child outlives
/// the call. If this process is killed, the child ends at the end of its input, at a closed output, or at its limit of
/// processor time.
///
/// The limits are set after the start and before `input` is sent. So everything dangerous, including names of files,
/// belongs into the input, which the child must read first.
///
/// Several threads may call at once. Directory, signals and limits of this process do not change. If the program ends
/// without reading all input, the remaining input is dropped: the output shows whether it read enough. Children forbid
/// themselves to open files, sockets and programs (modules/guard.h); a child that tries is killed by SIGSYS.
///
/// Throws ResourceError if no process can be started or the result does not fit into memory. Builds with address or
/// thread sanitizer do not limit memory, since the sanitizers reserve terabytes of address space.
ChildResult run_child(const std::string& program, const std::vector<std::string>& arguments,
                      std::span<const unsigned char> input, const ChildLimits& limits);

}  // namespace tempolux
