// lib/light/light_grid.h -- what light from far away reaches which places: learned by rays, to aim light samples by.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/light/environment_light.h"

namespace tempolux {

/// Cells of space, each for the six directions that a surface may mostly face, with the share of light samples that go
/// to the sky, to the directional lights and to all other lights, and with the share of each part of the sky. The parts
/// are the squares of kAcross x kDown in the numbers that draw a direction (EnvironmentLight with as much even light as
/// there is in the mean): equal shares of the sky's light and of its area together; inside a part directions follow the
/// map. Under a roof only parts that are seen through the openings get more than the little that all keep. [After
/// Vevoda, Kondapaneni & Krivanek, "Bayesian online regression for adaptive direct illumination sampling", SIGGRAPH
/// 2018, who learn a choice of lights by cell likewise.]
class LightGrid {
 public:
  static constexpr std::uint32_t kAcross = 32, kDown = 16, kParts = kAcross * kDown;
  struct Cell {
    float sky = 0, suns = 0;          ///< probabilities; the rest: lights that are somewhere
    std::array<float, kParts> end{};  ///< of the parts of the sky, cumulative; the last is 1
  };
  /// edge: of a cell, m. environment: nullptr for none; must outlive it.
  LightGrid(float edge, const Environment* environment);

  /// Where a cell is: its place on the lattice, and 0 to 5 for +x, -x, +y, -y, +z, -z. Of places within kFarthest of 0.
  struct Place {
    std::array<std::int32_t, 3> at{};
    std::uint32_t facing = 0;
  };
  static constexpr std::int32_t kFarthest = (1 << 19) - 2;
  static std::uint64_t key_of(const Place& place);
  static Place place_of(std::uint64_t key);
  /// Number of the cell that holds the place, for surfaces that face as `normal` does (unit); 0: none could.
  std::uint64_t key(Vec3 position, Vec3 normal) const;
  /// The cell `steps` cells along an axis, for the same direction.
  static std::uint64_t beside(std::uint64_t key, int axis, int steps);
  /// Takes the cells in the order of their keys, which are different.
  void set(std::vector<std::uint64_t> keys, std::vector<Cell> cells);
  std::size_t size() const { return cells_.size(); }
  const std::vector<std::uint64_t>& keys() const { return keys_; }
  const std::vector<Cell>& cells() const { return cells_; }
  float edge() const { return edge_; }

  /// nullptr: nothing was learned of the place.
  const Cell* find(Vec3 position, Vec3 normal) const;
  /// A direction of the sky; u in [0, 1) chooses the part and, stretched, is the first number of the direction. density
  /// [1/sr].
  bool sample_sky(const Cell& cell, float u, float u2, EnvironmentLight::Sample& sample, double& density) const;
  /// Density [1/sr] with which sample_sky() gives this direction.
  double sky_density(const Cell& cell, Vec3 direction) const;
  /// Number of the part that holds a direction.
  std::uint32_t part_of(Vec3 direction) const;
  const EnvironmentLight* sky() const { return sky_.get(); }

 private:
  float edge_;
  std::unique_ptr<EnvironmentLight> sky_;
  std::vector<std::uint64_t> keys_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> table_;  ///< by hash of the key: cell + 1, 0 for none; a free one follows each run
  std::size_t mask_ = 0;
};

}  // namespace tempolux
