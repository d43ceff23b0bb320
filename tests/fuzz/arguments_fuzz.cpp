// tests/fuzz/arguments_fuzz.cpp -- what people type: frames, patterns of names, counts, sizes.
#include "tools/common/arguments.h"

#include "tests/fuzz/fuzz.h"

using namespace tempolux;

namespace {

template <class Parse>
void parse_or_refuse(Parse parse) {
  try {
    parse();
  } catch (const InputError&) {}
}

/// A range of 10^6 frames takes 0.1 s: a limit that is tested elsewhere, not to be tried again and again.
bool has_long_number(const std::string& text) {
  int digits = 0;
  for (const char c : text) {
    digits = c >= '0' && c <= '9' ? digits + 1 : 0;
    if (digits > 3) return true;
  }
  return false;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  int width = 0, height = 0;
  parse_or_refuse([&] { tools::parse_count(text); });
  parse_or_refuse([&] { tools::parse_bytes(text); });
  parse_or_refuse([&] { tools::parse_size(text, width, height); });
  parse_or_refuse([&] {
    if (tools::has_frame_pattern(text)) tools::frame_name(text, -12);
  });
  parse_or_refuse([&] {
    if (!has_long_number(text)) tools::parse_frames(text);
  });
  return 0;
}
