#include "formats/photons/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tempolux::formats {
namespace {

void add(PhotonShare& share, const Photon& photon) {
  ++share.count;
  for (std::size_t c = 0; c < 3; ++c) share.flux[c] += double(photon.flux[c]);
}

/// Delivers a reader's photons one by one, across the borders of blocks.
class PhotonStream {
 public:
  explicit PhotonStream(PhotonReader& reader) : reader_(reader) {}

  /// Advances to the next photon; false at the end.
  bool next() {
    while (++at_ >= block_.photons.size()) {
      if (!reader_.read_block(block_)) return false;
      at_ = std::size_t(-1);
    }
    return true;
  }
  const Photon& photon() const { return block_.photons[at_]; }
  bool equals(const PhotonStream& other) const {
    return block_.group == other.block_.group && photon() == other.photon() &&
           same(block_.directions, other.block_.directions, other.at_) &&
           same(block_.albedos, other.block_.albedos, other.at_);
  }

 private:
  /// Compares a column of two photons. A column that only one file has is a difference of headers, so it counts as
  /// equal here.
  template <class Column>
  bool same(const Column& mine, const Column& others, std::size_t at) const {
    return mine.empty() || others.empty() || mine[at_] == others[at];
  }

  PhotonReader& reader_;
  PhotonBlock block_;
  std::size_t at_ = 0;
};

void widen(std::array<double, 3>& largest, const std::array<float, 3>& a, const std::array<float, 3>& b) {
  for (std::size_t c = 0; c < 3; ++c) largest[c] = std::max(largest[c], std::abs(double(a[c]) - double(b[c])));
}

}  // namespace

PhotonSummary summarise(PhotonReader& reader) {
  PhotonSummary summary;
  summary.bounds_min.fill(std::numeric_limits<double>::infinity());
  summary.bounds_max.fill(-std::numeric_limits<double>::infinity());
  const std::array<double, 3> origin = reader.header().origin;
  PhotonBlock block;
  while (reader.read_block(block)) {
    for (const Photon& photon : block.photons) {
      add(summary.all, photon);
      add(summary.by_kind[std::size_t(photon.kind)], photon);
      add(summary.by_object[photon.object], photon);
      summary.largest_bounce = std::max<std::uint64_t>(summary.largest_bounce, photon.bounce);
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = origin[c] + double(photon.position[c]);
        summary.bounds_min[c] = std::min(summary.bounds_min[c], x);
        summary.bounds_max[c] = std::max(summary.bounds_max[c], x);
        summary.largest_flux = std::max(summary.largest_flux, std::abs(double(photon.flux[c])));
      }
    }
  }
  if (summary.all.count > 0)
    for (std::size_t c = 0; c < 3; ++c) summary.mean_flux[c] = summary.all.flux[c] / double(summary.all.count);
  return summary;
}

PhotonDifference compare(PhotonReader& a, PhotonReader& b) {
  PhotonDifference difference;
  PhotonStream stream_a(a), stream_b(b);
  bool more_a = stream_a.next(), more_b = stream_b.next();
  for (; more_a && more_b; more_a = stream_a.next(), more_b = stream_b.next(), ++difference.records) {
    if (stream_a.equals(stream_b)) continue;
    if (difference.differing++ == 0) difference.first = difference.records;
    widen(difference.largest_position, stream_a.photon().position, stream_b.photon().position);
    widen(difference.largest_flux, stream_a.photon().flux, stream_b.photon().flux);
  }
  while (more_a) more_a = stream_a.next();  // to the end, so that totals and digests become known
  while (more_b) more_b = stream_b.next();
  return difference;
}

}  // namespace tempolux::formats
