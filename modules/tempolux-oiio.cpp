// modules/tempolux-oiio.cpp -- a child program that reads one JPEG or TIFF with OpenImageIO and writes its pixels to
// standard output (lib/image/image_pipe.h).
//
// A separate program, which lib/image/any_io.cpp starts under limits of memory and time: linking Debian's OpenImageIO
// costs 0.4 s and 130 MB at every start, and an untrusted file reaches 261 libraries through it. The program opens the
// file and calls guard_process() before it reads the first byte.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "lib/image/image_pipe.h"
#include "modules/guard.h"

namespace {

using tempolux::ImagePipeAsk;
using tempolux::ImagePipeHead;

struct Refused {
  std::string words;
};

struct Request {
  ImagePipeAsk ask;
  std::string format, path;
};

Request take_request() {
  Request request;
  if (std::fread(&request.ask, sizeof request.ask, 1, stdin) != 1 || request.ask.magic != ImagePipeAsk{}.magic)
    throw Refused{"tempolux-oiio is of another version than the tool that started it; install both together"};
  for (int c = 0; (c = std::fgetc(stdin)) != EOF;) request.path += char(c);
  for (const char c : request.ask.format)
    if (c != 0) request.format += c;
  if (request.format != "jpeg" && request.format != "tiff")
    throw Refused{"format " + request.format + " is not one that tempolux-oiio opens"};
  return request;
}

/// Sets OpenImageIO's limits before a file is read: no plugin folders, no threads.
std::unique_ptr<OIIO::ImageInput> reader(const Request& request) {
  const std::uint64_t megabytes = request.ask.max_pixels * request.ask.max_channels * sizeof(float) / (1 << 20) + 1;
  OIIO::attribute("limits:imagesize_MB", int(std::min<std::uint64_t>(megabytes, 1 << 20)));
  OIIO::attribute("limits:channels", int(request.ask.max_channels));
  OIIO::attribute("threads", 1);
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(request.format, false, nullptr, nullptr, "");
  if (!input) throw Refused{OIIO::geterror()};
  return input;
}

ImagePipeHead head_of(const OIIO::ImageSpec& spec, const ImagePipeAsk& ask) {
  if (spec.width < 1 || spec.height < 1 || spec.depth != 1 || spec.nchannels < 1 ||
      std::uint64_t(spec.width) * std::uint64_t(spec.height) > ask.max_pixels ||
      std::uint64_t(spec.nchannels) > ask.max_channels)
    throw Refused{"size out of range: " + std::to_string(spec.width) + " x " + std::to_string(spec.height) + ", " +
                  std::to_string(spec.nchannels) + " channels"};
  ImagePipeHead head;
  head.width = spec.width, head.height = spec.height, head.channels = spec.nchannels;
  head.bits = spec.format.is_floating_point() ? 32 : int(spec.format.size()) * 8;
  if (head.bits > 16 && !spec.format.is_floating_point()) throw Refused{"integer samples of more than 16 bits"};
  return head;
}

void run() {
  const Request request = take_request();
  const std::unique_ptr<OIIO::ImageInput> input = reader(request);
  std::FILE* const file = std::fopen(request.path.c_str(), "rb");
  if (!file) throw Refused{"cannot be opened"};
  if (const std::string trouble = tempolux::guard_process(); !trouble.empty())
    throw Refused{"tempolux-oiio " + trouble};
  OIIO::Filesystem::IOFile bytes(file, OIIO::Filesystem::IOProxy::Read);
  if (!input->set_ioproxy(&bytes)) throw Refused{input->geterror()};
  OIIO::ImageSpec spec;
  if (!input->open(request.path, spec)) throw Refused{input->geterror()};
  const ImagePipeHead head = head_of(spec, request.ask);
  std::vector<float> pixels(std::size_t(head.width) * std::size_t(head.height) * std::size_t(head.channels));
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data()))
    throw Refused{input->geterror()};
  std::fwrite(&head, sizeof head, 1, stdout);
  std::fwrite(pixels.data(), sizeof(float), pixels.size(), stdout);
  if (std::fflush(stdout) != 0) throw Refused{"its pixels could not be handed over"};
}

}  // namespace

int main() {
  std::string words;
  try {
    run();
    // a regular exit would run the exit code of 261 libraries, whose system calls the guard does not allow
    std::_Exit(0);
  } catch (const Refused& refused) { words = refused.words; } catch (const std::bad_alloc&) {
    words = "needs more memory than reading it may take; convert it to EXR or PNG, or make it smaller";
  } catch (const std::exception& error) { words = error.what(); }
  std::fprintf(stderr, "%s\n", words.substr(0, words.find('\n')).c_str());
  std::_Exit(2);
}
