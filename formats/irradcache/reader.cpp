// formats/irradcache/reader.cpp -- reads .irradcache files.
#include "formats/irradcache/layout.h"

namespace tempolux::formats {
namespace {

using namespace irradcache;

/// Parses the records in the body of a block and appends them.
void append_records(const std::vector<char>& body, std::uint32_t columns, const ContainerReader& in,
                    std::vector<IrradianceCacheRecord>& records, RecordSums& sums) {
  const std::size_t count = body.size() / record_size(columns);
  const char* influences = body.data() + count * kRecordSize;
  const char* updates = influences + (columns & column_influence ? count * kInfluenceSize : 0);
  const char* clearances = updates + (columns & column_update ? count * kUpdateSize : 0);
  const char* noises = clearances + (columns & column_clearance ? count * kClearanceSize : 0);
  for (std::size_t i = 0; i < count; ++i) {
    IrradianceCacheRecord& record = records.emplace_back();
    std::memcpy(static_cast<void*>(&record), body.data() + i * kRecordSize, kRecordSize);
    record.reserved = 0;
    if (columns & column_influence) record.influence = get<float>(influences + i * kInfluenceSize);
    if (columns & column_update) record.update = get<std::array<float, 3>>(updates + i * kUpdateSize);
    if (columns & column_clearance) {
      record.clearance_reach = get<float>(clearances + i * kClearanceSize);
      record.clearance = get<std::array<std::uint8_t, 16>>(clearances + i * kClearanceSize + 4);
    }
    if (columns & column_noise) record.noise = get<std::array<float, 3>>(noises + i * kNoiseSize);
    if (const std::string_view fault = fault_of(record, columns); !fault.empty())
      in.bytes().fail(in.body_offset() + i * kRecordSize,
                      "record " + std::to_string(i) + " of the block: " + std::string(fault),
                      "correct the program that wrote it");
    sums.add(record);
  }
}

IrradcacheTotals read_totals(ContainerReader& in, const IrradcacheTotals& sums) {
  const std::string end = in.read_end(kEndBodySize);
  const IrradcacheTotals totals{get<std::uint64_t>(end.data()), get<std::array<double, 3>>(end.data() + 8)};
  if (totals.record_count != sums.record_count)
    in.bytes().fail(in.body_offset(), "end block counts " + std::to_string(totals.record_count) +
                                          " records, the file has " + std::to_string(sums.record_count));
  if (totals.irradiance != sums.irradiance)
    in.bytes().fail(in.body_offset() + 8, "total is not the sum of the records' irradiance");
  in.bytes().expect_end();
  return totals;
}

}  // namespace

IrradcacheFile load_irradcache(const std::string& path) {
  ContainerReader in(path, kFormat);
  IrradcacheFile file;
  in.expect_good(parse_header_text(in.text(), in.minor(), file.header));
  const std::uint32_t columns = file.header.columns;
  file.records.reserve(in.bytes().size() / record_size(columns));
  RecordSums sums;
  std::vector<char> body;
  while (in.read_records(kBlockMark, record_size(columns), body)) append_records(body, columns, in, file.records, sums);
  file.totals = read_totals(in, sums.totals());
  return file;
}

}  // namespace tempolux::formats
