#include "tools/common/tool_main.h"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <new>
#include <system_error>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "tools/common/manual.h"
#include "tools/common/temporaries.h"
#include "tools/common/tool_state.h"

namespace tempolux::tools {
namespace {

/// Numbers below 2^-126 count as zero in every thread that starts from now on: computing with them takes 150 times as
/// long, and they carry no visible light. Must be called before any thread and before the first use of TBB or Embree.
void flush_denormals_to_zero() {
  constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
}

/// Keeps freed memory. Threads allocate and free pieces of up to a megabyte; if they were returned to the system, page
/// faults would take 5 % of photon-trace's time.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
}

/// Opens missing standard streams: otherwise an output file could get such a stream's number and receive messages.
void hold_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (fcntl(stream, F_GETFD) == -1 && errno == EBADF)
      if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
}

/// Makes text fit for one line: line breaks and control characters in file names must not fake other lines.
std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = c == '\n' || c == '\t' ? ' ' : '?';
  return text;
}

/// Flushes standard output. A reader that has stopped (`| head`) is not an error.
void flush_stdout() {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout) return;
  int error = errno ? errno : EIO;
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  // A write failed earlier, and errno may belong to a later call.
  if (poll(&out, 1, 0) > 0 && (out.revents & POLLERR)) error = EPIPE;
  if (error == EPIPE) end_by_broken_pipe();
  throw ResourceError(std::string("standard output: write failed: ") + std::strerror(error));
}

std::string out_of_memory_text(const Common& common) {
  if (common.max_memory_bytes == 0) return "not enough memory; ask for less, or use a machine with more";
  return "not enough memory within --max-memory " + std::to_string(common.max_memory_bytes) +
         " bytes; raise it, or ask for less";
}

}  // namespace

std::uint64_t Common::seed_for_frame(int frame) const {
  if (seed_mode == "fixed") return seed;
  return mix64(seed ^ mix64(0x9e3779b97f4a7c15ull + std::uint64_t(std::int64_t{frame})));
}

Tool::Tool(std::string name, std::string what, int argc, char** argv) {
  flush_denormals_to_zero();
  keep_freed_memory();
  hold_standard_streams();
  // Buffers a whole help text, so that a failure to write it is reported with its reason.
  static char text[1 << 16];
  if (!isatty(STDOUT_FILENO)) std::setvbuf(stdout, text, _IOFBF, sizeof text);
  install_signal_handlers();
  state_ = std::make_unique<State>(std::move(name), std::move(what), argc, argv);
  CLI::App& app = state_->app;
  app.formatter(help_formatter());
  app.set_help_flag("-h,--help", "print this and exit");
  app.set_version_flag(
      "--version", [tool = state_->name] { return version_text(tool); }, "print versions and exit");
  app.footer(
      "Exit codes: 0 done; 1 differs or not valid (aqm-compare, tempolux-info only); 2 usage, bad or stale\n"
      "input; 3 could not be done (no memory, disk full, write failed); 128+n by signal n.\n");
  const char* terminal = std::getenv("TERM");
  state_->bar_allowed = isatty(STDERR_FILENO) && terminal && std::strcmp(terminal, "dumb") != 0;
}

Tool::~Tool() = default;

CLI::App& Tool::app() { return state_->app; }
const Common& Tool::common() const { return state_->common; }
Stats& Tool::stats() { return state_->stats; }

void Tool::State::print_line(const std::string& message) {
  const std::lock_guard lock(message_mutex);
  clear_bar();
  std::fprintf(stderr, "%s: %s\n", name.c_str(), one_line(with_final_names(message)).c_str());
}

void Tool::State::clear_bar() {
  if (bar_shown) std::fputs("\r\033[K", stderr);
  bar_shown = false;
}

bool Tool::State::was_said(const std::string& message) {
  const char* file = std::getenv("TEMPOLUX_SAID");
  if (!file) return false;
  if (!said) {
    said.emplace();
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) said->insert(line);
  }
  return said->contains(message.substr(0, message.find('\n')));
}

void Tool::warn(const std::string& message) {
  {
    const std::lock_guard lock(state_->message_mutex);
    if (!state_->warnings.insert(message).second || state_->common.quiet || state_->was_said(message)) return;
  }
  state_->print_line(message);
}

std::vector<std::string> Tool::warnings() const { return {state_->warnings.begin(), state_->warnings.end()}; }

void Tool::refuse_stale(const std::string& message, const std::string& remedy) {
  if (!state_->common.allow_stale) throw InputError(message + "; " + remedy + ", or pass --allow-stale");
  warn(message);
}

void Tool::say(const std::string& message) {
  if (state_->common.verbose > 0 && !state_->common.quiet) state_->print_line(message);
}

void Tool::progress(double fraction) {
  using namespace std::chrono_literals;
  constexpr int kWidth = 40;
  if (!state_->bar_allowed || state_->common.quiet) return;
  const std::lock_guard lock(state_->message_mutex);
  const auto now = std::chrono::steady_clock::now();
  if (now - state_->start < 1s || now - state_->bar_time < 100ms) return;
  state_->bar_time = now;
  const double part = std::clamp(std::isfinite(fraction) ? fraction : 0.0, 0.0, 1.0);
  std::string bar(kWidth, '.');
  std::fill_n(bar.begin(), int(part * kWidth), '#');
  std::fprintf(stderr, "\r%s [%s] %3d %%", state_->name.c_str(), bar.c_str(), int(part * 100));
  state_->bar_shown = true;
}

std::function<void(double)> Tool::progress_sink() {
  return [this](double fraction) { progress(fraction); };
}

void Tool::depends_on(const std::string& file, InputRole role) {
  if (file == "-") return;
  if (role != InputRole::replaceable) protect_input(file);
  std::vector<std::string>& known = state_->dependencies;
  if (std::ranges::find(known, file) == known.end()) known.push_back(file);
}

/// Writes a part of the manual (docs/make_tools.sh, cmake/install.cmake). True if the user asked for nothing else.
bool Tool::State::print_manual() const {
  const std::string wish = argc == 2 ? argv[1] : "";
  if (wish == "--help-markdown") std::cout << option_table(app);
  else if (wish == "--help-completion") std::cout << bash_completion(app);
  else return false;
  return true;
}

void Tool::State::apply_limits() const {
  if (common.max_memory_bytes == 0) return;
  mallopt(M_ARENA_MAX, 2);  // each arena reserves 64 MiB of the limited address space
  const rlimit limit{common.max_memory_bytes, common.max_memory_bytes};
  if (setrlimit(RLIMIT_AS, &limit) != 0)
    throw ResourceError(std::string("--max-memory: cannot be set: ") + std::strerror(errno));
}

int Tool::State::run(const std::function<int()>& body, const Tool& tool) {
  apply_limits();
  const ThreadLimit limit(common.threads);
  // Created before the work like all outputs, so that an unwritable place is reported first.
  std::optional<Output> stats_output, dep_output;
  if (!common.stats_file.empty()) stats_output.emplace(common.stats_file, Output::Kind::text);
  if (!common.dep_file.empty()) dep_output.emplace(common.dep_file, Output::Kind::text);

  const int code = body();
  stats.end_phase();
  const std::vector<std::string> targets = committed_outputs();
  if (dep_output) {
    if (targets.empty()) throw InputError("--depfile: this run wrote no file that could depend on others");
    dep_output->write(depfile_text(targets));
    dep_output->commit();
  }
  if (stats_output) {
    std::string command = tool.history_line();
    command.pop_back();
    stats_output->write(stats.json(name, command, common.threads, code));
    stats_output->commit();
  }
  if (common.verbose > 0 && !common.quiet && !stats.summary().empty()) print_line(stats.summary());
  const std::lock_guard lock(message_mutex);
  clear_bar();
  return code;
}

int Tool::run(const std::function<int()>& body) {
  State& state = *state_;
  const auto fail = [&](int code, const std::string& message) {
    state.print_line(message);
    return code;
  };
  try {
    int code = exit_ok;
    try {
      if (state.print_manual()) return flush_stdout(), code;
      state.app.parse(state.argc, state.argv);
      if (state.common.threads == 0) state.common.threads = usable_processor_count();
      code = state.run(body, *this);
    } catch (const CLI::CallForHelp&) { std::cout << state.app.help(); } catch (const CLI::CallForVersion&) {
      std::cout << version_text(state.name);
    }
    flush_stdout();
    return code;
  } catch (const CLI::ParseError& error) {
    return fail(exit_bad_input, std::string(error.what()) + "; see " + state.name + " --help");
  } catch (const InputError& error) {
    return fail(exit_bad_input, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(exit_bad_input, error.what());
  } catch (const ResourceError& error) { return fail(exit_cannot, error.what()); } catch (const std::bad_alloc&) {
    return fail(exit_cannot, out_of_memory_text(state.common));
  } catch (const std::system_error& error) {
    return fail(exit_cannot, error.what());
  } catch (const std::exception& error) { return fail(exit_cannot, std::string("unexpected: ") + error.what()); }
}

}  // namespace tempolux::tools
