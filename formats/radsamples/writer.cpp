#include <stdexcept>

#include "formats/float_bits.h"
#include "formats/radsamples/layout.h"

namespace tempolux::formats {

using namespace radsamples;

namespace {

[[noreturn]] void refuse(std::string_view what, std::size_t i, std::string_view fault) {
  throw std::invalid_argument("write_radsamples: " + std::string(what) + " " + std::to_string(i) + ": " +
                              std::string(fault));
}

void refuse_bad(const RadsamplesFile& file) {
  for (std::size_t i = 0; i < file.point_light.size(); ++i)
    if (!is_finite(file.point_light[i]) || is_negative(file.point_light[i]))
      refuse("point", i, "light is not finite or is negative");
  for (std::size_t i = 0; i < file.records.size(); ++i)
    if (const std::string_view fault = fault_of(file.records[i]); !fault.empty()) refuse("record", i, fault);
  if (file.kept_from.size() != (file.header.base_name.empty() ? 0 : file.records.size()))
    refuse("kept_from", file.kept_from.size(),
           "is a wrong number of entries: an overlay has one for each record, any other file none");
}

Format format_of(const RadsamplesHeader& header) {
  Format format = kFormat;
  format.minor = !header.high_hash.empty() ? kHighSince : !header.base_name.empty() ? kBaseSince : 0;
  return format;
}

/// Writes values as blocks of at most kMaxBlockCount.
template <class T>
void write_blocks(ContainerWriter& out, std::string_view mark, std::span<const T> values) {
  for (std::size_t first = 0; first < values.size(); first += kMaxBlockCount) {
    const std::size_t count = std::min<std::size_t>(values.size() - first, kMaxBlockCount);
    std::string body;
    body.reserve(count * sizeof(T));
    put_array(body, values.subspan(first, count));
    out.write_block(mark, {std::uint32_t(count)}, body);
  }
}

std::vector<RadsamplesRecord> with_their_base(const RadsamplesFile& file) {
  std::vector<RadsamplesRecord> records = file.records;
  for (std::size_t i = 0; i < file.kept_from.size(); ++i) records[i].reserved = file.kept_from[i];
  return records;
}

}  // namespace

struct RadsamplesWriter::State {
  const RadsamplesFile& head;
  ContainerWriter out;
  std::size_t next = 0;                 ///< number of the next record
  std::vector<RadianceSample> samples;  ///< of the block that is being filled
  std::vector<std::uint32_t> anchors;

  void write_block(std::size_t count) {
    std::string body;
    body.reserve(count * (kSampleSize + kAnchorSize));
    put_array(body, std::span<const RadianceSample>(samples).first(count));
    if (head.header.anchors) put_array(body, std::span<const std::uint32_t>(anchors).first(count));
    out.write_block(kSamplesMark, {std::uint32_t(count)}, body);
    samples.erase(samples.begin(), samples.begin() + std::ptrdiff_t(count));
    if (head.header.anchors) anchors.erase(anchors.begin(), anchors.begin() + std::ptrdiff_t(count));
  }
};

RadsamplesWriter::RadsamplesWriter(std::function<void(const void*, std::size_t)> sink, const RadsamplesFile& head) {
  refuse_bad(head);
  state_ = std::make_unique<State>(
      State{head, ContainerWriter(std::move(sink), format_of(head.header), header_text(head.header)), 0, {}, {}});
  write_blocks<std::array<float, 3>>(state_->out, kPointsMark, head.point_light);
  write_blocks<RadsamplesRecord>(state_->out, kRecordsMark, with_their_base(head));
}

RadsamplesWriter::~RadsamplesWriter() = default;

void RadsamplesWriter::write(std::span<const RadianceSample> samples, std::span<const std::uint32_t> anchors) {
  State& s = *state_;
  const RadsamplesFile& head = s.head;
  if (s.next == head.records.size()) refuse("samples", samples.size(), "are of no record");
  if (samples.size() != head.records[s.next].samples())
    refuse("samples", samples.size(), "are not those of the records");
  if (anchors.size() != (head.header.anchors ? samples.size() : 0))
    refuse("anchors", anchors.size(), "are not one a sample");
  if (!is_own(head, s.next++)) return;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (const auto fault = fault_of(samples[i], head.header.anchors ? anchors[i] : kNoAnchor, head.point_light.size());
        !fault.empty())
      refuse("sample", i, fault);
  s.samples.insert(s.samples.end(), samples.begin(), samples.end());
  s.anchors.insert(s.anchors.end(), anchors.begin(), anchors.end());
  while (s.samples.size() >= kMaxBlockCount) s.write_block(kMaxBlockCount);
}

void RadsamplesWriter::finish() {
  State& s = *state_;
  if (s.next != s.head.records.size()) refuse("samples", s.next, "records have theirs, not all");
  if (!s.samples.empty()) s.write_block(s.samples.size());
  const Totals totals = totals_of(s.head);
  std::string body;
  put(body, totals.points);
  put(body, totals.records);
  put(body, totals.samples);
  put(body, totals.irradiance);
  s.out.finish(body);
}

void write_radsamples(const std::function<void(const void*, std::size_t)>& sink, const RadsamplesFile& file) {
  RadsamplesWriter writer(sink, file);
  const std::span<const RadianceSample> samples = file.samples;
  const std::span<const std::uint32_t> anchors = file.anchors;
  std::size_t first = 0;
  for (const RadsamplesRecord& record : file.records) {
    const std::size_t begin = std::min(first, samples.size()), from = std::min(first, anchors.size());
    first += record.samples();
    writer.write(samples.subspan(begin, std::min(record.samples(), samples.size() - begin)),
                 anchors.subspan(from, std::min(record.samples(), anchors.size() - from)));
  }
  if (samples.size() > first || anchors.size() > first)
    refuse("samples", samples.size(), "are not those of the records");
  writer.finish();
}

}  // namespace tempolux::formats
