// lib/report/gnuplot.cpp -- runs gnuplot as a child process, with its three streams in unnamed temporary files.
#include "lib/report/gnuplot.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>

#include "formats/error.h"

namespace tempolux {
namespace {

using File = std::unique_ptr<std::FILE, decltype([](std::FILE* file) { std::fclose(file); })>;

File temporary_file() {
  File file(std::tmpfile());
  if (!file) throw ResourceError(std::string("gnuplot: no temporary file: ") + std::strerror(errno));
  fcntl(fileno(file.get()), F_SETFD, FD_CLOEXEC);
  return file;
}

std::string content_of(std::FILE* file) {
  std::string text;
  char block[65536];
  std::rewind(file);
  while (const std::size_t size = std::fread(block, 1, sizeof block, file)) text.append(block, size);
  return text;
}

/// The child's process; 0: there is no such program.
pid_t start(const char* program, std::FILE* in, std::FILE* out, std::FILE* errors) {
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_adddup2(&streams, fileno(in), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&streams, fileno(out), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&streams, fileno(errors), STDERR_FILENO);
  // -d ignores the user's settings, so that equal input gives equal plots.
  char name[] = "gnuplot", plain[] = "-d", stream[] = "-";
  char* arguments[] = {name, plain, stream, nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, program, &streams, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&streams);
  if (error == ENOENT) return 0;
  if (error) throw ResourceError(std::string("gnuplot: cannot be started: ") + std::strerror(error));
  return child;
}

/// Waits for the child and returns its status; kills it at the deadline and throws.
int wait_for(pid_t child, double timeout_s) {
  using namespace std::chrono_literals;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  for (int status = 0;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) throw ResourceError(std::string("gnuplot: lost: ") + std::strerror(errno));
    if (std::chrono::steady_clock::now() > deadline) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      throw ResourceError("gnuplot: not done after " + std::to_string(int(timeout_s)) + " s; stopped");
    }
    std::this_thread::sleep_for(2ms);
  }
}

}  // namespace

std::optional<std::string> run_gnuplot(const std::string& script, double timeout_s) {
  const File in = temporary_file(), out = temporary_file(), errors = temporary_file();
  if (std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() || std::fflush(in.get()) != 0)
    throw ResourceError(std::string("gnuplot: temporary file: ") + std::strerror(errno));
  std::rewind(in.get());
  const pid_t child = start("gnuplot", in.get(), out.get(), errors.get());
  if (child == 0) return std::nullopt;
  const int status = wait_for(child, timeout_s);
  std::string drawn = content_of(out.get());
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || drawn.empty())
    throw ResourceError("gnuplot: failed: " + content_of(errors.get()).substr(0, 400));
  return drawn;
}

}  // namespace tempolux
