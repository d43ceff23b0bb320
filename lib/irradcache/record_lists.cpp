// lib/irradcache/record_lists.cpp -- lists records by cell.
#include <cmath>

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

/// Lists a record in the cells in which it may be valid, which lie next to the plane between the normals. With t
/// perpendicular to n_i and n = n_i cos a + t sin a,
///     |d . (n + n_i)| <= 2 kOffPlane r   and   |d| < r give
///     |d . n_i| <= r (2 kOffPlane / (1 + cos a) + tan(a / 2)),
/// which grows with the angle. Cells farther off need not list the record.
void RecordStore::list(Level& level, std::uint32_t record) const {
  const IrradianceRecord& r = records_[record];
  const Vec3d local(r.position), normal(r.normal);
  const double c = double(options_.least_cosine), width = 1 / level.inverse_cell;
  const double off =
      double(r.radius) * (2 * double(kOffPlane) / (1 + c) + std::sqrt((1 - c) / (1 + c)) + kOffPlaneSlack);
  const double reach = off + width / 2 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  for_each_cell(local, r.radius, level.inverse_cell, [&](Cell cell) {
    const Vec3d middle{(double(cell.x) + 0.5) * width, (double(cell.y) + 0.5) * width, (double(cell.z) + 0.5) * width};
    if (std::abs(dot(middle - local, normal)) > reach) return;
    Bucket& bucket = level.buckets[bucket_of(cell, level.buckets.size())];
    if (bucket.ends_with(record)) return;  // two cells with the same hash list the record once
    bucket.add({r.position, r.radius, r.normal, record});
    ++level.listed;
  });
}

}  // namespace tempolux
