#include "lib/temporal/ageing.h"

#include <algorithm>
#include <utility>

#include "formats/radsamples/sample.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

__extension__ typedef unsigned __int128 Wide;

/// A number in [0, below): the high word of the product. Its distribution differs from a uniform one by below / 2^64.
std::uint64_t number_below(std::uint64_t bits, std::uint64_t below) {
  return std::uint64_t((Wide(bits) * below) >> 64);
}

}  // namespace

/// Takes one member out of a class of equal age.
std::uint32_t AgeDraw::take(Class& from, std::uint64_t member) {
  std::uint32_t& taken = members_[from.first + std::size_t(member)];
  std::swap(taken, members_[from.first + --from.size]);
  return members_[from.first + from.size];
}

void AgeDraw::draw(std::span<const std::uint16_t> ages, std::size_t count, std::uint64_t key,
                   std::vector<std::uint32_t>& drawn) {
  drawn.clear();
  classes_.clear();
  for (const std::uint16_t age : ages) {
    if (age >= classes_.size()) classes_.resize(age + 1u);
    ++classes_[age].size;
  }
  const bool saturated = classes_.size() > formats::kMaxAge;
  if (saturated) count = std::max<std::size_t>(count, classes_.back().size);
  std::uint32_t first = 0;
  std::uint64_t total = 0;
  for (std::size_t age = 0; age < classes_.size(); ++age) {
    Class& c = classes_[age];
    c.first = first;
    first += c.size;
    c.weight = age * age;
    total += c.weight * std::exchange(c.size, 0u);
  }
  members_.resize(ages.size());
  for (std::size_t c = 0; c < ages.size(); ++c) {
    Class& of = classes_[ages[c]];
    members_[of.first + of.size++] = std::uint32_t(c);
  }
  for (std::size_t i = 0; i < std::min(count, ages.size()); ++i) {
    const std::uint64_t bits = mix64(key + i * 0x9e3779b97f4a7c15ull);
    while (classes_.back().size == 0) classes_.pop_back();
    Class* from = &classes_.back();
    std::uint64_t member = 0;
    if (classes_.size() > formats::kMaxAge) {
      member = number_below(bits, from->size);
    } else {
      std::uint64_t x = number_below(bits, total);
      for (; x >= from->weight * from->size; --from) x -= from->weight * from->size;
      member = x / from->weight;
    }
    total -= from->weight;
    drawn.push_back(take(*from, member));
  }
}

}  // namespace tempolux
