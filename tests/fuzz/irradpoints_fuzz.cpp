// tests/fuzz/irradpoints_fuzz.cpp -- .irradpoints: read in full, with its digest.
#include "formats/irradpoints/irradpoints.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".irradpoints");
  fuzz::expect_read_or_refused(path, [&] { formats::digest_of(formats::load_irradpoints(path)); });
  return 0;
}
