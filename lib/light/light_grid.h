// lib/light/light_grid.h -- learned visibility of distant light: which lights and which parts of the sky reach a place.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/light/environment_light.h"

namespace tempolux {

/// A grid of cells over space, six in each cube: one for each axis direction that a surface mostly faces. A cell holds
/// the probabilities with which a light sample goes to the sky, to the directional lights and to all other lights, and
/// the probability of each part of the sky. A part is a square of the kAcross x kDown lattice over the two numbers that
/// draw a direction (EnvironmentLight with `uniform` 1), so all parts have equal shares of the sky's light and of its
/// solid angle together; inside a part, directions follow the map. Below a roof, the parts that are visible through
/// openings get most samples; all other parts keep a small probability. [After Vevoda, Kondapaneni & Krivanek,
/// "Bayesian online regression for adaptive direct illumination sampling", SIGGRAPH 2018, who also learn the choice of
/// lights by cell.]
class LightGrid {
 public:
  static constexpr std::uint32_t kAcross = 32, kDown = 16, kParts = kAcross * kDown;
  struct Cell {
    float sky = 0, suns = 0;          ///< probabilities; the remainder goes to lights inside the scene
    std::array<float, kParts> end{};  ///< cumulative probabilities of the parts of the sky; the last is 1
  };
  /// `edge` [m] is the size of a cell. `environment` must outlive this object; nullptr: there is none.
  LightGrid(float edge, const Environment* environment);

  /// A cell's place: its lattice coordinates, and 0 to 5 for surfaces that face +x, -x, +y, -y, +z, -z. Only for places
  /// within kFarthest of the origin.
  struct Place {
    std::array<std::int32_t, 3> at{};
    std::uint32_t facing = 0;
  };
  static constexpr std::int32_t kFarthest = (1 << 19) - 2;
  static std::uint64_t key_of(const Place& place);
  static Place place_of(std::uint64_t key);
  /// Key of the cell that holds the position, for surfaces that face as `normal` (unit) does; 0 if the position is too
  /// far from the origin.
  std::uint64_t key(Vec3 position, Vec3 normal) const;
  /// Key of the cell `steps` cells further along an axis, for the same facing direction.
  static std::uint64_t beside(std::uint64_t key, int axis, int steps);
  /// Replaces all cells. Keys must be sorted and different.
  void set(std::vector<std::uint64_t> keys, std::vector<Cell> cells);
  std::size_t size() const { return cells_.size(); }
  const std::vector<std::uint64_t>& keys() const { return keys_; }
  const std::vector<Cell>& cells() const { return cells_; }
  float edge() const { return edge_; }

  /// nullptr if the file has no cell for this place.
  const Cell* find(Vec3 position, Vec3 normal) const;
  /// Draws a direction of the sky. u in [0, 1) chooses the part and, stretched, is the first number of the direction.
  /// `density` receives the density [1/sr].
  bool sample_sky(const Cell& cell, float u, float u2, EnvironmentLight::Sample& sample, double& density) const;
  /// Density [1/sr] with which sample_sky() gives this direction.
  double sky_density(const Cell& cell, Vec3 direction) const;
  /// Number of the part of the sky that holds a direction.
  std::uint32_t part_of(Vec3 direction) const;
  const EnvironmentLight* sky() const { return sky_.get(); }

 private:
  float edge_;
  std::unique_ptr<EnvironmentLight> sky_;
  std::vector<std::uint64_t> keys_;
  std::vector<Cell> cells_;
  /// hash table of the keys: cell + 1, 0 if empty; each run of entries ends with an empty one
  std::vector<std::uint32_t> table_;
  std::size_t mask_ = 0;
};

}  // namespace tempolux
