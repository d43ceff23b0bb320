// tests/fuzz/report_fuzz.cpp -- JSON that error-report reads: statistics, comparisons, manifests. A manifest can
// name the file itself as one of its statistics.
#include "lib/report/report_input.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".json");
  fuzz::expect_read_or_refused(path, [&] { read_stats(path); });
  fuzz::expect_read_or_refused(path, [&] { read_comparison(path); });
  try {
    read_manifest(path);
  } catch (const InputError&) {  // may name another file
  }
  return 0;
}
