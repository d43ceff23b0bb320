// modules/guard.h -- restricts a child program to the system calls it needs, before it reads untrusted files.
#pragma once

#include <string>

namespace tempolux {

/// From this call on, the process may only read, write and seek in open files, allocate and free memory, and exit. Any
/// other system call ends the process at once with SIGSYS: opening a file or a socket, starting a thread or a program,
/// mapping executable memory. So a file that exploits an error in the library that reads it can do no more than produce
/// a wrong picture.
///
/// Call this after everything that libraries do at first use (number of processors, locales, plugins) and after the
/// input files were opened, but before their first byte is read. The restriction holds for all threads and cannot be
/// removed.
///
/// Returns "", or the reason why the guard cannot be set up, as the end of a sentence that begins with the program's
/// name. Builds with sanitizers and builds with TEMPOLUX_GUARD=OFF have no guard, because sanitizers' reports read
/// /proc and start threads.
std::string guard_process();

}  // namespace tempolux
