// Child programs that die, hang, print too much or too little, or ask for too much memory: each gives one line, and no
// process or descriptor remains.
#include "lib/core/child_process.h"
#include "lib/core/module_folders.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>

#include "formats/error.h"
#include "lib/core/machine_memory.h"

namespace tempolux {
namespace {

namespace fs = std::filesystem;

std::string probe() { return fs::read_symlink("/proc/self/exe").parent_path() / "child-probe"; }

std::span<const unsigned char> bytes_of(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

ChildResult run(const std::string& mode, const std::string& input = "", const ChildLimits& limits = {}) {
  return run_child(probe(), {mode}, bytes_of(input), limits);
}

std::string text_of(const ChildResult& result) { return {result.output.begin(), result.output.end()}; }

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::size_t open_descriptors() {
  return std::size_t(std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator{}));
}

/// After each test: no child is left, running or waiting to be waited for, and no descriptor is open.
class ChildProcess : public testing::Test {
 protected:
  void TearDown() override {
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
    EXPECT_EQ(open_descriptors(), before_);
  }
  std::size_t before_ = open_descriptors();
};

TEST_F(ChildProcess, GivesBackWhatTheHelperPrints) {
  // Ten megabytes fit no pipe: both directions must move at the same time.
  std::string input;
  for (int i = 0; input.size() < 10'000'000; ++i) input += std::to_string(i) + " ";
  const ChildResult result = run("echo", input);
  EXPECT_EQ(result.trouble, "");
  EXPECT_EQ(text_of(result), input);
}

TEST_F(ChildProcess, NamesTheSignalByWhichItDiesAndKeepsItsWorkSoFar) {
  const ChildResult result = run("crash");
  EXPECT_EQ(result.trouble, "died by signal 11 (Segmentation fault)");
  EXPECT_EQ(text_of(result), "so far");
  EXPECT_EQ(run("abort").trouble, "died by signal 6 (Aborted)");
}

TEST_F(ChildProcess, EndsOneThatHangs) {
  for (const char* mode : {"hang", "closes-and-hangs"}) {
    const auto start = std::chrono::steady_clock::now();
    const ChildResult result = run(mode, "", {.wall_s = 1});
    EXPECT_NE(result.trouble.find("within 1 s"), std::string::npos) << result.trouble;
    EXPECT_GE(seconds_since(start), 0.9);
    EXPECT_LT(seconds_since(start), 20);  // a busy machine
  }
}

TEST_F(ChildProcess, EndsOneThatComputesForEver) {
  EXPECT_EQ(run("spin", "", {.processor_s = 1}).trouble, "took more than 1 s of processor time");
}

TEST_F(ChildProcess, EndsOneThatPrintsTooMuch) {
  const ChildResult result = run("flood", "", {.output_bytes = 1'000'000});
  EXPECT_EQ(result.trouble, "printed more than 1000000 bytes");
  EXPECT_LE(result.output.size(), 1'000'000u);
}

TEST_F(ChildProcess, LetsOneThatPrintsTooLittleToItsCaller) {
  const ChildResult result = run("echo", "abc");
  EXPECT_EQ(result.trouble, "");
  EXPECT_EQ(result.output.size(), 3u);
}

TEST_F(ChildProcess, PassesOnTheFirstLineOfItsWords) {
  EXPECT_EQ(run("words").trouble, "it is  [1m wrong");
  EXPECT_EQ(run("code").trouble, "ended with code 7");
}

TEST_F(ChildProcess, MayNotTakeMoreMemoryThanItsLimit) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take more address space than any limit";
#endif
  // 256 MiB are requested in pieces of 16. Some are granted; libraries and the heap take the rest, so never all 16.
  const ChildResult result = run("memory", "", {.memory_bytes = 256u << 20});
  int got = -1;
  ASSERT_EQ(std::sscanf(result.trouble.c_str(), "no memory after %d MiB", &got), 1) << result.trouble;
  EXPECT_GT(got, 100);
  EXPECT_LT(got, 256);
}

TEST_F(ChildProcess, MayEndWithoutReadingItsInput) {
  // Without the socket this test would die by SIGPIPE.
  const ChildResult result = run("never-reads", std::string(5'000'000, 'x'));
  EXPECT_EQ(result.trouble, "");
  EXPECT_EQ(text_of(result), "done");
}

TEST_F(ChildProcess, WritesNoFile) {
  const std::string path = fs::temp_directory_path() / ("child-probe-" + std::to_string(::getpid()));
  EXPECT_EQ(text_of(run("write-file", path)), "refused");
  EXPECT_EQ(fs::file_size(path), 0u);
  fs::remove(path);
}

TEST_F(ChildProcess, DiesWhereItAsksForMoreThanItsGuardAllows) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "no guard with sanitizers: their reports read /proc and start threads";
#endif
  EXPECT_EQ(text_of(run("guarded-behave")), "1000 texts");
  for (const std::string kind : {"open", "look", "socket", "fork", "exec", "thread", "code", "kill"}) {
    if (kind != "exec") {  // nothing else stops it
      EXPECT_EQ(text_of(run("free-" + kind)), "done") << kind;
    }
    const ChildResult result = run("guarded-" + kind);
    EXPECT_EQ(text_of(result), "") << kind;
    EXPECT_TRUE(result.trouble.starts_with("was ended by its guard")) << kind << ": " << result.trouble;
  }
}

TEST_F(ChildProcess, MemoryThatFitsIsHalfTheMachine) {
  const std::uint64_t machine = machine_memory();
  EXPECT_EQ(memory_that_fits(1000), 1000u);
  EXPECT_EQ(memory_that_fits(~0ull), std::max<std::uint64_t>(machine / 2, 512u << 20));
  const std::uint64_t installed = std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGE_SIZE));
  EXPECT_LE(machine, installed);
  EXPECT_GT(machine, 0u);
}

TEST_F(ChildProcess, HasNoOpenFilesAndNoSignalsOfItsParent) {
  const int leaky = ::dup(1);  // without CLOEXEC
  sigset_t term, before;
  sigemptyset(&term);
  sigaddset(&term, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &term, &before);
  const auto handler = std::signal(SIGTERM, SIG_IGN);
  EXPECT_EQ(text_of(run("descriptors")), "0 1 2 ");
  EXPECT_EQ(text_of(run("signals")), "open default");
  std::signal(SIGTERM, handler);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::close(leaky);
}

TEST_F(ChildProcess, WorksInManyThreadsAtOnce) {
  std::atomic<int> right{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 10; ++i) {
        const std::string input(std::size_t(1000 * t + i), char('a' + t));
        right += text_of(run("echo", input)) == input;
        right += run("crash").trouble == "died by signal 11 (Segmentation fault)";
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 160);
}

TEST_F(ChildProcess, WorksWhereTheCallerIgnoresItsChildren) {
  // The kernel then reaps children itself, and their exit status is unknown.
  const auto handler = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(text_of(run("echo", "abc")), "abc");
  EXPECT_EQ(run("hang", "", {.wall_s = 1}).trouble, "gave no answer within 1 s");
  std::signal(SIGCHLD, handler);
}

TEST_F(ChildProcess, SaysWhatIsMissing) {
  EXPECT_THROW(run_child("/nowhere/helper", {}, {}, {}), ResourceError);
  try {
    installed_file("tempolux-nothing", "scene.glb: reading Draco");
    FAIL();
  } catch (const InputError& e) {
    const std::string message = e.what();
    EXPECT_TRUE(
        message.starts_with("scene.glb: reading Draco needs tempolux-nothing, which was not built or not "
                            "installed (looked in "))
        << message;
    EXPECT_TRUE(message.ends_with("install all of tempolux together")) << message;
  }
}

}  // namespace
}  // namespace tempolux
