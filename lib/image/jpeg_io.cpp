#include "lib/image/jpeg_io.h"

#include <csetjmp>
#include <cstdio>
#include <cstring>

// jpeglib.h needs the two headers above.
#include <jpeglib.h>

#include "formats/error.h"
#include "lib/image/byte_file.h"

namespace tempolux {
namespace {

constexpr int kMostScans = 100;  ///< a progressive file of many empty scans would take very long

/// libjpeg reports an error by calling a function that must not return. The function jumps back to the frame that
/// called setjmp, so no object with a destructor may live in the frames between.
struct Session {
  jpeg_decompress_struct info;
  jpeg_error_mgr errors;
  jpeg_source_mgr source;
  jpeg_progress_mgr progress;
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX] = "";
};

Session& session_of(j_common_ptr info) { return *static_cast<Session*>(info->client_data); }

[[noreturn]] void stop(j_common_ptr info, const char* text) {
  Session& session = session_of(info);
  std::strncpy(session.message, text, sizeof session.message - 1);
  std::longjmp(session.back, 1);
}
[[noreturn]] void on_error(j_common_ptr info) {
  Session& session = session_of(info);
  info->err->format_message(info, session.message);
  std::longjmp(session.back, 1);
}
/// Level -1 is a warning after which libjpeg would invent pixels, so it is treated as an error. Warnings about bytes
/// between markers are harmless.
void on_message(j_common_ptr info, int level) {
  if (level >= 0) return;
  char text[JMSG_LENGTH_MAX];
  info->err->format_message(info, text);
  if (std::strstr(text, "extraneous") == nullptr && std::strstr(text, "Unknown Adobe") == nullptr &&
      std::strstr(text, "JFIF") == nullptr)
    stop(info, text);
}
void print_nothing(j_common_ptr) {}

void start_source(j_decompress_ptr) {}
boolean at_end(j_decompress_ptr info) { stop(reinterpret_cast<j_common_ptr>(info), "the file ends too early"); }
void skip(j_decompress_ptr info, long count) {
  if (count <= 0) return;
  if (std::size_t(count) > info->src->bytes_in_buffer) at_end(info);
  info->src->next_input_byte += count;
  info->src->bytes_in_buffer -= std::size_t(count);
}
void end_source(j_decompress_ptr) {}

void on_progress(j_common_ptr info) {
  if (info->is_decompressor && reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > kMostScans)
    stop(info, "more than 100 scans");
}

/// Reads the header. False on an error, with the reason in session.message.
bool start_reading(Session& session, std::span<const unsigned char> bytes) {
  session.info.err = jpeg_std_error(&session.errors);
  session.errors.error_exit = on_error;
  session.errors.emit_message = on_message;
  session.errors.output_message = print_nothing;
  session.info.client_data = &session;
  if (setjmp(session.back)) return false;
  jpeg_create_decompress(&session.info);
  session.source = {bytes.data(), bytes.size(), start_source, at_end, skip, jpeg_resync_to_restart, end_source};
  session.info.src = &session.source;
  session.progress.progress_monitor = on_progress;
  session.info.progress = &session.progress;
  jpeg_read_header(&session.info, TRUE);
  const int channels = session.info.num_components;
  if (channels != 1 && channels != 3 && channels != 4)
    stop(reinterpret_cast<j_common_ptr>(&session.info), "neither one, three nor four channels; convert it to RGB");
  session.info.out_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 3 ? JCS_RGB : JCS_CMYK;
  session.info.dct_method = JDCT_ISLOW;  // integer arithmetic: the same bytes on every machine
  return true;
}

bool read_rows(Session& session, std::uint8_t* to, std::size_t row) {
  if (setjmp(session.back)) return false;
  jpeg_start_decompress(&session.info);
  while (session.info.output_scanline < session.info.output_height) {
    JSAMPROW line = to + std::size_t(session.info.output_scanline) * row;
    jpeg_read_scanlines(&session.info, &line, 1);
  }
  jpeg_finish_decompress(&session.info);
  return true;
}

/// From four inks to RGB. `lights`: the codes are 255 - ink.
void print_inks(CodedPixels& pixels, bool lights) {
  const std::size_t count = pixels.bytes.size() / 4;
  for (std::size_t i = 0; i < count; ++i) {
    const auto light = [&](std::size_t c) {
      return unsigned(lights ? pixels.bytes[4 * i + c] : 255 - pixels.bytes[4 * i + c]);
    };
    const unsigned black = light(3);
    for (std::size_t c = 0; c < 3; ++c) pixels.bytes[3 * i + c] = std::uint8_t((light(c) * black + 127) / 255);
  }
  pixels.bytes.resize(3 * count);
  pixels.channels = 3;
}

}  // namespace

CodedPixels decode_jpeg(std::span<const unsigned char> bytes, const std::string& place, std::uint64_t max_pixels) {
  Session session{};
  struct Release {
    jpeg_decompress_struct* info;
    ~Release() { jpeg_destroy_decompress(info); }
  } const release{&session.info};
  const auto fail = [&](const std::string& what) { throw InputError(place + ": JPEG: " + what); };
  if (!start_reading(session, bytes)) fail(one_line(session.message));
  CodedPixels pixels;
  pixels.width = int(session.info.image_width);
  pixels.height = int(session.info.image_height);
  pixels.channels = session.info.num_components;
  const std::uint64_t count = std::uint64_t(pixels.width) * std::uint64_t(pixels.height);
  if (count > max_pixels) fail(std::to_string(count) + " pixels, over the limit of " + std::to_string(max_pixels));
  const std::size_t row = std::size_t(pixels.width) * std::size_t(pixels.channels);
  pixels.bytes.resize(row * std::size_t(pixels.height));
  if (!read_rows(session, pixels.bytes.data(), row)) fail(one_line(session.message) + "; the file is damaged");
  if (pixels.channels == 4) print_inks(pixels, session.info.saw_Adobe_marker != FALSE);
  return pixels;
}

}  // namespace tempolux
