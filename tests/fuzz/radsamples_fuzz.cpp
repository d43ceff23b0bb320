// tests/fuzz/radsamples_fuzz.cpp -- .radsamples: read in full, with its digest.
#include "formats/radsamples/radsamples.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".radsamples");
  fuzz::expect_read_or_refused(path, [&] { formats::digest_of(formats::load_radsamples(path)); });
  return 0;
}
