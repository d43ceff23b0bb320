#include "modules/guard.h"

#include <cstring>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(TEMPOLUX_GUARD)
#define TEMPOLUX_NO_GUARD
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define TEMPOLUX_NO_GUARD
#endif
#endif

#ifdef TEMPOLUX_NO_GUARD

std::string tempolux::guard_process() { return ""; }

#else

#include <fcntl.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

namespace tempolux {
namespace {

/// System calls that are allowed with any arguments. All files are open already, and none of these calls opens another.
constexpr int kAllowed[] = {SCMP_SYS(read), SCMP_SYS(readv), SCMP_SYS(pread64), SCMP_SYS(write), SCMP_SYS(writev),
                            SCMP_SYS(lseek), SCMP_SYS(fstat), SCMP_SYS(close), SCMP_SYS(brk), SCMP_SYS(munmap),
                            SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(futex), SCMP_SYS(sched_yield),
                            SCMP_SYS(clock_gettime), SCMP_SYS(getrandom), SCMP_SYS(rt_sigprocmask),
                            SCMP_SYS(rt_sigaction),
                            SCMP_SYS(rt_sigreturn),  // abort() and signal handlers
                            SCMP_SYS(getpid), SCMP_SYS(gettid), SCMP_SYS(exit), SCMP_SYS(exit_group), SCMP_SYS(sysinfo),
                            // Qsort asks for the amount of memory, TBB for the number of processors.
                            SCMP_SYS(sched_getaffinity), SCMP_SYS(rseq),
                            SCMP_SYS(set_robust_list)};  // first calls of threads that were started before

using Filter = std::unique_ptr<void, decltype(&seccomp_release)>;

/// Adds the rules to the filter. Returns a negative error number of libseccomp, or 0.
int add_rules(scmp_filter_ctx filter) {
  int result = 0;
  const auto allow = [&](int call, auto... conditions) {
    if (result == 0)
      result = seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, unsigned(sizeof...(conditions)), conditions...);
  };
  for (const int call : kAllowed) allow(call);
  // Memory may be mapped, but not as executable.
  allow(SCMP_SYS(mmap), SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
  allow(SCMP_SYS(mprotect), SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
  // fstat of the C library is newfstatat with an empty name. The kernel filter cannot check that the name is empty.
  allow(SCMP_SYS(newfstatat), SCMP_A3(SCMP_CMP_EQ, AT_EMPTY_PATH));
  // The C library asks whether standard output is a terminal before it writes the first byte.
  allow(SCMP_SYS(ioctl), SCMP_A1(SCMP_CMP_EQ, TCGETS));
  // abort() sends a signal to its own process.
  allow(SCMP_SYS(tgkill), SCMP_A0(SCMP_CMP_EQ, scmp_datum_t(::getpid())));
  return result;
}

}  // namespace

std::string guard_process() {
  const Filter filter(seccomp_init(SCMP_ACT_KILL_PROCESS), seccomp_release);
  // Libraries have started threads when they were loaded: the filter must apply to these, too.
  int result = filter ? seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_TSYNC, 1) : -ENOMEM;
  if (result == 0) result = add_rules(filter.get());
  if (result == 0) result = seccomp_load(filter.get());
  if (result == 0) return "";
  return std::string("cannot give up system calls that it does not need (seccomp: ") + std::strerror(-result) +
         "); use a kernel that can, or build with -DTEMPOLUX_GUARD=OFF";
}

}  // namespace tempolux

#endif
