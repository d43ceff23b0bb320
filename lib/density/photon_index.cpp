#include "lib/density/photon_index.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "formats/large_pages.h"
#include "lib/core/arrays.h"
#include "lib/core/parallel.h"
#include "lib/core/parallel_each.h"

namespace tempolux {

struct PhotonIndex::Item {
  float position[3];
  std::uint32_t source;
};

namespace {

using Item = PhotonIndex::Item;
constexpr std::size_t kLeafSize = PhotonIndex::kLeafSize;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kChunk = 1 << 14;

struct Range {
  std::size_t first, last;
};

/// Uninitialised memory for `count` values.
template <class T>
std::unique_ptr<T[]> room_for(std::size_t count) {
  auto room = std::make_unique_for_overwrite<T[]>(count);
  formats::prefer_large_pages(room.get(), count * sizeof(T));
  return room;
}

/// Partitions items around the n-th by coordinate. Equal coordinates are ordered by source, so the two halves do not
/// depend on the method.
template <int axis>
void select(std::span<Item> items, std::size_t n) {
  std::nth_element(items.begin(), items.begin() + std::ptrdiff_t(n), items.end(), [](const Item& a, const Item& b) {
    return a.position[axis] < b.position[axis] || (a.position[axis] == b.position[axis] && a.source < b.source);
  });
}

Box3 box_of(const Item* first, const Item* last) {
  Box3 box;
  for (; first != last; ++first) box.add(Vec3{first->position[0], first->position[1], first->position[2]});
  return box;
}

/// Cuts a range of items across the longest side of its box. The left part gets full leaves, as many as the largest
/// power of two below their number, so that any aligned block of 2^j leaves is a subtree. Returns false if the range is
/// one leaf, which is then sorted by source.
bool split(std::span<Item> items, Range range, Range& left, Range& right) {
  Item* const first = items.data() + range.first;
  Item* const last = items.data() + range.last;
  const std::size_t leaves = (range.last - range.first + kLeafSize - 1) / kLeafSize;
  if (leaves <= 1) {
    std::sort(first, last, [](const Item& a, const Item& b) { return a.source < b.source; });
    return false;
  }
  const Box3 box = box_of(first, last);
  const Vec3 extent = box.upper - box.lower;
  const std::size_t mid = range.first + std::bit_ceil(leaves) / 2 * kLeafSize;
  const std::span<Item> cut = items.subspan(range.first, range.last - range.first);
  if (extent.x >= extent.y && extent.x >= extent.z) select<0>(cut, mid - range.first);
  else if (extent.y >= extent.z) select<1>(cut, mid - range.first);
  else select<2>(cut, mid - range.first);
  left = {range.first, mid};
  right = {mid, range.last};
  return true;
}

void split_to_leaves(std::span<Item> items, Range range) {
  Range left, right;
  if (!split(items, range, left, right)) return;
  split_to_leaves(items, left);
  split_to_leaves(items, right);
}

/// Sorts items into tree order: splits the first levels one after another, then all subtrees in parallel.
void order_as_tree(std::span<Item> items) {
  std::vector<Range> ranges{{0, items.size()}};
  for (int level = 0; level < 7; ++level) {
    std::vector<Range> halves(2 * ranges.size(), Range{0, 0});
    parallel_chunks(ranges.size(), 1,
                    [&](std::size_t i, std::size_t) { split(items, ranges[i], halves[2 * i], halves[2 * i + 1]); });
    std::erase_if(halves, [](const Range& r) { return r.first == r.last; });
    ranges = std::move(halves);
  }
  parallel_chunks(ranges.size(), 1, [&](std::size_t i, std::size_t) { split_to_leaves(items, ranges[i]); });
}

/// Encodes a photon's normal with ten bits per component (signed, 511 is 1).
std::uint32_t filter_code(const formats::Photon& photon) {
  const std::array<float, 3> n = formats::decode_normal(photon.normal);
  std::uint32_t code = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int step = int(std::rint(std::clamp(n[axis], -1.0f, 1.0f) * 511));
    code |= (std::uint32_t(step) & 0x3ff) << (10 * axis);
  }
  return code;
}

/// Decodes a component of a normal, in units of 1/511.
float coded(std::uint32_t code, int axis) { return float(std::int32_t(code << (22 - 10 * axis)) >> 22); }

}  // namespace

PhotonIndex::PhotonIndex(std::span<const formats::Photon> photons, std::uint8_t kinds, Vec3d shift) {
  if (photons.size() > std::size_t(1) << 31) throw std::length_error("PhotonIndex: more than 2^31 photons");
  const auto is_wanted = [kinds](const formats::Photon& photon) { return (kind_bit(photon.kind) & kinds) != 0; };
  const std::size_t chunks = (photons.size() + kChunk - 1) / kChunk;
  std::vector<std::size_t> places(chunks + 1, 0);  // by chunk: index of its first photon
  parallel_chunks(photons.size(), kChunk, [&](std::size_t first, std::size_t last) {
    places[first / kChunk + 1] =
        std::size_t(std::count_if(&photons[first], &photons[first] + (last - first), is_wanted));
  });
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) places[chunk + 1] += places[chunk];
  size_ = places.back();
  if (size_ == 0) return;
  const auto items = room_for<Item>(size_);
  std::vector<float> largest(chunks, 0.0f);
  parallel_chunks(photons.size(), kChunk, [&](std::size_t first, std::size_t last) {
    std::size_t place = places[first / kChunk];
    for (std::size_t i = first; i < last; ++i) {
      if (!is_wanted(photons[i])) continue;
      const Vec3 p = shifted(photons[i].position, shift);
      if (!is_finite(p) || !is_finite(rgb_of(photons[i].flux)))
        throw std::invalid_argument("PhotonIndex: a position or flux is not finite");
      items[place++] = {{p.x, p.y, p.z}, std::uint32_t(i)};
      largest[first / kChunk] = std::max(largest[first / kChunk], max_component(abs(p)));
    }
  });
  resolution_ = *std::max_element(largest.begin(), largest.end()) * 0x1p-22f;
  order_as_tree({items.get(), size_});
  build_leaves(photons, {items.get(), size_});
  build_tree();
}

void PhotonIndex::build_leaves(std::span<const formats::Photon> photons, std::span<const Item> items) {
  leaf_count_ = (size_ + kLeafSize - 1) / kLeafSize;
  leaves_ = room_for<Leaf>(leaf_count_);
  filters_ = room_for<LeafFilter>(leaf_count_);
  flux_ = room_for<Rgb>(size_);
  source_ = room_for<std::uint32_t>(size_);
  parallel_each(leaf_count_ * kLeafSize, kChunk, [&](std::size_t i) {
    Leaf& leaf = leaves_[i / kLeafSize];
    const std::size_t lane = i % kLeafSize;
    const bool used = i < size_;
    leaf.x[lane] = used ? items[i].position[0] : kNaN;
    leaf.y[lane] = used ? items[i].position[1] : kNaN;
    leaf.z[lane] = used ? items[i].position[2] : kNaN;
    const formats::Photon* photon = used ? &photons[items[i].source] : nullptr;
    filters_[i / kLeafSize].code[lane] = photon ? filter_code(*photon) : 0;
    if (!photon) return;
    flux_[i] = rgb_of(photon->flux);
    source_[i] = items[i].source;
  });
}

void PhotonIndex::build_tree() {
  std::vector<Box3> places(leaf_count_), normals(leaf_count_);
  parallel_each(leaf_count_, kChunk / kLeafSize, [&](std::size_t j) {
    for (std::size_t i = j * kLeafSize; i < std::min((j + 1) * kLeafSize, size_); ++i) {
      places[j].add(position(i));
      const std::uint32_t code = filters_[j].code[i % kLeafSize];
      normals[j].add(Vec3{coded(code, 0), coded(code, 1), coded(code, 2)});
    }
  });
  tree_ = BoxTree(std::move(places));
  normals_ = BoxTree(std::move(normals));
}

Vec3 PhotonIndex::normal(std::size_t i) const {
  const std::uint32_t code = filters_[i / kLeafSize].code[i % kLeafSize];
  return Vec3{coded(code, 0), coded(code, 1), coded(code, 2)} * (1.0f / 511);
}

}  // namespace tempolux
