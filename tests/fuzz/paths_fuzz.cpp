// tests/fuzz/paths_fuzz.cpp -- .paths: read in full, with its digest.
#include "formats/paths/paths.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".paths");
  fuzz::expect_read_or_refused(path, [&] { formats::digest_of(formats::load_paths(path)); });
  return 0;
}
