// formats/irradpoints/records.cpp -- checks and sums points, and computes the digest (irradpoints.md).
#include "formats/float_bits.h"
#include "formats/hash.h"
#include "formats/irradpoints/layout.h"

namespace tempolux::formats {
namespace irradpoints {

std::string_view fault_of(const IrradiancePointRecord& point, unsigned kinds, std::uint32_t columns) {
  if (!is_finite(point.position)) return "position is not finite";
  if (point.normal[0] == 0xffff || point.normal[1] == 0xffff) return "normal is above 65534";
  if (static_cast<unsigned>(point.set) > 1) return "set is neither 0 nor 1";
  if (!is_finite(point.radius) || is_negative(point.radius)) return "radius is not finite or is negative";
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    const std::array<float, 3>& irradiance = point.*kKinds[k].irradiance;
    if (!is_finite(irradiance)) return "irradiance is not finite";
    if (is_negative(irradiance)) return "irradiance is negative";
    if (!((kinds >> k) & 1) && !is_zero(irradiance)) return "irradiance of a kind that the header does not name";
  }
  if (!is_finite(point.noise)) return "noise is not finite";
  if (!columns && !is_zero(point.noise)) return "noise without its column";
  return "";
}

void PointSums::add(const IrradiancePointRecord& point) {
  ++count_;
  for (std::size_t k = 0; k < kKinds.size(); ++k) sums_[k].add(point.*kKinds[k].irradiance);
}

IrradpointsTotals PointSums::totals() const {
  IrradpointsTotals totals;
  totals.point_count = count_;
  for (std::size_t k = 0; k < kKinds.size(); ++k) totals.*kKinds[k].total = sums_[k].rounded();
  return totals;
}

}  // namespace irradpoints

std::string digest_of(const IrradpointsFile& file) {
  using namespace irradpoints;
  const unsigned kinds = kinds_of(file.header.kinds);
  Hasher points;
  std::array<Hasher, 3> columns;
  Hasher noise;
  for (IrradiancePointRecord point : file.records) {
    point.reserved = 0;
    points.add_bytes(&point, kPointSize);
    for (std::size_t k = 0; k < kKinds.size(); ++k)
      if ((kinds >> k) & 1) columns[k].add_bytes((point.*kKinds[k].irradiance).data(), kIrradianceSize);
    noise.add_bytes(point.noise.data(), kIrradianceSize);
  }
  std::string text = "irradpoints: 1\norigin: " + hex_of(file.header.origin) +
                     "\nspacing: " + hex_of({&file.header.spacing, 1}) +
                     "\npoints: " + std::to_string(file.records.size()) + " #" + points.hex() + "\n";
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    text.append(kKinds[k].name).append(": ").append((kinds >> k) & 1 ? "#" + columns[k].hex() : "none").append("\n");
  if (file.header.columns & column_points_noise) text += "noise: #" + noise.hex() + "\n";
  return hash_hex(text);
}

}  // namespace tempolux::formats
