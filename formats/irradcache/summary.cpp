#include "formats/irradcache/summary.h"

#include "formats/float_bits.h"

namespace tempolux::formats {

IrradcacheSummary summarise(const IrradcacheFile& file) {
  IrradcacheSummary summary;
  for (const IrradianceCacheRecord& record : file.records) {
    summary.records.add(record, file.header.origin);
    for (std::size_t c = 0; c < 3; ++c) summary.irradiance[c].add(double(record.irradiance[c]));
    summary.radius.add(double(record.radius));
    if (is_finite(record.radius_unclamped)) summary.radius_unclamped.add(double(record.radius_unclamped));
    if (file.header.columns & column_influence) summary.influence.add(double(record.influence));
  }
  return summary;
}

}  // namespace tempolux::formats
