// tests/fuzz/pictures_fuzz.cpp -- headers of EXR files, which are walked before OpenEXR sees them, and PNG files.
#include "lib/image/exr_claims.h"
#include "lib/image/png_io.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t kMaxPixels = 1u << 20;
  const std::string path = fuzz::file_of(data, size, ".picture");
  if (size > 0 && data[0] == 0x89)
    fuzz::expect_read_or_refused(path, [&] { load_png(path, kMaxPixels); });
  else
    fuzz::expect_read_or_refused(path, [&] { read_exr_claims(ByteFile(path), kMaxPixels); });
  return 0;
}
