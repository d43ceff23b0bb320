// tests/fuzz/irradcache_fuzz.cpp -- .irradcache: read in full, with its digest.
#include "formats/irradcache/irradcache.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".irradcache");
  fuzz::expect_read_or_refused(path, [&] { formats::digest_of(formats::load_irradcache(path)); });
  return 0;
}
