// tests/fuzz/meshirrad_fuzz.cpp -- .meshirrad: read in full, with its digest.
#include "formats/meshirrad/meshirrad.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".meshirrad");
  fuzz::expect_read_or_refused(path, [&] { formats::digest_of(formats::load_meshirrad(path)); });
  return 0;
}
