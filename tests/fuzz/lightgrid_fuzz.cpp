// tests/fuzz/lightgrid_fuzz.cpp -- .lightgrid: read in full, with its digest.
#include "formats/lightgrid/lightgrid.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".lightgrid");
  fuzz::expect_read_or_refused(path, [&] { formats::digest_of(formats::load_lightgrid(path)); });
  return 0;
}
