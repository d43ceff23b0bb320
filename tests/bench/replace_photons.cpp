// tests/bench/replace_photons.cpp -- what it costs to replace photons in the sums of a volume, by how many the volume
// holds.
//
//     replace_photons [--replaced 30000] [--short]      short: totals of 300k and 1M alone, three rounds
//
// CPU seconds of one thread for taking so many photons away and adding as many, sides alternating, median of 9; totals
// of 300k to 30M photons spread over 2 million cells. It should not depend on the total.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include "lib/compose/fluence_volume.h"
#include "lib/core/random.h"

namespace {

using namespace tempolux;

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

struct Deposit {
  Vec3 at;
  Rgb worth;
};

Deposit deposit(std::uint64_t i) {
  const PathRandom random(1, i);
  const Vec2 xy = random.get2(0, Purpose::test), zw = random.get2(1, Purpose::test);
  return {{xy.x, xy.y, zw.x}, Rgb(1e-6f * (0.5f + zw.y))};
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t replaced =
      argc > 2 && std::strcmp(argv[1], "--replaced") == 0 ? std::size_t(std::atoll(argv[2])) : 30000;
  const bool is_short = argc > 3 && std::strcmp(argv[3], "--short") == 0;
  MajorantGrid majorants({{0, 0, 0}, {1, 1, 1}}, {16, 16, 16});
  for (float& value : majorants.values()) value = 1;
  std::vector<std::uint64_t> totals{300'000, 1'000'000, 3'000'000, 30'000'000};
  if (is_short) totals.resize(2);
  std::vector<FluenceSums> volumes;
  for (const std::uint64_t total : totals) {
    FluenceSums& sums = volumes.emplace_back(majorants, 1.0 / 128, 1.0);
    for (std::uint64_t i = 0; i < total; ++i) {
      const Deposit d = deposit(i);
      sums.add(d.at, d.worth);
    }
  }
  std::vector<Deposit> old, fresh;
  for (std::size_t i = 0; i < replaced; ++i) {
    old.push_back(deposit(i));
    fresh.push_back(deposit((std::uint64_t(1) << 40) + i));
  }
  std::vector<std::vector<double>> seconds(totals.size());
  for (int round = 0; round < (is_short ? 3 : 9); ++round)
    for (std::size_t v = 0; v < volumes.size(); ++v) {
      const double start = cpu_seconds();
      for (const Deposit& d : old) volumes[v].add(d.at, d.worth, -1);
      for (const Deposit& d : fresh) volumes[v].add(d.at, d.worth);
      seconds[v].push_back(cpu_seconds() - start);
      std::swap(old, fresh);  // back again in the next round; for all volumes alike after two
      for (const Deposit& d : old) volumes[v].add(d.at, d.worth, -1);
      for (const Deposit& d : fresh) volumes[v].add(d.at, d.worth);
      std::swap(old, fresh);
    }
  std::printf("{\"replaced\": %zu", replaced);
  for (std::size_t v = 0; v < totals.size(); ++v) {
    std::sort(seconds[v].begin(), seconds[v].end());
    std::printf(", \"%llu\": %.6f", static_cast<unsigned long long>(totals[v]), seconds[v][seconds[v].size() / 2]);
  }
  std::printf("}\n");
}
