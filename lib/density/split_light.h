// lib/density/split_light.h -- photons and irradiance points in two parts whose sum is the whole, to the last bit.
#pragma once

#include <span>
#include <vector>

#include "formats/irradpoints/irradpoints.h"
#include "formats/photons/photons.h"
#include "lib/density/energy_cells.h"

namespace tempolux {

struct DividedValue {
  float low = 0, high = 0;
};

/// low + high == value without rounding; low is share * value to 6e-8 of the value. share is in [0, 1]. The larger of
/// the two is rounded and the smaller is what is left, which a float32 holds exactly (Sterbenz). Below 2^-100 the
/// left-over could be a denormal number, which processors flush to zero: the value stays whole, with the larger part.
DividedValue divide(float value, double share);

/// Where a photon lies, relative to its file's origin.
CellPlace place_of(const formats::Photon& photon);
CellPlace place_of(const formats::IrradiancePointRecord& point);

/// Adds a block's photons to the cells: their flux, times the share that is reflected if the block has that column.
void add_energy(const formats::PhotonBlock& block, EnergyCells& cells);
/// Adds points, each with the irradiance of all kinds times area_of_point [m^2].
void add_energy(std::span<const formats::IrradiancePointRecord> points, double area_of_point, EnergyCells& cells);

/// Low and high part of a block: photons in file order, without those that have no flux in that part. Whatever the
/// cells' limit, photons without any flux are in the low part.
struct DividedPhotons {
  formats::PhotonBlock low, high;
};
DividedPhotons divide(const formats::PhotonBlock& block, const EnergyCells& cells);

/// The low part has every point; the high part those that have irradiance in it. All kinds of a point are divided
/// alike.
struct DividedPoints {
  std::vector<formats::IrradiancePointRecord> low, high;
};
DividedPoints divide(std::span<const formats::IrradiancePointRecord> points, const EnergyCells& cells);

/// The other way: adds the high part to the low one, which becomes the whole, to the last bit. Returns for each point
/// the share that the high part has of its light, all kinds and channels added; nothing if `high` holds a point that
/// `low` has not, in its order.
std::vector<float> join_parts(std::span<formats::IrradiancePointRecord> low,
                              std::span<const formats::IrradiancePointRecord> high);

/// The same of photons: adds the flux of the high part to the low one, which becomes the whole. Photons keep the order
/// of the low part; those that are in the high part alone come last. `low` and `high` are the two parts of one map:
/// InputError is the caller's.
void join_parts(formats::PhotonMap& low, const formats::PhotonMap& high);

/// Photons of the kinds in `kinds` (bit k: PathKind k), and the others.
struct ChosenPhotons {
  formats::PhotonBlock chosen, rest;
};
ChosenPhotons choose_kinds(const formats::PhotonBlock& block, unsigned kinds);

}  // namespace tempolux
