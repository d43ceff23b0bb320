#include "formats/radsamples/radsamples.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "formats/base_file.h"
#include "formats/container.h"
#include "formats/exact_sum.h"
#include "formats/float_bits.h"
#include "formats/hash.h"

namespace tempolux::formats {
namespace {

constexpr Format kFormat{{"\x89TRADS\r\n", 8}, ".radsamples", "gather-temporal", 1, 1};
constexpr std::uint16_t kBaseSince = 1;   ///< minor version
constexpr std::string_view kPointsMark = "RADP", kRecordsMark = "RADR", kSamplesMark = "RADS";
constexpr std::size_t kPointSize = 12, kSampleSize = 8, kAnchorSize = 4, kEndBodySize = 48;
constexpr std::uint32_t kNoAnchor = 0xffffffff;

/// What is wrong with the values, as the reader and the writer both see it; "" if nothing.
std::string_view fault_of(const RadsamplesHeader& h) {
  if (!std::isfinite(h.diagonal) || h.diagonal <= 0) return "diagonal is not a length above 0";
  if (h.segment[0] > h.segment[1]) return "segment ends before it begins";
  if (h.anchors == h.points_hash.empty()) return "points go with the column anchor";
  if (const std::string_view fault = fault_of_base(h.base_name, h.base_digest); !fault.empty()) return fault;
  return fault_of_common(h.origin, h.identity);
}

Line take_line(std::string_view key, std::string_view value, std::uint16_t minor, RadsamplesHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "columns") return h.anchors = value == "anchor", result(h.anchors || value == "none");
  if (key == "diagonal") return result(parse_numbers(value, &h.diagonal, 1));
  if (key == "segment") return result(parse_numbers(value, h.segment.data(), 2));
  if (key == "points") {
    h.points_hash = value;
    return result(!value.empty() && value.size() <= 128 && value.find(' ') == value.npos);
  }
  if (minor >= kBaseSince && key == "base") return h.base_name = value, result(!value.empty());
  if (minor >= kBaseSince && key == "base-digest") return h.base_digest = value, result(!value.empty());
  return take_common_line(key, value, common_keys(h));
}

std::string header_text(const RadsamplesHeader& h) {
  HeaderText text("radsamples");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.line("columns", h.anchors ? "anchor" : "none");
  text.origin(h.origin);
  text.line("diagonal", text_of(h.diagonal));
  text.line("segment", text_of(h.segment[0]) + " " + text_of(h.segment[1]));
  if (h.anchors) text.line("points", h.points_hash);
  if (!h.base_name.empty()) {
    text.line("base", h.base_name);
    text.line("base-digest", h.base_digest);
  }
  text.identity(h.identity);
  text.history(h.history);
  return text.finish();
}

std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, bool allow_unknown, RadsamplesHeader& h) {
  h = RadsamplesHeader();
  constexpr std::array<std::string_view, 4> required{"columns", "origin", "diagonal", "segment"};
  const auto take = [&](std::string_view key, std::string_view value) { return take_line(key, value, minor, h); };
  if (auto error = parse_lines(text, allow_unknown, required, take)) return error;
  if (const std::string_view fault = fault_of(h); !fault.empty()) return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

bool is_share(float x) { return is_finite(x) && x >= 0; }
bool is_length(float x) { return is_finite(x) && x > 0; }
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::string_view fault_of(const RadsamplesRecord& r) {
  double square = 0;
  for (float x : r.normal) square += double(x) * double(x);
  if (!is_finite(r.position)) return "position is not finite";
  if (!is_finite(r.normal) || !(std::abs(square - 1) <= 2e-4)) return "normal is not of length 1";
  if (!is_share(r.barycentric[0]) || !is_share(r.barycentric[1]) || r.barycentric[0] + r.barycentric[1] > 1.0001f)
    return "place is not in its triangle";
  if (r.rings < 1 || r.sectors < 3) return "there are no cells";
  if (static_cast<unsigned>(r.set) > 1) return "set is neither 0 nor 1";
  if (r.fading > 3) return "fading is above 3";
  if (!is_share(r.footprint) || !is_share(r.expected_share) || !is_share(r.lit_share) || !is_share(r.further_share) ||
      !is_share(r.birth_weight))
    return "a share, a weight or the footprint is not finite or is negative";
  if (!is_length(r.radius)) return "radius is not a length above 0";
  if (r.radius_unclamped != kInfinity && !is_share(r.radius_unclamped)) return "unclamped radius is not a number or is negative";
  if (!is_finite(r.irradiance) || is_negative(r.irradiance)) return "irradiance is not finite or is negative";
  for (std::size_t c = 0; c < 3; ++c)
    if (!is_finite(r.rotational[c]) || !is_finite(r.translational[c])) return "a gradient is not finite";
  if (!(r.clearance_reach > 0)) return "clearance does not reach anywhere";
  return "";
}

/// anchor: FFFFFFFF without the column.
std::string_view fault_of(const RadianceSample& s, std::uint32_t anchor, std::size_t points) {
  if (age_of(s) == 0) return "age is 0";
  if (!(s.flags & sample_valid)) {
    const bool dark = s.rgbe == std::array<std::uint8_t, 4>{} && s.distance == 0;
    return s.flags <= kMaxAge && dark && anchor == kNoAnchor ? "" : "an invalid sample holds something";
  }
  if ((s.distance & 0x8000) || (s.distance & 0x7c00) == 0x7c00) return "distance is negative or not finite";
  if (s.flags & sample_miss) {
    if (s.distance != 0 || s.flags & (sample_dynamic | sample_near | sample_anchored)) return "a miss met something";
  } else if (s.distance < 0x0400) {
    return "distance is below 2^-14";
  }
  if (bool(s.flags & sample_anchored) != (anchor != kNoAnchor)) return "anchor and flags differ";
  if (anchor != kNoAnchor && anchor >= points) return "anchor is none of the points";
  return "";
}

std::uint64_t samples_of(std::span<const RadsamplesRecord> records) {
  std::uint64_t count = 0;
  for (const RadsamplesRecord& record : records) count += record.samples();
  return count;
}

/// Does a record of the file have its own samples in it? Always, but in overlays.
bool is_own(const RadsamplesFile& file, std::size_t record) { return file.kept_from.empty() || file.kept_from[record] == 0; }
std::uint64_t own_samples(const RadsamplesFile& file) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < file.records.size(); ++i)
    if (is_own(file, i)) count += file.records[i].samples();
  return count;
}

struct Totals {
  std::uint64_t points = 0, records = 0, samples = 0;
  std::array<double, 3> irradiance{};
};

Totals totals_of(const RadsamplesFile& file) {
  ExactRgbSum sum;
  for (const RadsamplesRecord& record : file.records) sum.add(record.irradiance);
  return {file.point_light.size(), file.records.size(), own_samples(file), sum.rounded()};
}

void refuse_bad(const RadsamplesFile& file) {
  const auto refuse = [](std::string_view what, std::size_t i, std::string_view fault) {
    throw std::invalid_argument("write_radsamples: " + std::string(what) + " " + std::to_string(i) + ": " + std::string(fault));
  };
  for (std::size_t i = 0; i < file.point_light.size(); ++i)
    if (!is_finite(file.point_light[i]) || is_negative(file.point_light[i])) refuse("point", i, "light is not finite or is negative");
  for (std::size_t i = 0; i < file.records.size(); ++i)
    if (const std::string_view fault = fault_of(file.records[i]); !fault.empty()) refuse("record", i, fault);
  if (file.kept_from.size() != (file.header.base_name.empty() ? 0 : file.records.size())) refuse("records", file.kept_from.size(), "are not told from the base's");
  if (samples_of(file.records) != file.samples.size()) refuse("samples", file.samples.size(), "are not those of the records");
  if (file.anchors.size() != (file.header.anchors ? file.samples.size() : 0)) refuse("anchors", file.anchors.size(), "are not one a sample");
  for (std::size_t i = 0; i < file.samples.size(); ++i)
    if (const auto fault = fault_of(file.samples[i], file.header.anchors ? file.anchors[i] : kNoAnchor, file.point_light.size()); !fault.empty())
      refuse("sample", i, fault);
}

/// Blocks of kMaxBlockCount values; `column` adds a block's column, if there is one.
template <class T, class Column>
void write_blocks(ContainerWriter& out, std::string_view mark, std::span<const T> values, const Column& column) {
  for (std::size_t first = 0; first < values.size(); first += kMaxBlockCount) {
    const std::size_t count = std::min<std::size_t>(values.size() - first, kMaxBlockCount);
    std::string body;
    body.reserve(count * (sizeof(T) + kAnchorSize));
    put_array(body, values.subspan(first, count));
    column(first, count, body);
    out.write_block(mark, {std::uint32_t(count)}, body);
  }
}

/// Reads blocks of one mark after the other.
class Blocks {
 public:
  explicit Blocks(ContainerReader& in) : in_(in), mark_(in.read_mark()) {}

  /// The next block if it has this mark; its body, count * size bytes, and where it begins.
  bool next(std::string_view mark, std::size_t size) {
    if (mark_ != mark) return false;
    std::uint32_t entries = 0;
    in_.read_head(mark_, {&entries, 1}, "the head of a block");
    if (entries > kMaxBlockCount) in_.bytes().fail(in_.body_offset() - 8, "block of " + std::to_string(entries) + " entries; 65536 at most");
    in_.bytes().expect(std::uint64_t(entries) * size, "a block");
    count = entries;
    body.resize(count * size);
    in_.read_body(body.data(), body.size(), "a block");
    in_.end_block("a block");
    mark_ = in_.read_mark();
    return true;
  }
  [[noreturn]] void fail(std::size_t offset, std::string_view fault) const {
    in_.bytes().fail(in_.body_offset() + offset, std::string(fault), "correct the program that wrote it");
  }
  void expect_end() const {
    if (mark_ != kEndMark) in_.bytes().fail(in_.bytes().offset() - kMarkSize, "unknown mark of a block, or blocks in another order");
  }
  std::vector<char> body;
  std::size_t count = 0;

 private:
  ContainerReader& in_;
  std::string mark_;
};

void read_samples(Blocks& blocks, RadsamplesFile& file) {
  const std::uint64_t wanted = own_samples(file);
  const std::size_t size = kSampleSize + (file.header.anchors ? kAnchorSize : 0);
  while (blocks.next(kSamplesMark, size)) {
    const std::size_t first = file.samples.size();
    if (first % kMaxBlockCount != 0) blocks.fail(0, "a block of samples before this one is not full");
    if (first + blocks.count > wanted) blocks.fail(0, "more samples than the records have");
    file.samples.resize(first + blocks.count);
    std::memcpy(static_cast<void*>(file.samples.data() + first), blocks.body.data(), blocks.count * kSampleSize);
    if (file.header.anchors) {
      file.anchors.resize(first + blocks.count);
      std::memcpy(file.anchors.data() + first, blocks.body.data() + blocks.count * kSampleSize, blocks.count * kAnchorSize);
    }
    for (std::size_t i = 0; i < blocks.count; ++i)
      if (const std::string_view fault = fault_of(file.samples[first + i], file.header.anchors ? file.anchors[first + i] : kNoAnchor,
                                                  file.point_light.size()); !fault.empty())
        blocks.fail(i * kSampleSize, fault);
  }
  if (file.samples.size() != wanted) blocks.fail(0, "fewer samples than the records have");
}

/// What an overlay holds: records that say where their samples are, and the samples that are not the base's.
struct OwnParts {
  std::vector<RadsamplesRecord> records;
  std::vector<RadianceSample> samples;
  std::vector<std::uint32_t> anchors;
};

OwnParts own_parts(const RadsamplesFile& file) {
  OwnParts own{file.records, {}, {}};
  auto first = std::ptrdiff_t(0);
  for (std::size_t i = 0; i < file.records.size(); ++i) {
    own.records[i].reserved = file.kept_from[i];
    const auto last = first + std::ptrdiff_t(file.records[i].samples());
    if (is_own(file, i)) {
      own.samples.insert(own.samples.end(), file.samples.begin() + first, file.samples.begin() + last);
      if (file.header.anchors) own.anchors.insert(own.anchors.end(), file.anchors.begin() + first, file.anchors.begin() + last);
    }
    first = last;
  }
  return own;
}

/// Puts the base's samples where records have those. `fail` receives what is wrong.
template <class Fail>
void take_from_base(RadsamplesFile& file, const RadsamplesFile& base, const Fail& fail) {
  const RadsamplesHeader &a = file.header, &b = base.header;
  if (a.anchors != b.anchors || a.points_hash != b.points_hash || a.diagonal != b.diagonal || a.segment != b.segment ||
      file.point_light.size() != base.point_light.size())
    fail("its base " + a.base_name + " has other columns, points, segment or diagonal");
  if (digest_of(base) != a.base_digest) fail("its base " + a.base_name + " has another digest than when the overlay was written");
  std::vector<std::size_t> first_of;   // sample of each of the base's records
  std::size_t samples = 0;
  for (const RadsamplesRecord& record : base.records) first_of.push_back(std::exchange(samples, samples + record.samples()));
  std::vector<RadianceSample> own = std::move(file.samples);
  std::vector<std::uint32_t> own_anchors = std::move(file.anchors);
  file.samples.clear(), file.anchors.clear();
  std::size_t next = 0;
  for (std::size_t i = 0; i < file.records.size(); ++i) {
    const bool is_mine = is_own(file, i);
    const std::size_t there = file.kept_from[i] - std::size_t(1), count = file.records[i].samples();
    if (!is_mine && (there >= base.records.size() || base.records[there].rings != file.records[i].rings ||
                     base.records[there].sectors != file.records[i].sectors))
      fail("record " + std::to_string(i) + " has samples of a record that its base " + a.base_name + " does not have");
    const auto from = std::ptrdiff_t(is_mine ? std::exchange(next, next + count) : first_of[there]), to = from + std::ptrdiff_t(count);
    const auto& source = is_mine ? own : base.samples;
    const auto& anchors = is_mine ? own_anchors : base.anchors;
    file.samples.insert(file.samples.end(), source.begin() + from, source.begin() + to);
    if (a.anchors) file.anchors.insert(file.anchors.end(), anchors.begin() + from, anchors.begin() + to);
  }
}

RadsamplesFile load(const std::string& path, bool is_base);

}  // namespace

void write_radsamples(const std::function<void(const void*, std::size_t)>& sink, const RadsamplesFile& file) {
  refuse_bad(file);
  Format format = kFormat;
  format.minor = file.header.base_name.empty() ? 0 : kBaseSince;
  ContainerWriter out(sink, format, header_text(file.header));
  const auto none = [](std::size_t, std::size_t, std::string&) {};
  write_blocks<std::array<float, 3>>(out, kPointsMark, file.point_light, none);
  OwnParts own;
  if (!file.kept_from.empty()) own = own_parts(file);
  const auto& anchors = file.kept_from.empty() ? file.anchors : own.anchors;
  write_blocks<RadsamplesRecord>(out, kRecordsMark, file.kept_from.empty() ? file.records : own.records, none);
  write_blocks<RadianceSample>(out, kSamplesMark, file.kept_from.empty() ? file.samples : own.samples,
                               [&](std::size_t first, std::size_t count, std::string& body) {
                                 if (file.header.anchors) put_array(body, std::span(anchors).subspan(first, count));
                               });
  const Totals totals = totals_of(file);
  std::string body;
  put(body, totals.points);
  put(body, totals.records);
  put(body, totals.samples);
  put(body, totals.irradiance);
  out.finish(body);
}

RadsamplesFile load_radsamples(const std::string& path) { return load(path, false); }

namespace {

RadsamplesFile load(const std::string& path, bool is_base) {
  ContainerReader in(path, kFormat);
  RadsamplesFile file;
  in.expect_good(parse_header_text(in.text(), in.minor(), in.later_minor(), file.header));
  const bool overlay = !file.header.base_name.empty();
  if (overlay && is_base) in.bytes().fail(kHeaderFixedSize, "it is the base of an overlay and an overlay itself", "make both again");
  Blocks blocks(in);
  while (blocks.next(kPointsMark, kPointSize))
    for (std::size_t i = 0; i < blocks.count; ++i) {
      file.point_light.push_back(get<std::array<float, 3>>(blocks.body.data() + i * kPointSize));
      if (!is_finite(file.point_light.back()) || is_negative(file.point_light.back()))
        blocks.fail(i * kPointSize, "light of a point is not finite or is negative");
    }
  if (!file.header.anchors && !file.point_light.empty()) blocks.fail(0, "light of points without the column anchor");
  while (blocks.next(kRecordsMark, sizeof(RadsamplesRecord)))
    for (std::size_t i = 0; i < blocks.count; ++i) {
      file.records.push_back(get<RadsamplesRecord>(blocks.body.data() + i * sizeof(RadsamplesRecord)));
      const std::uint32_t kept_from = std::exchange(file.records.back().reserved, 0);
      if (overlay) file.kept_from.push_back(kept_from);
      if (const std::string_view fault = fault_of(file.records.back()); !fault.empty()) blocks.fail(i * sizeof(RadsamplesRecord), fault);
    }
  read_samples(blocks, file);
  blocks.expect_end();
  const std::string end = in.read_end(kEndBodySize);
  const Totals totals = totals_of(file);
  if (get<std::uint64_t>(end.data()) != totals.points || get<std::uint64_t>(end.data() + 8) != totals.records ||
      get<std::uint64_t>(end.data() + 16) != totals.samples)
    in.bytes().fail(in.body_offset(), "end block does not count the file's points, records and samples");
  if (get<std::array<double, 3>>(end.data() + 24) != totals.irradiance)
    in.bytes().fail(in.body_offset() + 24, "total is not the sum of the records' irradiance");
  in.bytes().expect_end();
  if (overlay)
    take_from_base(file, load(path_of_base(path, file.header.base_name), true),
                   [&](const std::string& fault) { in.bytes().fail(kHeaderFixedSize, fault, "make both again"); });
  return file;
}

}  // namespace

std::string digest_of(const RadsamplesFile& file) {
  const auto hash = [](const auto& values) {
    Hasher hasher;
    hasher.add_bytes(values.data(), values.size() * sizeof(values[0]));
    return std::to_string(values.size()) + " #" + hasher.hex() + "\n";
  };
  const std::array<double, 1> diagonal{file.header.diagonal};
  return hash_hex("radsamples: 1\norigin: " + hex_of(file.header.origin) + "\ndiagonal: " + hex_of(diagonal) +
                  "\npoints: " + hash(file.point_light) + "records: " + hash(file.records) + "samples: " + hash(file.samples) +
                  "anchors: " + hash(file.anchors));
}

}  // namespace tempolux::formats
