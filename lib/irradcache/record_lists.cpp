// lib/irradcache/record_lists.cpp -- lists records by cell: one by one as they are added, or all at once.
#include <cmath>
#include <utility>

#include "lib/irradcache/record_cells.h"
#include "lib/irradcache/records.h"

namespace tempolux {
namespace {

constexpr double kOffPlaneSlack = 1e-4;

}  // namespace

void RecordStore::Eight::set(std::size_t lane, const Entry& entry) {
  x[lane] = entry.position.x;
  y[lane] = entry.position.y;
  z[lane] = entry.position.z;
  radius[lane] = entry.radius;
  normal_x[lane] = entry.normal.x;
  normal_y[lane] = entry.normal.y;
  normal_z[lane] = entry.normal.z;
  record[lane] = entry.record;
}

void RecordStore::Bucket::add(const Entry& entry) {
  const std::size_t lane = count_++ % kLanes;
  if (lane == 0) eights_.emplace_back();
  eights_.back().set(lane, entry);
  last_ = entry.record;
}

void RecordStore::Bucket::set_radius(std::uint32_t record, float radius) {
  for (std::size_t i = 0; i < count_; ++i)
    if (Eight& eight = eights_[i / kLanes]; eight.record[i % kLanes] == record) eight.radius[i % kLanes] = radius;
}

/// A record is valid next to the plane between the normals. With t perpendicular to n_i and n = n_i cos a + t sin a,
///     |d . (n + n_i)| <= 2 kOffPlane r   and   |d| < r give
///     |d . n_i| <= r (2 kOffPlane / (1 + cos a) + tan(a / 2)),
/// which grows with the angle. Cells farther off need not list the record.
template <class Body>
void RecordStore::for_each_cell_of(const Level& level, const IrradianceRecord& r, const Body& body) const {
  const Vec3d local(r.position), normal(r.normal);
  const double c = double(std::min(options_.least_cosine, kWideCosine)), width = 1 / level.inverse_cell;
  const double off =
      double(r.radius) * (2 * double(kOffPlane) / (1 + c) + std::sqrt((1 - c) / (1 + c)) + kOffPlaneSlack);
  const double reach = off + width / 2 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  for_each_cell(local, r.radius, level.inverse_cell, [&](Cell cell) {
    const Vec3d middle{(double(cell.x) + 0.5) * width, (double(cell.y) + 0.5) * width, (double(cell.z) + 0.5) * width};
    if (std::abs(dot(middle - local, normal)) <= reach) body(cell);
  });
}

RecordStore::Entry RecordStore::entry_of(std::uint32_t record) const {
  return {records_[record].position, records_[record].radius, records_[record].normal, record};
}

void RecordStore::list(Level& level, std::uint32_t record) const {
  const Entry entry = entry_of(record);
  for_each_cell_of(level, records_[record], [&](Cell cell) {
    Bucket& bucket = level.buckets[bucket_of(cell, level.buckets.size())];
    if (bucket.ends_with(record)) return;  // two cells with the same hash list the record once
    bucket.add(entry);
    ++level.listed;
  });
}

/// Builds the lists of all members at once.
void RecordStore::pack(Level& level) const {
  constexpr std::uint32_t kNobody = ~std::uint32_t{0};
  struct Listed {
    std::uint32_t hash, record;
  };
  std::vector<Listed> all;
  for (const std::uint32_t record : level.members)
    for_each_cell_of(level, records_[record], [&](Cell cell) { all.push_back({hash_of(cell), record}); });
  std::size_t count = kFirstBuckets;
  while (4 * count <= all.size()) count *= 4;
  const auto mask = std::uint32_t(count - 1);
  std::vector<std::uint32_t> last(count, kNobody), next(count + 1);
  const auto for_each_listed = [&](const auto& body) {
    std::fill(last.begin(), last.end(), kNobody);
    for (const Listed& listed : all)  // two cells with the same hash list the record once
      if (const std::uint32_t at = listed.hash & mask; std::exchange(last[at], listed.record) != listed.record)
        body(at, listed.record);
  };
  for_each_listed([&](std::uint32_t at, std::uint32_t) { ++next[at]; });
  level.first.assign(count + 1, 0);
  for (std::size_t b = 0; b < count; ++b)
    level.first[b + 1] = level.first[b] + std::uint32_t((next[b] + kLanes - 1) / kLanes);
  level.eights.assign(level.first[count], {});
  std::fill(next.begin(), next.end(), 0);
  for_each_listed([&](std::uint32_t at, std::uint32_t record) {
    const std::uint32_t place = next[at]++;
    level.eights[level.first[at] + place / kLanes].set(place % kLanes, entry_of(record));
  });
}

}  // namespace tempolux
