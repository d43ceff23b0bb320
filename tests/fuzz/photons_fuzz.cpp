// tests/fuzz/photons_fuzz.cpp -- .photons: read in full, digest and ledger included.
#include "formats/photons/photons.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".photons");
  fuzz::expect_read_or_refused(path, [&] {
    formats::PhotonReader reader(path);
    formats::PhotonBlock block;
    while (reader.read_block(block)) {}
    reader.digest();
  });
  return 0;
}
