// child-probe MODE -- a child program that misbehaves as child_process_test.cpp asks. Without MODE it is the child
// program of a tool (cli/guard_check.sh), and the environment variable CHILD_PROBE holds the mode.
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "modules/guard.h"

namespace {

std::string all_input() {
  std::string text;
  char piece[4096];
  for (ssize_t got = 0; (got = ::read(0, piece, sizeof piece)) > 0;) text.append(piece, std::size_t(got));
  return text;
}

void print(const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t put = ::write(1, text.data() + done, text.size() - done);
    if (put <= 0) std::_Exit(9);
    done += std::size_t(put);
  }
}

/// Open file descriptors.
std::string descriptors() {
  std::string list;
  for (int i = 0; i < 1024; ++i)
    if (::lseek(i, 0, SEEK_CUR) >= 0 || errno != EBADF) list += std::to_string(i) + " ";
  return list;
}

/// Acts like a library that a hostile file has taken over. Prints "done" if nothing stops it.
void do_harm(const std::string& kind) {
  const char* const canary = std::getenv("CHILD_PROBE_CANARY");
  if (kind == "open") ::open("/etc/hostname", O_RDONLY);
  if (kind == "create" && canary) ::open(canary, O_CREAT | O_WRONLY, 0600);
  if (kind == "look") ::access("/etc/hostname", R_OK);
  if (kind == "socket") ::socket(AF_INET, SOCK_STREAM, 0);
  if (kind == "fork" && ::fork() == 0) std::_Exit(0);
  if (kind == "exec") ::execl("/bin/true", "true", nullptr);
  if (kind == "thread") std::thread([] {}).join();
  if (kind == "code") ::mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (kind == "kill") ::kill(::getppid(), 0);
  print("done");
}

/// Behaves well: works, with memory, exceptions and messages.
int behave() {
  std::vector<std::string> texts;
  for (int i = 0; i < 1000; ++i) texts.emplace_back(std::size_t(i) * 1000, 'x');
  try {
    throw std::bad_alloc();
  } catch (const std::bad_alloc&) { std::printf("%zu texts", texts.size()); }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const char* const asked = std::getenv("CHILD_PROBE");
  const std::string mode = argc > 1 ? argv[1] : asked ? asked : "";
  if (mode == "never-reads") print("done");
  if (mode == "never-reads") return 0;
  const std::string input = all_input();
  if (mode.starts_with("guarded-") && !tempolux::guard_process().empty()) return 8;
  if (mode == "guarded-behave") return behave();
  if (mode.starts_with("guarded-")) do_harm(mode.substr(8));
  if (mode.starts_with("free-")) do_harm(mode.substr(5));
  if (mode == "echo") print(input);
  if (mode == "crash") {
    print("so far");
    std::signal(SIGSEGV, SIG_DFL);  // a sanitizer has a handler of its own
    ::raise(SIGSEGV);
  }
  if (mode == "abort") std::abort();
  if (mode == "hang") ::sleep(1000);
  if (mode == "closes-and-hangs") {
    ::close(1);
    ::close(2);
    ::sleep(1000);
  }
  if (mode == "spin")
    for (volatile bool forever = true; forever;) {}
  if (mode == "flood")
    for (;;) print(std::string(1 << 16, 'x'));
  if (mode == "words") {
    std::fprintf(stderr, "it is \x1b[1m wrong\nsecond line\n");
    for (int i = 0; i < 100'000; ++i) std::fputs("and so on and so on\n", stderr);
    return 2;
  }
  if (mode == "code") return 7;
  if (mode == "memory") {
    std::vector<void*> pieces;
    for (int i = 0; i < 4096; ++i) {  // up to 64 GB
      void* piece = std::malloc(1 << 24);
      if (!piece) {
        std::fprintf(stderr, "no memory after %d MiB\n", i * 16);
        return 3;
      }
      std::memset(piece, 1, 4096);
      pieces.push_back(piece);
    }
  }
  if (mode == "write-file") {  // the name comes as input
    std::signal(SIGXFSZ, SIG_IGN);
    std::FILE* file = std::fopen(input.c_str(), "w");
    if (file) std::fputs("text", file);
    print(file && std::fclose(file) == 0 ? "written" : "refused");
  }
  if (mode == "descriptors") print(descriptors());
  if (mode == "signals") {  // blocked or ignored?
    sigset_t blocked;
    sigprocmask(SIG_BLOCK, nullptr, &blocked);
    struct sigaction term {};
    sigaction(SIGTERM, nullptr, &term);
    print(std::string(sigismember(&blocked, SIGTERM) ? "blocked" : "open") +
          (term.sa_handler == SIG_DFL ? " default" : " other"));
  }
}
