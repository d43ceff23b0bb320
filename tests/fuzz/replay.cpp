// tests/fuzz/replay.cpp -- a fuzz target without libFuzzer: runs it on the files of folders, whole, cut short, and
// with bytes changed by a fixed rule. For ctest, with any compiler.
//
//     gltf_replay tests/fuzz/corpus/gltf       all of it
//     gltf_replay FILE...                      these files, as they are
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;

std::size_t runs = 0;

void run(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  ++runs;
}

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// x <- 6364136223846793005 x + 1442695040888963407: the same changes on every machine.
struct Changes {
  std::uint64_t state;
  std::size_t below(std::size_t limit) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return std::size_t(state >> 33) % limit;
  }
};

void run_near(const std::string& bytes) {
  constexpr std::size_t kCuts = 40, kChanged = 60;
  for (std::size_t i = 0; i < kCuts; ++i) run(bytes.substr(0, bytes.size() * i / kCuts));
  Changes changes{bytes.size()};
  for (std::size_t i = 0; i < kChanged && !bytes.empty(); ++i) {
    std::string changed = bytes;
    for (std::size_t k = 0; k <= i % 4; ++k) changed[changes.below(changed.size())] = char(changes.below(256));
    run(changed);
    run(tempolux::fuzz::with_right_checksums(changed));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) {
      run(content_of(argv[i]));
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(argv[i]))
      if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const std::string bytes = content_of(file);
    run(bytes);
    run_near(bytes);
  }
  std::printf("%zu inputs from %zu files\n", runs, files.size());
  return runs > 0 ? 0 : 1;
}
