// modules/guard.h -- a helper program gives up what its work does not need, before it reads data of strangers.
#pragma once

#include <string>

namespace tempolux {

/// From here on this process may read, write and seek in what is open, take and return memory, and end. Any other
/// system call ends the process by SIGSYS at once: opening a file, a socket, starting a thread or a program, mapping
/// memory that can be run. So data that takes over the library that reads them can do no more than print a wrong
/// picture.
///
/// To be called after what libraries do at first use (numbers of processors, locales, plugins) and after opening the
/// files to read, before their first byte is looked at. Holds for all threads that this one starts, and for ever.
///
/// Returns "" or why the guard cannot be set up, as the end of a sentence that begins with the helper's name. In builds
/// with sanitizers there is no guard: their reports read /proc and start threads. With TEMPOLUX_GUARD=OFF there is none
/// either.
std::string guard_process();

}  // namespace tempolux
