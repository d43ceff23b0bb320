#include "lib/image/hdr_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "formats/error.h"
#include "lib/image/byte_file.h"

namespace tempolux {
namespace {

using Pixel = std::array<std::uint8_t, 4>;  ///< r, g, b, e

constexpr std::size_t kLongestHeader = 1 << 16;
constexpr std::uint64_t kPixelsPerByte = 64;  ///< largest expansion by run lengths: 255 pixels in 4 bytes

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {
    const ByteFile file(path);
    bytes_.resize(std::size_t(file.size()));
    file.read_at(0, bytes_.data(), bytes_.size());
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(path_ + ": byte " + std::to_string(at_) + ": " + what);
  }
  std::size_t left() const { return bytes_.size() - at_; }
  std::string line() {
    const auto end = std::find(bytes_.begin() + std::ptrdiff_t(at_), bytes_.end(), '\n');
    if (end == bytes_.end() || std::size_t(end - bytes_.begin()) > kLongestHeader)
      refuse("the Radiance header does not end; the file is damaged");
    std::string text(bytes_.begin() + std::ptrdiff_t(at_), end);
    at_ = std::size_t(end - bytes_.begin()) + 1;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }
  std::uint8_t byte() {
    if (at_ >= bytes_.size()) refuse("the picture ends too early; the file is truncated");
    return bytes_[at_++];
  }
  Pixel pixel() { return {byte(), byte(), byte(), byte()}; }
  /// Reads the next four bytes without consuming them; zeros at the end of the file.
  Pixel peek() const {
    return left() >= 4 ? Pixel{bytes_[at_], bytes_[at_ + 1], bytes_[at_ + 2], bytes_[at_ + 3]} : Pixel{};
  }
  void skip(std::size_t count) { at_ += count; }

 private:
  std::string path_;
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

struct Header {
  int width = 0, height = 0;
  double exposure = 1;
};

bool all_digits(const std::string& text) {
  return !text.empty() && text.size() <= 9 && text.find_first_not_of("0123456789") == std::string::npos;
}

/// Reads the line "-Y 512 +X 1024".
void read_resolution(Reader& in, Header& header) {
  const std::string text = in.line();
  std::array<std::string, 4> words;
  std::size_t word = 0;
  for (const char c : text) {
    if (c == ' ') ++word;
    if (word >= words.size()) in.refuse("a line that is not the size of a picture; the file is damaged");
    if (c != ' ') words[word] += c;
  }
  if (!all_digits(words[1]) || !all_digits(words[3]))
    in.refuse("a line that is not the size of a picture; the file is damaged");
  if (words[0] != "-Y" || words[2] != "+X")
    in.refuse("pixels in the order " + words[0] + " " + words[2] + "; only -Y +X is read: save it upright");
  header.height = std::atoi(words[1].c_str());
  header.width = std::atoi(words[3].c_str());
}

Header read_header(Reader& in) {
  Header header;
  in.line();  // #?RADIANCE or #?RGBE, checked before
  for (std::string text = in.line(); !text.empty(); text = in.line()) {
    if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe")
      in.refuse(one_line(text) + ": only 32-bit_rle_rgbe is read; convert it to RGB or to EXR");
    if (!text.starts_with("EXPOSURE=")) continue;
    const double factor = std::strtod(text.c_str() + 9, nullptr);
    if (!(factor > 0) || !std::isfinite(factor)) in.refuse(one_line(text) + ": not an exposure above 0");
    header.exposure *= factor;
  }
  if (!(header.exposure > 1e-30 && header.exposure < 1e30)) in.refuse("EXPOSURE lines beyond 1e30");
  read_resolution(in, header);
  return header;
}

/// Reads a line that stores the r bytes of all pixels, then all g, b and e: runs of up to 127 equal bytes, or up to 128
/// different ones.
void read_planes(Reader& in, std::vector<Pixel>& row) {
  in.skip(4);
  for (std::size_t plane = 0; plane < 4; ++plane)
    for (std::size_t x = 0; x < row.size();) {
      const std::size_t code = in.byte(), count = code > 128 ? code - 128 : code;
      if (count == 0 || count > row.size() - x) in.refuse("a run longer than its line; the file is damaged");
      const std::uint8_t value = code > 128 ? in.byte() : std::uint8_t(0);
      for (std::size_t i = 0; i < count; ++i) row[x++][plane] = code > 128 ? value : in.byte();
    }
}

/// Reads a line pixel by pixel. The code (1, 1, 1, n) repeats the previous pixel n times. Consecutive codes are the
/// digits of one number in base 256, the lowest first.
void read_pixels(Reader& in, std::vector<Pixel>& row) {
  unsigned shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const Pixel pixel = in.pixel();
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      row[x++] = pixel;
      shift = 0;
      continue;
    }
    const std::size_t count = shift < 24 ? std::size_t(pixel[3]) << shift : 0;
    if (x == 0 || count > row.size() - x || shift >= 24) in.refuse("a run longer than its line; the file is damaged");
    for (std::size_t i = 0; i < count; ++i, ++x) row[x] = row[x - 1];
    shift += 8;
  }
}

}  // namespace

Image load_hdr(const std::string& path, std::uint64_t max_pixels) {
  Reader in(path);
  const Header header = read_header(in);
  const std::uint64_t pixels = std::uint64_t(header.width) * std::uint64_t(header.height);
  if (pixels == 0 || pixels > max_pixels)
    in.refuse("size out of range: " + std::to_string(header.width) + " x " + std::to_string(header.height));
  if (pixels > kPixelsPerByte * std::uint64_t(in.left())) in.refuse("more pixels than its bytes can hold");

  std::array<double, 256> scale{};
  for (int e = 1; e < 256; ++e) scale[std::size_t(e)] = std::ldexp(1.0, e - 136) / header.exposure;

  Image image;
  image.width = header.width;
  image.height = header.height;
  image.text["tempolux:source"] = "hdr, 32 bits, linear";
  for (const char* name : {"R", "G", "B"}) image.add(name);
  std::vector<Pixel> row(std::size_t(header.width));
  constexpr std::size_t kLeast = 8, kMost = 32767;  // widths that may be stored in planes
  for (std::size_t y = 0; y < std::size_t(header.height); ++y) {
    const Pixel start = in.peek();
    const std::size_t width = std::size_t(start[2]) << 8 | start[3];
    const bool planes = row.size() >= kLeast && row.size() <= kMost && start[0] == 2 && start[1] == 2 && start[2] < 128;
    if (planes && width != row.size()) in.refuse("a line of another length than the picture's; the file is damaged");
    planes ? read_planes(in, row) : read_pixels(in, row);
    for (std::size_t x = 0; x < row.size(); ++x)
      for (std::size_t c = 0; c < 3; ++c)
        image.channels[c].values[y * row.size() + x] = float(std::min(row[x][c] * scale[row[x][3]], 3.4e38));
  }
  return image;
}

}  // namespace tempolux
