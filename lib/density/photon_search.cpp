// lib/density/photon_search.cpp -- the searches of PhotonIndex: descend the tree, nearer children first.
#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "lib/density/nearest_select.h"
#include "lib/density/photon_index.h"

namespace tempolux {
namespace {

/// Ratio of the next search's first guess to this search's squared radius. If the guess is too small the search runs
/// twice; if it is too large the search visits many photons in vain. 1.2 and 2 are 5 to 10 % slower.
constexpr float kGuessFactor = 1.5f;

}  // namespace

/// One search. A box's distance is computed with the same roundings as a photon's. Rounding is monotonic, so a box is
/// never farther away than a photon inside it, and no photon is missed.
struct PhotonSearch {
  static constexpr unsigned kLeafBits = 5;  // log2(kLeafSize)
  static_assert(PhotonIndex::kLeafSize == std::size_t(1) << kLeafBits);

  /// A subtree. If key > last_key, all its photons sort after last_key.
  struct Entry {
    std::uint64_t key;  ///< distance_key() of the subtree's box and its first photon
    unsigned level;     ///< of the subtree's root node, whose number follows from the first photon
  };
  /// Subtrees still to be visited, the next one on top. A level adds at most 7, and 2^31 photons have 9 levels.
  struct Stack {
    std::array<Entry, 8 * 12> entries;
    std::size_t depth = 0;
    explicit Stack(Entry root) { entries[depth++] = root; }
    bool empty() const { return depth == 0; }
    Entry pop() { return entries[--depth]; }
    void push(const std::array<std::uint64_t, 8>& keys, unsigned count, unsigned level) {
      while (count-- > 0) entries[depth++] = {keys[count], level};
    }
  };

  const PhotonIndex& index;
  NeighbourList& found;
  CandidateList list;
  __m256 px, py, pz, nx, ny, nz;
  __m256 flat_factor, min_dot;
  __m256 bound;
  std::uint64_t last_key;

  PhotonSearch(const PhotonIndex& index_, const PhotonQuery& query, NeighbourList& found_)
      : index(index_),
        found(found_),
        list{found_.distance2_.data(), found_.photon_.data()},
        px(_mm256_set1_ps(query.point.x)),
        py(_mm256_set1_ps(query.point.y)),
        pz(_mm256_set1_ps(query.point.z)),
        nx(_mm256_set1_ps(query.normal.x)),
        ny(_mm256_set1_ps(query.normal.y)),
        nz(_mm256_set1_ps(query.normal.z)),
        flat_factor(_mm256_set1_ps(query.flattening * query.flattening - 1)),
        min_dot(_mm256_set1_ps(query.min_cos * 511)) {
    set_bound(query.max_radius * query.max_radius, 0xffffffffu);
  }

  void set_bound(float d2, std::uint32_t photon) {
    bound = _mm256_set1_ps(d2);
    last_key = distance_key(d2, photon);
  }

  /// Reserves memory for `more` candidates after those in the list.
  void reserve(std::size_t more) {
    const std::size_t need = list.count + more + kListSlack;
    if (found.distance2_.size() < need) {
      found.distance2_.resize(std::max(need, 2 * found.distance2_.size()));
      found.photon_.resize(found.distance2_.size());
    }
    list.distance2 = found.distance2_.data();
    list.photon = found.photon_.data();
  }

  __m256 box_distance2(const BoxTree::Node& node) const {
    const auto along = [](const float* lower, const float* upper, __m256 p) {
      const __m256 d = _mm256_max_ps(_mm256_sub_ps(_mm256_load_ps(lower), p), _mm256_sub_ps(p, _mm256_load_ps(upper)));
      const __m256 outside = _mm256_max_ps(_mm256_setzero_ps(), d);  // the NaN of a missing child stays NaN
      return _mm256_mul_ps(outside, outside);
    };
    return _mm256_add_ps(
        _mm256_add_ps(along(node.lower[0], node.upper[0], px), along(node.lower[1], node.upper[1], py)),
        along(node.lower[2], node.upper[2], pz));
  }

  /// The children in which a photon may pass the test of normals: an upper bound of the cosine, with the roundings of
  /// filter().
  __m256 may_face(const BoxTree::Node& node) const {
    const auto most = [](const float* lower, const float* upper, __m256 n) {
      return _mm256_max_ps(_mm256_mul_ps(_mm256_load_ps(lower), n), _mm256_mul_ps(_mm256_load_ps(upper), n));
    };
    const __m256 cosine =
        _mm256_add_ps(_mm256_add_ps(most(node.lower[0], node.upper[0], nx), most(node.lower[1], node.upper[1], ny)),
                      most(node.lower[2], node.upper[2], nz));
    return _mm256_cmp_ps(cosine, min_dot, _CMP_GT_OQ);
  }

  /// The lanes of eight photons whose normals pass.
  __m256 filter(const std::uint32_t* codes) const {
    const __m256i code = _mm256_load_si256(reinterpret_cast<const __m256i*>(codes));
    const auto component = [code](int shift) {
      return _mm256_cvtepi32_ps(_mm256_srai_epi32(_mm256_slli_epi32(code, shift), 22));
    };
    const __m256 cosine =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(component(22), nx), _mm256_mul_ps(component(12), ny)),
                      _mm256_mul_ps(component(2), nz));
    return _mm256_cmp_ps(cosine, min_dot, _CMP_GT_OQ);
  }

  /// Appends the photons of a leaf that pass; there must be room for a whole leaf.
  void scan_leaf(std::uint32_t first) {
    const PhotonIndex::Leaf& leaf = index.leaves_[first >> kLeafBits];
    __m256i photons = _mm256_add_epi32(_mm256_set1_epi32(int(first)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    for (std::size_t i = 0; i < PhotonIndex::kLeafSize; i += 8) {
      const __m256 dx = _mm256_sub_ps(_mm256_load_ps(leaf.x + i), px);
      const __m256 dy = _mm256_sub_ps(_mm256_load_ps(leaf.y + i), py);
      const __m256 dz = _mm256_sub_ps(_mm256_load_ps(leaf.z + i), pz);
      const __m256 round = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)),
                                         _mm256_mul_ps(dz, dz)),
                   h = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, nx), _mm256_mul_ps(dy, ny)),
                                     _mm256_mul_ps(dz, nz)),
                   // Without flattening, and far away, 0 h^2 must not be 0 x infinity.
          flat = _mm256_and_ps(h, _mm256_cmp_ps(flat_factor, _mm256_setzero_ps(), _CMP_NEQ_OQ)),
                   d2 = _mm256_add_ps(round, _mm256_mul_ps(flat_factor, _mm256_mul_ps(flat, flat)));
      const __m256 pass =
          _mm256_and_ps(_mm256_cmp_ps(d2, bound, _CMP_LE_OQ), filter(index.filters_[first >> kLeafBits].code + i));
      list.append(d2, photons, unsigned(_mm256_movemask_ps(pass)));
      photons = _mm256_add_epi32(photons, _mm256_set1_epi32(8));
    }
  }

  /// Fills in the keys of a node's children within the bound, nearest first (kSorted) or in tree order, and returns
  /// their number. Leaves out children whose normals all fail the test.
  template <bool kSorted>
  unsigned children_within(Entry entry, std::array<std::uint64_t, 8>& keys) const {
    const std::uint32_t first = std::uint32_t(entry.key);
    const unsigned child_bits = kLeafBits + 3 * entry.level;
    const std::uint64_t number = std::uint64_t(first) >> (child_bits + 3);
    const __m256 d2 = box_distance2(index.tree_.node(entry.level, number));
    const __m256 wanted =
        _mm256_and_ps(_mm256_cmp_ps(d2, bound, _CMP_LE_OQ), may_face(index.normals_.node(entry.level, number)));
    unsigned mask = unsigned(_mm256_movemask_ps(wanted));
    alignas(32) std::array<std::uint32_t, 8> bits;
    _mm256_store_si256(reinterpret_cast<__m256i*>(bits.data()), _mm256_castps_si256(d2));
    unsigned count = 0;
    for (; mask; mask &= mask - 1) {
      const unsigned child = unsigned(std::countr_zero(mask));
      const std::uint64_t key = std::uint64_t(bits[child]) << 32 | (first + (child << child_bits));
      unsigned place = count++;
      if constexpr (kSorted)
        for (; place > 0 && keys[place - 1] > key; --place) keys[place] = keys[place - 1];
      keys[place] = key;
    }
    return count;
  }

  /// Visits the leaves within the bound: calls visit(first photon) for each until visit returns false.
  template <bool kSorted, class Visit>
  void descend(const Visit& visit) const {
    Stack stack({0, unsigned(index.tree_.level_count()) - 1});
    std::array<std::uint64_t, 8> keys;
    while (!stack.empty()) {
      const Entry entry = stack.pop();
      if (entry.key > last_key) continue;
      const unsigned children = children_within<kSorted>(entry, keys);
      if (entry.level > 0) {
        stack.push(keys, children, entry.level - 1);
        continue;
      }
      for (unsigned c = 0; c < children; ++c)
        if (keys[c] <= last_key && !visit(std::uint32_t(keys[c]))) return;
    }
  }

  /// Drops all but the k nearest candidates and sets the bound to the farthest of them.
  void tighten(std::size_t k) {
    const std::size_t place = keep_nearest(list, k, found.keys_);
    set_bound(list.distance2[place], list.photon[place]);
    found.farthest_ = place;
  }

  /// Finds an upper bound of the k-th distance: takes the nearest subtrees until they hold k photons that pass.
  void approach(std::size_t k) {
    reserve(k + PhotonIndex::kLeafSize);
    descend<true>([&](std::uint32_t first) {
      scan_leaf(first);
      return list.count < k;
    });
    if (list.count >= k) tighten(k);
  }

  /// Finds the k nearest photons within the bound, in tree order. Fast if the bound is not much too large.
  void collect(std::size_t k) {
    const std::size_t limit = 2 * k + 32;  // number of candidates at which the bound is tightened
    reserve(limit + PhotonIndex::kLeafSize);
    list.count = 0;
    descend<false>([&](std::uint32_t first) {
      scan_leaf(first);
      if (list.count >= limit) tighten(k);
      return true;
    });
    if (list.count > 0) tighten(std::min(k, list.count));
  }

  /// Searches within the guess if there is one (finite, above 0), and without it if the guess was too small.
  void nearest(std::size_t k, float max_radius2, float guess2) {
    if (guess2 > 0 && std::isfinite(guess2)) {
      set_bound(std::min(guess2, max_radius2), 0xffffffffu);
      collect(k);
      if (list.count == k || guess2 >= max_radius2) return;
      list.count = 0;
      set_bound(max_radius2, 0xffffffffu);
    }
    approach(k);
    collect(k);
  }

  /// Finds all photons within the bound, in tree order.
  void within() {
    descend<false>([&](std::uint32_t first) {
      reserve(PhotonIndex::kLeafSize);
      scan_leaf(first);
      return true;
    });
  }
};

void PhotonIndex::find_nearest(const PhotonQuery& query, int k, NeighbourList& found) const {
  if (k < 1 || k > kMaxNeighbours) throw std::invalid_argument("find_nearest: k must be 1 to 512");
  found.count_ = 0;
  if (size_ == 0 || !is_finite(query.point)) return;
  const float max_radius2 = query.max_radius * query.max_radius;
  float& guess2 = found.guess_for(*this, k).radius2;
  PhotonSearch search(*this, query, found);
  search.nearest(std::size_t(k), max_radius2, guess2);
  found.count_ = search.list.count;
  if (found.count_ == std::size_t(k)) guess2 = kGuessFactor * found.distance2_[found.farthest_];
}

void PhotonIndex::find_within(const PhotonQuery& query, NeighbourList& found) const {
  found.count_ = 0;
  if (size_ == 0 || !is_finite(query.point)) return;
  PhotonSearch search(*this, query, found);
  search.within();
  found.count_ = search.list.count;
  found.farthest_ = 0;
}

}  // namespace tempolux
