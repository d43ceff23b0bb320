// formats/irradpoints/reader.cpp -- reads .irradpoints files.
#include "formats/irradpoints/layout.h"

namespace tempolux::formats {
namespace {

using namespace irradpoints;

/// Parses the points in the body of a block and appends them.
void append_points(const std::vector<char>& body, const IrradpointsHeader& header, const ContainerReader& in,
                   std::vector<IrradiancePointRecord>& points, PointSums& sums) {
  const unsigned kinds = kinds_of(header.kinds);
  const std::size_t count = body.size() / point_size(kinds, header.columns);
  const char* column = body.data() + count * kPointSize;
  const std::size_t first = points.size();
  points.resize(first + count);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(static_cast<void*>(&points[first + i]), body.data() + i * kPointSize, kPointSize);
    points[first + i].reserved = 0;
  }
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    if (!((kinds >> k) & 1)) continue;
    for (std::size_t i = 0; i < count; ++i)
      points[first + i].*kKinds[k].irradiance = get<std::array<float, 3>>(column + i * kIrradianceSize);
    column += count * kIrradianceSize;
  }
  if (header.columns & column_points_noise)
    for (std::size_t i = 0; i < count; ++i)
      points[first + i].noise = get<std::array<float, 3>>(column + i * kIrradianceSize);
  for (std::size_t i = 0; i < count; ++i) {
    if (const std::string_view fault = fault_of(points[first + i], kinds, header.columns); !fault.empty())
      in.bytes().fail(in.body_offset() + i * kPointSize,
                      "point " + std::to_string(i) + " of the block: " + std::string(fault),
                      "correct the program that wrote it");
    sums.add(points[first + i]);
  }
}

IrradpointsTotals read_totals(ContainerReader& in, const IrradpointsTotals& sums) {
  const std::string end = in.read_end(kEndBodySize);
  IrradpointsTotals totals;
  totals.point_count = get<std::uint64_t>(end.data());
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    totals.*kKinds[k].total = get<std::array<double, 3>>(end.data() + 8 + 24 * k);
  if (totals.point_count != sums.point_count)
    in.bytes().fail(in.body_offset(), "end block counts " + std::to_string(totals.point_count) +
                                          " points, the file has " + std::to_string(sums.point_count));
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    if (totals.*kKinds[k].total != sums.*kKinds[k].total)
      in.bytes().fail(in.body_offset() + 8 + 24 * k,
                      "total of kind " + std::string(kKinds[k].name) + " is not the sum of the points' irradiance");
  in.bytes().expect_end();
  return totals;
}

}  // namespace

IrradpointsFile load_irradpoints(const std::string& path) {
  ContainerReader in(path, kFormat);
  IrradpointsFile file;
  in.expect_good(parse_header_text(in.text(), in.minor(), file.header));
  const std::size_t size = point_size(kinds_of(file.header.kinds), file.header.columns);
  file.records.reserve(in.bytes().size() / size);
  PointSums sums;
  std::vector<char> body;
  while (in.read_records(kBlockMark, size, body)) append_points(body, file.header, in, file.records, sums);
  file.totals = read_totals(in, sums.totals());
  return file;
}

}  // namespace tempolux::formats
