#include "lib/core/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <thread>

#include "formats/error.h"
#include "lib/core/machine_memory.h"

namespace tempolux {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMemoryIsLimited = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
constexpr bool kMemoryIsLimited = false;
#else
constexpr bool kMemoryIsLimited = true;
#endif
#else
constexpr bool kMemoryIsLimited = true;
#endif

/// Bytes that are kept of the child's standard error. The remainder is read and dropped, so that the child does not
/// wait.
constexpr std::size_t kMostWords = 1024;
constexpr std::size_t kPiece = 1 << 16;  ///< bytes that are read or written at once

[[noreturn]] void fail(const std::string& program, const std::string& what, int error) {
  throw ResourceError(program + ": " + what + ": " + std::strerror(error));
}

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  void reset(int number) {
    close();
    number_ = number;
  }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

/// Both ends of a stream; close-on-exec, so that programs started by other threads do not inherit them.
struct Stream {
  Descriptor ours, theirs;
};

/// Opens a pair of sockets for one direction. Writing to a socket whose reader has closed it returns an error, while
/// writing to such a pipe would send SIGPIPE.
void open_stream(const std::string& program, Stream& stream) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) fail(program, "no socket for it", errno);
  stream.ours.reset(ends[0]);
  stream.theirs.reset(ends[1]);
}

/// Settings for posix_spawn.
class SpawnPlan {
 public:
  SpawnPlan(const Stream& input, const Stream& output, const Stream& words) {
    ::posix_spawn_file_actions_init(&files_);
    ::posix_spawnattr_init(&attributes_);
    ::posix_spawn_file_actions_adddup2(&files_, input.theirs.number(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&files_, output.theirs.number(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&files_, words.theirs.number(), STDERR_FILENO);
    ::posix_spawn_file_actions_addclosefrom_np(&files_, STDERR_FILENO + 1);
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnPlan() {
    ::posix_spawn_file_actions_destroy(&files_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  pid_t start(const std::string& program, const std::vector<std::string>& arguments) const {
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    pid_t child = -1;
    const int error = ::posix_spawn(&child, program.c_str(), &files_, &attributes_, words.data(), environ);
    if (error != 0) fail(program, "cannot be started", error);
    return child;
  }

 private:
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

/// The running child process. The destructor kills it and waits for it, if it has not ended.
class Child {
 public:
  explicit Child(pid_t child) : child_(child) {}
  ~Child() {
    if (!ended()) end();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Sets the limits of the running child from this process. The child waits for its input, so it has not yet read
  /// anything from a file.
  void limit(const std::string& program, const ChildLimits& limits) const {
    const auto set = [&](__rlimit_resource resource, rlim_t soft, rlim_t hard) {
      const rlimit both{soft, hard};
      if (::prlimit(child_, resource, &both, nullptr) != 0 && errno != ESRCH) {
        const int error = errno;
        fail(program, "its limits cannot be set", error);
      }
    };
    const rlim_t seconds = rlim_t(limits.processor_s);
    if (kMemoryIsLimited) set(RLIMIT_AS, limits.memory_bytes, limits.memory_bytes);
    set(RLIMIT_CPU, seconds, seconds + 1);
    set(RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes);
    set(RLIMIT_CORE, 0, 0);
  }

  /// Waits until the child has ended or the time is over; true if it has ended.
  bool wait_until(Clock::time_point deadline) {
    for (auto nap = 50us; !ended(); nap = std::min(2 * nap, std::chrono::microseconds(10ms))) {
      if (Clock::now() >= deadline) return false;
      std::this_thread::sleep_for(nap);
    }
    return true;
  }

  void end() {
    ::kill(child_, SIGKILL);
    while (!reap(0)) {}
  }

  /// The status from waitpid, once the child has ended.
  int status() const { return status_; }

 private:
  bool ended() { return ended_ || reap(WNOHANG); }

  bool reap(int options) {
    int status = 0;
    const pid_t got = ::waitpid(child_, &status, options);
    if (got == child_) status_ = status;
    // ECHILD: this process ignores SIGCHLD, so the kernel has already waited. The child's status is unknown; its output
    // must show whether it succeeded.
    ended_ = got == child_ || (got < 0 && errno == ECHILD);
    return ended_;
  }

  pid_t child_;
  bool ended_ = false;
  int status_ = 0;
};

std::string first_line(const std::string& words) {
  std::string line = words.substr(0, words.find('\n'));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
  return line;
}

/// ChildResult::trouble of a child that ended by itself; "" for code 0.
std::string ending(int status, const std::string& words, const ChildLimits& limits) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return "took more than " + std::to_string(limits.processor_s) + " s of processor time";
    if (signal == SIGSYS)
      return "was ended by its guard: it asked the system for more than reading needs, such as to open a file or a "
             "socket. "
             "Data that does so is damaged or made to do harm; use a copy that you trust";
    const char* name = ::sigdescr_np(signal);
    return "died by signal " + std::to_string(signal) + (name ? " (" + std::string(name) + ")" : "");
  }
  const int code = WEXITSTATUS(status);
  if (code == 0) return "";
  const std::string line = first_line(words);
  return line.empty() ? "ended with code " + std::to_string(code) : line;
}

/// Exchanges input and output with a running child.
class Exchange {
 public:
  Exchange(Stream& input, Stream& output, Stream& words, std::span<const unsigned char> to_write,
           const ChildLimits& limits)
      : input_(input.ours), output_(output.ours), words_(words.ours), to_write_(to_write), limits_(limits) {}

  /// Runs until the child has closed its outputs and returns "". If the child must be killed, returns the reason
  /// instead.
  std::string run(const std::string& program, Clock::time_point deadline) {
    while (output_.number() >= 0 || words_.number() >= 0) {
      if (to_write_.empty()) input_.close();
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
      if (left <= 0ms) return "gave no answer within " + std::to_string(limits_.wall_s) + " s";
      std::array<pollfd, 3> ends{pollfd{input_.number(), POLLOUT, 0}, pollfd{output_.number(), POLLIN, 0},
                                 pollfd{words_.number(), POLLIN, 0}};  // poll ignores a negative number
      const int ready = ::poll(ends.data(), ends.size(), int(std::min<std::int64_t>(left.count(), 1'000'000)));
      if (ready < 0 && errno != EINTR) fail(program, "waiting for it", errno);
      if (ready <= 0) continue;
      if (ends[0].revents != 0) write_some();
      if (ends[1].revents != 0 && !read_some(output_, [&](auto bytes) { return take_output(bytes); }))
        return "printed more than " + std::to_string(limits_.output_bytes) + " bytes";
      if (ends[2].revents != 0) read_some(words_, [&](auto bytes) { return take_words(bytes); });
    }
    return "";
  }

  std::vector<unsigned char> take() { return std::move(printed_); }
  const std::string& words() const { return said_; }

 private:
  void write_some() {
    const std::size_t count = std::min(to_write_.size(), kPiece);
    const ssize_t sent = ::send(input_.number(), to_write_.data(), count, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) to_write_ = to_write_.subspan(std::size_t(sent));
    if (sent < 0 && errno != EAGAIN && errno != EINTR) to_write_ = {};  // the child has closed its input
  }

  template <class Take>
  bool read_some(Descriptor& from, Take take) {
    const ssize_t got = ::read(from.number(), piece_.data(), piece_.size());
    if (got > 0) return take(std::span(piece_).first(std::size_t(got)));
    if (got == 0 || errno != EINTR) from.close();
    return true;
  }

  bool take_output(std::span<const unsigned char> bytes) {
    if (bytes.size() > limits_.output_bytes - printed_.size()) return false;
    printed_.insert(printed_.end(), bytes.begin(), bytes.end());
    return true;
  }

  bool take_words(std::span<const unsigned char> bytes) {
    said_.append(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kMostWords - said_.size()));
    return true;
  }

  Descriptor &input_, &output_, &words_;
  std::span<const unsigned char> to_write_;
  const ChildLimits& limits_;
  std::vector<unsigned char> printed_;
  std::string said_;
  std::vector<unsigned char> piece_ = std::vector<unsigned char>(kPiece);
};

}  // namespace

std::uint64_t memory_that_fits(std::uint64_t wanted) {
  constexpr std::uint64_t least = 512ull << 20;
  return std::min(wanted, std::max(least, machine_memory() / 2));
}

ChildResult run_child(const std::string& program, const std::vector<std::string>& arguments,
                      std::span<const unsigned char> input, const ChildLimits& limits) {
  const Clock::time_point deadline = Clock::now() + std::chrono::seconds(limits.wall_s);
  Stream in, out, words;
  for (Stream* stream : {&in, &out, &words}) open_stream(program, *stream);
  Child child(SpawnPlan(in, out, words).start(program, arguments));
  for (Stream* stream : {&in, &out, &words}) stream->theirs.close();
  child.limit(program, limits);
  Exchange exchange(in, out, words, input, limits);
  ChildResult result;
  try {
    result.trouble = exchange.run(program, deadline);
  } catch (const std::bad_alloc&) { throw ResourceError(program + ": not enough memory for what it prints"); }
  if (result.trouble.empty() && !child.wait_until(deadline))
    result.trouble = "did not end within " + std::to_string(limits.wall_s) + " s";
  if (result.trouble.empty()) result.trouble = ending(child.status(), exchange.words(), limits);
  else child.end();
  result.output = exchange.take();
  result.words = exchange.words();
  return result;
}

}  // namespace tempolux
