// lib/irradcache/record_lists.cpp -- lists records by cell.
#include <cmath>

#include "lib/irradcache/record_cells.h"
#include "lib/irradcache/records.h"

namespace tempolux {
namespace {

constexpr double kOffPlaneSlack = 1e-4;  ///< in radii: above the rounding errors of the test of Clearance::kOffPlane

}  // namespace

void RecordStore::Bucket::add(const Entry& entry) {
  const std::size_t lane = count_++ % kLanes;
  if (lane == 0) eights_.emplace_back();
  Eight& e = eights_.back();
  e.x[lane] = entry.position.x, e.y[lane] = entry.position.y, e.z[lane] = entry.position.z;
  e.normal_x[lane] = entry.normal.x, e.normal_y[lane] = entry.normal.y, e.normal_z[lane] = entry.normal.z;
  e.radius[lane] = entry.radius;
  e.record[lane] = entry.record;
  last_ = entry.record;
}

void RecordStore::Bucket::set_radius(std::uint32_t record, float radius) {
  for (std::size_t i = 0; i < count_; ++i)
    if (Eight& eight = eights_[i / kLanes]; eight.record[i % kLanes] == record) eight.radius[i % kLanes] = radius;
}

/// Lists a record in the cells in which it may be valid. They lie close to the record's tangent plane: let d be the
/// offset of a point with normal n = n_i cos a + t sin a, where t is a unit vector perpendicular to n_i. Then
///     |d . (n + n_i)| <= 2 Clearance::kOffPlane r   and   |d| < r give
///     |d . n_i| <= r (2 Clearance::kOffPlane / (1 + cos a) + tan(a / 2)).
/// This bound grows with the angle a, so it is taken at least_cosine. Cells farther off do not list the record.
void RecordStore::list(Level& level, std::uint32_t record) const {
  const IrradianceRecord& r = records_[record];
  const Vec3d local(r.position), normal(r.normal);
  const double c = double(least_cosine_), width = 1 / level.inverse_cell;
  const double off =
      double(r.radius) * (2 * double(Clearance::kOffPlane) / (1 + c) + std::sqrt((1 - c) / (1 + c)) + kOffPlaneSlack);
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
