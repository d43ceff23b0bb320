#include "lib/image/exr_io.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfFramesPerSecond.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <set>
#include <stdexcept>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/image/byte_file.h"
#include "lib/image/channel_groups.h"
#include "lib/image/cryptomatte.h"
#include "lib/image/exr_claims.h"
#include "lib/image/exr_plain.h"
#include "lib/image/foreign_names.h"

namespace tempolux {
namespace {

// Lines that a thread reads, and writes, at a time. kSlabLines is one chunk of ZIP, so that 540 lines occupy many
// threads.
constexpr int kReadLines = 64, kSlabLines = 16;
constexpr float kLargestHalf = 65504;
// OpenEXR's present default. A later default must not change the bytes of files.
constexpr int kDeflateLevel = 4;

std::string pixel_place(const std::string& path, const std::string& channel, std::size_t index, int width) {
  return path + ": channel " + one_line(channel) + ": " + pixel_name(index, width) + ": ";
}

/// First index at which `bad` holds, or values.size().
template <class Bad>
std::size_t first_bad(const std::vector<float>& values, Bad bad) {
  return std::size_t(std::find_if(values.begin(), values.end(), bad) - values.begin());
}

// ---- writing

void check_writable(const std::string& path, const Image& image, bool half) {
  if (image.width < 1 || image.height < 1 || image.channels.empty())
    throw std::invalid_argument("save_exr: an image without pixels or channels");
  std::set<std::string> names;
  for (const Channel& channel : image.channels) {
    if (channel.name.empty() || channel.name.size() > 255 || !names.insert(channel.name).second)
      throw std::invalid_argument("save_exr: channel name \"" + channel.name + "\" empty, too long or there twice");
    if (std::max(channel.values.size(), channel.ids.size()) != image.pixel_count() ||
        (!channel.values.empty() && !channel.ids.empty()))
      throw std::invalid_argument("save_exr: channel " + channel.name + " does not have the image's size");

    const bool may_be_infinite = channel.name == "Z";
    const float limit = half && is_colour(channel.name) ? kLargestHalf : INFINITY;
    const auto bad = [&](float v) {
      return std::isnan(v) || (std::isinf(v) && !(may_be_infinite && v > 0)) || std::abs(v) > limit;
    };
    const std::size_t at = first_bad(channel.values, bad);
    if (at == channel.values.size()) continue;
    const float value = channel.values[at];
    const std::string place = pixel_place(path, channel.name, at, image.width);
    if (std::isfinite(value))
      throw InputError(place + std::to_string(value) + " is above 65504; write it without --half");
    throw InputError(place + (std::isnan(value) ? "not a number" : "infinite") + "; nothing was written");
  }
  const auto check_finite = [&](const std::string& name, double value) {
    if (!std::isfinite(value)) throw InputError(path + ": attribute " + name + ": not finite; nothing was written");
  };
  for (const auto& [name, value] : image.numbers) check_finite(name, value);
  for (const auto& [name, matrix] : image.matrices)
    for (double value : matrix) check_finite(name, value);
}

template <class Matrix>
Matrix to_imath(const std::array<double, 16>& m) {
  Matrix result;
  for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = typename Matrix::BaseType(m[std::size_t(i)]);
  return result;
}

/// A header with size, compression and channels only.
Imf::Header make_bare_header(const Image& image, const ExrWriteOptions& options) {
  Imf::Header header(image.width, image.height, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                     options.zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION);
  header.zipCompressionLevel() = kDeflateLevel;
  for (const Channel& channel : image.channels)
    header.channels().insert(channel.name, Imf::Channel(!channel.ids.empty()                      ? Imf::UINT
                                                        : options.half && is_colour(channel.name) ? Imf::HALF
                                                                                                  : Imf::FLOAT));
  return header;
}

Imf::Header make_header(const Image& image, const ExrWriteOptions& options) {
  Imf::Header header = make_bare_header(image, options);
  for (const auto& [name, text] : image.text)
    if (!describes_missing_mattes(image, name)) header.insert(name, Imf::StringAttribute(text));
  for (const auto& [name, number] : image.numbers) {
    if (name == "framesPerSecond") Imf::addFramesPerSecond(header, Imf::guessExactFps(number));
    else header.insert(name, Imf::DoubleAttribute(number));
  }
  for (const auto& [name, matrix] : image.matrices) {
    if (name == "worldToCamera") Imf::addWorldToCamera(header, to_imath<Imath::M44f>(matrix));
    else if (name == "worldToNDC") Imf::addWorldToNDC(header, to_imath<Imath::M44f>(matrix));
    else header.insert(name, Imf::M44dAttribute(to_imath<Imath::M44d>(matrix)));
  }
  return header;
}

/// Lets OpenEXR write into memory; OpenEXR reserves the offset table and fills it in at the end.
class MemoryOut : public Imf::OStream {
 public:
  MemoryOut() : OStream("memory") {}
  void write(const char c[], int n) override {
    if (position_ + std::size_t(n) > bytes.size()) bytes.resize(position_ + std::size_t(n));
    std::memcpy(bytes.data() + position_, c, std::size_t(n));
    position_ += std::size_t(n);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = std::size_t(position); }
  std::string bytes;

 private:
  std::size_t position_ = 0;
};

/// Lines [first, first + count) of the image as chunks of the file: int32 line, int32 size, bytes.
std::string encode_slab(const Image& image, const ExrWriteOptions& options, int first, int count) {
  if (!options.zip && !options.half) return plain_lines(image, first, count);
  Imf::Header header = make_bare_header(image, options);
  const Imath::Box2i window({0, first}, {image.width - 1, first + count - 1});
  header.dataWindow() = window;
  const std::size_t width = std::size_t(image.width), begin = std::size_t(first) * width;
  std::vector<std::vector<half>> halves;
  halves.reserve(image.channels.size());
  Imf::FrameBuffer lines;
  for (const Channel& channel : image.channels) {
    const Imf::PixelType type = header.channels()[channel.name].type;
    const void* samples =
        type == Imf::UINT ? static_cast<const void*>(channel.ids.data() + begin) : channel.values.data() + begin;
    if (type == Imf::HALF) {
      const float* values = channel.values.data() + begin;
      halves.emplace_back(values, values + width * std::size_t(count));
      samples = halves.back().data();
    }
    const std::size_t size = type == Imf::HALF ? 2 : 4;
    lines.insert(channel.name, Imf::Slice::Make(type, samples, window, size, size * width));
  }
  MemoryOut out;
  std::size_t header_size = 0;
  {
    Imf::OutputFile file(out, header, 0);
    header_size = out.bytes.size();
    file.setFrameBuffer(lines);
    file.writePixels(count);
  }
  return out.bytes.substr(header_size);
}

/// The header and the offset table as OpenEXR writes them; the table is made from the sizes of the chunks in `slabs`.
std::string make_head(const Imf::Header& header, const std::vector<std::string>& slabs) {
  MemoryOut out;
  { Imf::OutputFile empty(out, header, 0); }
  const bool zip = header.compression() == Imf::ZIP_COMPRESSION;
  const auto height = std::size_t(header.dataWindow().max.y + 1);
  std::size_t entry = out.bytes.size() - 8 * (zip ? (height + 15) / 16 : height);
  std::uint64_t offset = out.bytes.size();
  for (const std::string& slab : slabs) {
    for (std::size_t chunk = 0; chunk < slab.size();) {
      std::memcpy(out.bytes.data() + entry, &offset, 8);
      entry += 8;
      std::int32_t size;
      std::memcpy(&size, slab.data() + chunk + 4, 4);
      chunk += 8 + std::size_t(size);
      offset += 8 + std::uint64_t(size);
    }
  }
  return std::move(out.bytes);
}

// ---- reading

/// Gives OpenEXR access to a file that other threads read, too.
class FileIn : public Imf::IStream {
 public:
  explicit FileIn(const ByteFile& file) : IStream(file.path().c_str()), file_(file), size_(file.size()) {}
  bool read(char to[], int n) override {
    const auto count = std::size_t(std::max(n, 0));
    file_.read_at(position_, to, count);
    position_ += count;
    return position_ < size_;
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  BufferedFile file_;
  std::uint64_t size_, position_ = 0;
};

template <class Matrix>
std::array<double, 16> from_imath(const Matrix& m) {
  std::array<double, 16> result;
  for (int i = 0; i < 16; ++i) result[std::size_t(i)] = double(m[i / 4][i % 4]);
  return result;
}

void read_attributes(const Imf::Header& header, Image& image) {
  static const std::set<std::string> structural{"pixelAspectRatio", "screenWindowWidth", "type", "chunkCount",
                                                "version"};
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    const Imf::Attribute* attribute = &it.attribute();
    if (structural.contains(name)) continue;
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(attribute)) image.text[name] = text->value();
    if (const auto* d = dynamic_cast<const Imf::DoubleAttribute*>(attribute)) image.numbers[name] = d->value();
    if (const auto* f = dynamic_cast<const Imf::FloatAttribute*>(attribute)) image.numbers[name] = double(f->value());
    if (const auto* i = dynamic_cast<const Imf::IntAttribute*>(attribute)) image.numbers[name] = i->value();
    if (const auto* r = dynamic_cast<const Imf::RationalAttribute*>(attribute))
      image.numbers[name] = double(r->value());
    if (const auto* m = dynamic_cast<const Imf::M44fAttribute*>(attribute))
      image.matrices[name] = from_imath(m->value());
    if (const auto* m = dynamic_cast<const Imf::M44dAttribute*>(attribute))
      image.matrices[name] = from_imath(m->value());
  }
}

/// Reads lines [first, last) of the data window into the image, which has the data window's size. If first is 0, also
/// reads the attributes.
void read_lines(const ByteFile& file, const ExrClaims& claims, Image& image, int first, int last) {
  const bool done = read_plain_lines(file, claims, image, first, last);
  if (done && first != 0) return;
  const PixelWindow& data = claims.data;
  FileIn in(file);
  Imf::MultiPartInputFile parts(in, 0, false);
  if (!parts.partComplete(0))
    throw InputError(file.path() + ": offset table: lines are missing, the writer did not finish; write it again");
  Imf::InputPart part(parts, 0);
  if (first == 0) read_attributes(part.header(), image);
  if (done) return;
  const Imath::Box2i window({data.x0, data.y0}, {data.x1, data.y1});
  Imf::FrameBuffer lines;
  for (Channel& channel : image.channels) {
    const bool ids = !channel.ids.empty();
    void* samples = ids ? static_cast<void*>(channel.ids.data()) : channel.values.data();
    lines.insert(channel.name,
                 Imf::Slice::Make(ids ? Imf::UINT : Imf::FLOAT, samples, window, 4, 4 * std::size_t(image.width)));
  }
  part.setFrameBuffer(lines);
  part.readPixels(data.y0 + first, data.y0 + last - 1);
}

bool is_rgb(const std::string& channel) { return channel == "R" || channel == "G" || channel == "B"; }

Image read_data_window(const ByteFile& file, const ExrClaims& claims, const ExrReadOptions& options) {
  Image image;
  image.width = int(claims.data.width());
  image.height = int(claims.data.height());
  std::set<std::string> names, rgb;
  for (const auto& channel : claims.channels)
    if (is_rgb(channel.name)) rgb.insert(channel.name);
  const bool all = !options.only_rgb || rgb.size() < 3;
  const auto wanted = [&](const std::string& name) {
    return (all || is_rgb(name)) && (!options.wanted || options.wanted(options.our_names ? our_name(name) : name));
  };
  for (const auto& channel : claims.channels)
    if (wanted(channel.name) && names.insert(channel.name).second)
      channel.type == 0 ? image.add_ids(channel.name) : image.add(channel.name);
  std::ranges::sort(image.channels, {}, &Channel::name);

  const int height = image.height;
  const int slab = claims.tile_width > 0 ? height : std::max(kReadLines, claims.lines_per_chunk());
  parallel_chunks(std::size_t(height), std::size_t(slab),
                  [&](std::size_t first, std::size_t last) { read_lines(file, claims, image, int(first), int(last)); });
  return image;
}

/// Moves the image to the display window, with the same attributes. Pixels outside the data window are empty.
Image placed(Image&& from, const PixelWindow& data, const PixelWindow& display) {
  Image to;
  to.width = int(display.width());
  to.height = int(display.height());
  to.text = std::move(from.text);
  to.numbers = std::move(from.numbers);
  to.matrices = std::move(from.matrices);
  const std::int64_t x0 = std::max(data.x0, display.x0), x1 = std::min(data.x1, display.x1);
  const std::int64_t y0 = std::max(data.y0, display.y0), y1 = std::min(data.y1, display.y1);
  const auto copy = [&](const auto& source, auto& target) {
    for (std::int64_t y = y0; y <= y1 && x0 <= x1; ++y)
      std::copy_n(source.begin() + (y - data.y0) * from.width + (x0 - data.x0), x1 - x0 + 1,
                  target.begin() + (y - display.y0) * to.width + (x0 - display.x0));
  };
  for (const Channel& channel : from.channels) {
    if (channel.ids.empty()) {
      std::vector<float>& values = to.add(channel.name).values;
      if (channel.name == "Z") values.assign(values.size(), INFINITY);
      copy(channel.values, values);
    } else {
      std::vector<std::uint32_t>& ids = to.add_ids(channel.name).ids;
      if (channel.name == "id.object") ids.assign(ids.size(), 0xffffffffu);
      copy(channel.ids, ids);
    }
  }
  return to;
}

void check_numbers(const std::string& path, const Image& image) {
  for (const Channel& channel : image.channels) {
    const bool colour = is_colour(channel.name);
    const std::size_t at =
        first_bad(channel.values, [&](float v) { return std::isnan(v) || (colour && std::isinf(v)); });
    if (at < channel.values.size())
      throw InputError(pixel_place(path, channel.name, at, image.width) +
                       (std::isnan(channel.values[at]) ? "not a number" : "infinite") +
                       "; render it again, or allow it where the option --allow-nan is offered");
  }
}

/// Sets OpenEXR's limits of size, which hold for the whole process, at the first call.
void limit_openexr() {
  static const bool done = [] {
    Imf::Header::setMaxImageSize(65536, 65536);
    Imf::Header::setMaxTileSize(65536, 65536);
    return true;
  }();
  (void)done;
}

}  // namespace

void save_exr(const std::string& path, const Image& image, const ExrWriteOptions& options) {
  check_writable(path, image, options.half);
  std::vector<std::string> slabs((std::size_t(image.height) + kSlabLines - 1) / kSlabLines);
  parallel_chunks(std::size_t(image.height), kSlabLines, [&](std::size_t first, std::size_t last) {
    slabs[first / kSlabLines] = encode_slab(image, options, int(first), int(last - first));
  });
  slabs.insert(slabs.begin(), make_head(make_header(image, options), slabs));
  write_pieces(path, slabs);
}

Image load_exr(const std::string& path, const ExrReadOptions& options) {
  limit_openexr();
  const ByteFile file(path);
  const ExrClaims claims = read_exr_claims(file, options.max_pixels);
  Image image;
  try {
    image = read_data_window(file, claims, options);
  } catch (const InputError&) { throw; } catch (const ResourceError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw ResourceError(path + ": not enough memory for its pixels");
  } catch (const std::exception& e) {
    throw InputError(path + ": pixels: " + one_line(e.what()) + "; the file is damaged or truncated: write it again");
  }
  if (options.our_names) name_as_ours(image);
  if (claims.data != claims.display) image = placed(std::move(image), claims.data, claims.display);
  if (!options.allow_nan) check_numbers(path, image);
  return image;
}

}  // namespace tempolux
