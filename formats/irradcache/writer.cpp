// formats/irradcache/writer.cpp -- writes .irradcache files.
#include <algorithm>
#include <stdexcept>

#include "formats/irradcache/layout.h"

namespace tempolux::formats {

using namespace irradcache;

struct IrradcacheWriter::State {
  ContainerWriter out;
  std::uint32_t columns;
  RecordSums sums;
  std::uint64_t count = 0;

  State(ContainerWriter::Sink sink, const IrradcacheHeader& header)
      : out(std::move(sink), format_of(header), header_text(header)), columns(header.columns) {}
  void write_block(std::span<const IrradianceCacheRecord> records);
};

/// Writes at most kMaxBlockCount records: the records first, then their optional columns.
void IrradcacheWriter::State::write_block(std::span<const IrradianceCacheRecord> records) {
  std::string body;
  body.reserve(records.size() * record_size(columns));
  for (IrradianceCacheRecord record : records) {
    record.reserved = 0;
    body.append(reinterpret_cast<const char*>(&record), kRecordSize);
    sums.add(record);
  }
  if (columns & column_influence)
    for (const IrradianceCacheRecord& record : records) put(body, record.influence);
  if (columns & column_update)
    for (const IrradianceCacheRecord& record : records) put(body, record.update);
  if (columns & column_clearance)
    for (const IrradianceCacheRecord& record : records) {
      put(body, record.clearance_reach);
      put(body, record.clearance);
    }
  if (columns & column_noise)
    for (const IrradianceCacheRecord& record : records) put(body, record.noise);
  out.write_block(kBlockMark, {std::uint32_t(records.size())}, body);
}

IrradcacheWriter::IrradcacheWriter(std::function<void(const void*, std::size_t)> sink, const IrradcacheHeader& header)
    : state_(std::make_unique<State>(std::move(sink), header)) {}
IrradcacheWriter::~IrradcacheWriter() = default;

void IrradcacheWriter::write(std::span<const IrradianceCacheRecord> records) {
  State& s = *state_;
  if (s.out.finished()) throw std::invalid_argument("IrradcacheWriter: records after the end");
  for (std::size_t i = 0; i < records.size(); ++i)
    if (const std::string_view fault = fault_of(records[i], s.columns); !fault.empty())
      throw std::invalid_argument("IrradcacheWriter: record " + std::to_string(s.count + i) + ": " +
                                  std::string(fault));
  for (std::size_t first = 0; first < records.size(); first += kMaxBlockCount)
    s.write_block(records.subspan(first, std::min<std::size_t>(records.size() - first, kMaxBlockCount)));
  s.count += records.size();
}

IrradcacheTotals IrradcacheWriter::finish() {
  State& s = *state_;
  if (s.out.finished()) throw std::invalid_argument("IrradcacheWriter: finished twice");
  const IrradcacheTotals totals = s.sums.totals();
  std::string body;
  put(body, totals.record_count);
  put(body, totals.irradiance);
  s.out.finish(body);
  return totals;
}

}  // namespace tempolux::formats
