// formats/irradcache/records.cpp -- checks and sums records, and computes the digest (irradcache.md).
#include <cmath>
#include <limits>

#include "formats/float_bits.h"
#include "formats/hash.h"
#include "formats/irradcache/layout.h"

namespace tempolux::formats {
namespace irradcache {
namespace {

bool is_unit(const std::array<float, 3>& n) {
  double square = 0;
  for (float x : n) square += double(x) * double(x);
  return std::abs(square - 1) <= 2e-4;
}

}  // namespace

std::string_view fault_of(const IrradianceCacheRecord& record, std::uint32_t columns) {
  if (!is_finite(record.position)) return "position is not finite";
  if (!is_finite(record.normal) || !is_unit(record.normal)) return "normal is not of length 1";
  if (static_cast<unsigned>(record.set) > 1) return "set is neither 0 nor 1";
  if (!is_finite(record.irradiance)) return "irradiance is not finite";
  if (is_negative(record.irradiance)) return "irradiance is negative";
  for (std::size_t c = 0; c < 3; ++c)
    if (!is_finite(record.rotational[c]) || !is_finite(record.translational[c])) return "a gradient is not finite";
  if (!is_finite(record.radius) || is_negative(record.radius) || is_zero(record.radius))
    return "radius is not a length above 0";
  const bool unlimited = record.radius_unclamped == std::numeric_limits<float>::infinity();
  if (!unlimited && (!is_finite(record.radius_unclamped) || is_negative(record.radius_unclamped)))
    return "unclamped radius is not a number or is negative";
  if (!is_finite(record.influence) || is_negative(record.influence)) return "influence is not finite or is negative";
  if (!is_finite(record.update)) return "update is not finite";
  if (!is_finite(record.noise)) return "noise is not finite";
  if (columns & column_clearance && !(record.clearance_reach > 0)) return "clearance does not reach anywhere";
  if ((!(columns & column_clearance) &&
       (!is_zero(record.clearance_reach) || record.clearance != std::array<std::uint8_t, 16>{})) ||
      (!(columns & column_influence) && !is_zero(record.influence)) ||
      (!(columns & column_noise) && !is_zero(record.noise)) || (!(columns & column_update) && !is_zero(record.update)))
    return "a value of a column that the header does not name";
  return "";
}

void RecordSums::add(const IrradianceCacheRecord& record) {
  ++count_;
  sum_.add(record.irradiance);
}

}  // namespace irradcache

std::string digest_of(const IrradcacheFile& file) {
  using namespace irradcache;
  Hasher records, influences, updates, clearances, noises;
  for (IrradianceCacheRecord record : file.records) {
    record.reserved = 0;
    records.add_bytes(&record, kRecordSize);
    influences.add_bytes(&record.influence, kInfluenceSize);
    updates.add_bytes(record.update.data(), kUpdateSize);
    clearances.add_bytes(&record.clearance_reach, kClearanceSize);
    noises.add_bytes(record.noise.data(), kNoiseSize);
  }
  const auto column = [&](IrradcacheColumns bit, const Hasher& hash) {
    return file.header.columns & bit ? "#" + hash.hex() : std::string("none");
  };
  return hash_hex("irradcache: 1\norigin: " + hex_of(file.header.origin) +
                  "\nrecords: " + std::to_string(file.records.size()) + " #" + records.hex() + "\ninfluence: " +
                  column(column_influence, influences) + "\nupdate: " + column(column_update, updates) + "\n" +
                  (file.header.columns & column_clearance ? "clearance: #" + clearances.hex() + "\n" : "") +
                  (file.header.columns & column_noise ? "noise: #" + noises.hex() + "\n" : ""));
}

}  // namespace tempolux::formats
