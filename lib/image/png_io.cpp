#include "lib/image/png_io.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <vector>

#include "formats/error.h"
#include "lib/image/byte_file.h"
#include "lib/image/preview.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

/// State for libpng's callbacks. libpng reports an error by calling a function that must not return. The function jumps
/// back to the frame that called setjmp, so no object with a destructor may live in the frames between.
struct PngSession {
  std::jmp_buf back;
  char message[256] = "";
  const std::uint8_t* data = nullptr;  // when reading: the remaining bytes
  std::size_t left = 0;
  std::string* out = nullptr;  // writing

  static PngSession& of(png_structp png) { return *static_cast<PngSession*>(png_get_io_ptr(png)); }
};

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
  auto& session = *static_cast<PngSession*>(png_get_error_ptr(png));
  std::strncpy(session.message, text, sizeof session.message - 1);
  std::longjmp(session.back, 1);
}
void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, std::size_t count) {
  PngSession& session = PngSession::of(png);
  if (count > session.left) png_error(png, "the file ends too early");
  std::memcpy(to, session.data, count);
  session.data += count;
  session.left -= count;
}

void on_write(png_structp png, png_bytep from, std::size_t count) {
  PngSession& session = PngSession::of(png);
  session.out->append(reinterpret_cast<const char*>(from), count);
}
void on_flush(png_structp) {}

/// Pixels as libpng delivers them: 1 to 4 channels of 8 or 16 (big-endian) bits.
struct Raw {
  png_uint_32 width = 0, height = 0;
  int channels = 0, bits = 0;
  double gamma = 0;  // from the gAMA chunk; 0: none
  bool srgb = false;
  std::vector<std::uint8_t> bytes;
};

/// Reads the header into `raw` and asks libpng for plain samples. False on an error, with the reason in
/// session.message.
bool start_reading(PngSession& session, png_structp png, png_infop info, Raw& raw) {
  if (setjmp(session.back)) return false;
  png_set_read_fn(png, &session, on_read);
  png_set_user_limits(png, 65536, 65536);
  png_set_chunk_malloc_max(png, 8 << 20);
  png_read_info(png, info);
  png_set_expand(png);  // palette to RGB, less than 8 bits to 8, tRNS to alpha
  png_set_interlace_handling(png);
  raw.width = png_get_image_width(png, info);
  raw.height = png_get_image_height(png, info);
  int intent = 0;
  raw.srgb = png_get_sRGB(png, info, &intent) != 0;
  if (png_get_gAMA(png, info, &raw.gamma) == 0) raw.gamma = 0;
  png_read_update_info(png, info);
  raw.channels = png_get_channels(png, info);
  raw.bits = png_get_bit_depth(png, info);
  return true;
}

bool read_rows(PngSession& session, png_structp png, png_bytepp rows) {
  if (setjmp(session.back)) return false;
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

Raw read_raw(std::span<const unsigned char> bytes, const std::string& place, std::uint64_t max_pixels) {
  PngSession session;
  session.data = bytes.data();
  session.left = bytes.size();
  const auto fail = [&](const std::string& what) { throw InputError(place + ": PNG: " + what); };
  if (bytes.size() < 8 || png_sig_cmp(bytes.data(), 0, 8) != 0) fail("no PNG signature; not a PNG file");

  struct Handle {
    png_structp png = nullptr;
    png_infop info = nullptr;
    ~Handle() { png_destroy_read_struct(&png, &info, nullptr); }
  } handle;
  handle.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  handle.info = handle.png ? png_create_info_struct(handle.png) : nullptr;
  if (!handle.info) throw ResourceError(place + ": libpng could not start");

  Raw raw;
  if (!start_reading(session, handle.png, handle.info, raw)) fail(one_line(session.message));
  const std::uint64_t pixels = std::uint64_t(raw.width) * raw.height;
  if (pixels > max_pixels) fail(std::to_string(pixels) + " pixels, over the limit of " + std::to_string(max_pixels));
  // Deflate expands a byte to at most 1032 bytes. A byte of eight 1-bit palette indices becomes at most 32 bytes.
  const std::size_t row = std::size_t(raw.width) * std::size_t(raw.channels * raw.bits / 8);
  if (row * raw.height / (1032 * 32) > bytes.size()) fail("claims more pixels than its bytes can hold; it is damaged");
  raw.bytes.resize(row * raw.height);
  std::vector<png_bytep> rows(raw.height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = raw.bytes.data() + y * row;
  if (!read_rows(session, handle.png, rows.data())) fail(one_line(session.message) + "; the file is damaged");
  return raw;
}

/// The linear value of every code of the file. `transfer` receives the name of the decoding, for people.
std::vector<float> linear_table(const Raw& raw, std::string& transfer) {
  const std::size_t codes = raw.bits == 16 ? 65536 : 256;
  const bool power = !raw.srgb && raw.gamma > 0 && std::abs(raw.gamma - 0.45455) > 0.005;
  transfer = !power ? "sRGB" : raw.gamma > 0.995 && raw.gamma < 1.005 ? "linear" : "gamma " + std::to_string(raw.gamma);
  std::vector<float> table(codes);
  for (std::size_t code = 0; code < codes; ++code) {
    const double encoded = double(code) / double(codes - 1);
    table[code] = !power                 ? srgb_to_linear(float(encoded))
                  : transfer == "linear" ? float(encoded)
                                         : float(std::pow(encoded, 1 / raw.gamma));
  }
  return table;
}

constexpr int kDeflateLevel = 3;  ///< a quarter of the time of level 6, for 4 % more bytes of rendered frames

bool write_all(PngSession& session, png_structp png, png_infop info, const Picture& picture) {
  if (setjmp(session.back)) return false;
  png_set_write_fn(png, &session, on_write, on_flush);
  png_set_IHDR(png, info, png_uint_32(picture.width), png_uint_32(picture.height), 8, PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, kDeflateLevel);
  png_write_info(png, info);
  for (int y = 0; y < picture.height; ++y)
    png_write_row(png, picture.rgb.data() + std::size_t(y) * std::size_t(picture.width) * 3);
  png_write_end(png, info);
  return true;
}

}  // namespace

Image load_png(const std::string& path, std::uint64_t max_pixels) {
  const ByteFile file(path);
  std::vector<std::uint8_t> file_bytes(file.size());
  file.read_at(0, file_bytes.data(), file_bytes.size());
  const Raw raw = read_raw(file_bytes, path, max_pixels);
  std::string transfer;
  const std::vector<float> linear = linear_table(raw, transfer);
  const bool grey = raw.channels < 3, alpha = raw.channels % 2 == 0;
  Image image;
  image.width = int(raw.width);
  image.height = int(raw.height);
  for (const char* name : {"R", "G", "B"}) image.add(name);
  if (alpha) image.add("A");
  image.text["tempolux:source"] =
      "PNG, " + std::to_string(raw.bits) + " bits, " + transfer + " to linear" + (alpha ? ", premultiplied" : "");

  const auto channels = std::size_t(raw.channels);
  const auto code = [&](std::size_t sample) {
    if (raw.bits == 8) return std::size_t(raw.bytes[sample]);
    return std::size_t(raw.bytes[2 * sample]) << 8 | raw.bytes[2 * sample + 1];
  };
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    const float a = alpha ? float(code(i * channels + channels - 1)) / float(linear.size() - 1) : 1.0f;
    for (std::size_t c = 0; c < 3; ++c) image.channels[c].values[i] = a * linear[code(i * channels + (grey ? 0 : c))];
    if (alpha) image.channels[3].values[i] = a;
  }
  return image;
}

CodedPixels decode_png(std::span<const unsigned char> bytes, const std::string& place, std::uint64_t max_pixels) {
  Raw raw = read_raw(bytes, place, max_pixels);
  if (raw.bits == 16)
    for (std::size_t i = 0; i + 1 < raw.bytes.size(); i += 2) {
      const auto value = std::uint16_t(raw.bytes[i] << 8 | raw.bytes[i + 1]);
      std::memcpy(&raw.bytes[i], &value, sizeof value);
    }
  return {int(raw.width), int(raw.height), raw.channels, raw.bits, std::move(raw.bytes)};
}

void save_png(const std::string& path, const Picture& picture) {
  std::string bytes;
  PngSession session;
  session.out = &bytes;
  struct Handle {
    png_structp png = nullptr;
    png_infop info = nullptr;
    ~Handle() { png_destroy_write_struct(&png, &info); }
  } handle;
  handle.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  handle.info = handle.png ? png_create_info_struct(handle.png) : nullptr;
  if (!handle.info) throw ResourceError(path + ": libpng could not start");
  if (!write_all(session, handle.png, handle.info, picture))
    throw ResourceError(path + ": PNG: " + one_line(session.message));
  write_pieces(path, {&bytes, 1});
}

}  // namespace tempolux
