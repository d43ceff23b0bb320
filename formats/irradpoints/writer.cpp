// formats/irradpoints/writer.cpp -- writes .irradpoints files.
#include <algorithm>
#include <stdexcept>

#include "formats/irradpoints/layout.h"

namespace tempolux::formats {

using namespace irradpoints;

struct IrradpointsWriter::State {
  ContainerWriter out;
  unsigned kinds;
  std::uint32_t columns;
  PointSums sums;
  std::uint64_t count = 0;

  State(ContainerWriter::Sink sink, const IrradpointsHeader& header)
      : out(std::move(sink), format_of(header), header_text(header)),
        kinds(kinds_of(header.kinds)),
        columns(header.columns) {}
  void write_block(std::span<const IrradiancePointRecord> points);
};

/// Writes at most kMaxBlockCount points: their places first, then the irradiance of each kind and the other columns.
void IrradpointsWriter::State::write_block(std::span<const IrradiancePointRecord> points) {
  std::string body;
  body.reserve(points.size() * point_size(kinds, columns));
  for (IrradiancePointRecord point : points) {
    point.reserved = 0;
    body.append(reinterpret_cast<const char*>(&point), kPointSize);
  }
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    if ((kinds >> k) & 1)
      for (const IrradiancePointRecord& point : points) put(body, point.*kKinds[k].irradiance);
  if (columns & column_points_noise)
    for (const IrradiancePointRecord& point : points) put(body, point.noise);
  for (const IrradiancePointRecord& point : points) sums.add(point);
  out.write_block(kBlockMark, {std::uint32_t(points.size())}, body);
}

IrradpointsWriter::IrradpointsWriter(std::function<void(const void*, std::size_t)> sink,
                                     const IrradpointsHeader& header)
    : state_(std::make_unique<State>(std::move(sink), header)) {}
IrradpointsWriter::~IrradpointsWriter() = default;

void IrradpointsWriter::write(std::span<const IrradiancePointRecord> points) {
  State& s = *state_;
  if (s.out.finished()) throw std::invalid_argument("IrradpointsWriter: points after the end");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const std::string_view fault = fault_of(points[i], s.kinds, s.columns); !fault.empty())
      throw std::invalid_argument("IrradpointsWriter: point " + std::to_string(s.count + i) + ": " +
                                  std::string(fault));
  for (std::size_t first = 0; first < points.size(); first += kMaxBlockCount)
    s.write_block(points.subspan(first, std::min<std::size_t>(points.size() - first, kMaxBlockCount)));
  s.count += points.size();
}

IrradpointsTotals IrradpointsWriter::finish() {
  State& s = *state_;
  if (s.out.finished()) throw std::invalid_argument("IrradpointsWriter: finished twice");
  const IrradpointsTotals totals = s.sums.totals();
  std::string body;
  put(body, totals.point_count);
  for (const Kind& kind : kKinds) put(body, totals.*kind.total);
  s.out.finish(body);
  return totals;
}

}  // namespace tempolux::formats
