#include "tools/common/temporaries.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace tempolux::tools {

/// An entry of a list that only grows, so that the signal handler may read it at any time without a lock. Each output
/// of the run adds an entry of a few hundred bytes.
struct Temporary::Entry {
  std::string path;
  std::atomic<bool> live{true};
  Entry* next = nullptr;
};

namespace {

std::atomic<Temporary::Entry*> first_entry{nullptr};
bool pipe_may_end = false;
static_assert(std::atomic<Temporary::Entry*>::is_always_lock_free);

// Calls async-signal-safe functions only.
extern "C" void remove_temporaries_and_end(int signal) {
  const int saved = errno;
  for (Temporary::Entry* entry = first_entry.load(); entry; entry = entry->next)
    if (entry->live.load() && unlink(entry->path.c_str()) != 0 && errno == EISDIR) rmdir(entry->path.c_str());
  struct sigaction standard = {};
  standard.sa_handler = SIG_DFL;
  sigaction(signal, &standard, nullptr);
  raise(signal);  // stays pending until this handler returns
  errno = saved;
}

}  // namespace

Temporary::Temporary(const std::string& path) : entry_(new Entry) {
  entry_->path = path;
  entry_->next = first_entry.load();
  while (!first_entry.compare_exchange_weak(entry_->next, entry_)) {}
}

Temporary::~Temporary() { remove(); }

const char* Temporary::path() const { return entry_->path.c_str(); }

void Temporary::release() { entry_->live = false; }

void Temporary::remove() {
  if (entry_->live.load()) unlink(entry_->path.c_str());
  entry_->live = false;
}

void install_signal_handlers() {
  struct sigaction action = {}, before = {};
  sigfillset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
    action.sa_handler = remove_temporaries_and_end;
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
  action.sa_handler = SIG_IGN;
  pipe_may_end = sigaction(SIGPIPE, &action, &before) == 0 && before.sa_handler != SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
}

void end_by_broken_pipe() {
  if (pipe_may_end) remove_temporaries_and_end(SIGPIPE);
}

}  // namespace tempolux::tools
