// lib/density/split_light.h -- divides photons and irradiance points into two parts whose sum is the whole, to the last
// bit.
#pragma once

#include <span>
#include <vector>

#include "formats/irradpoints/irradpoints.h"
#include "formats/photons/photons.h"
#include "lib/density/flux_cells.h"

namespace tempolux {

/// The low and the high part of light.
template <class T>
struct Divided {
  T low{}, high{};
};

/// Divides a value exactly: low + high == value without rounding; low is share * value with an error of 6e-8 of the
/// value. share is in [0, 1]. The larger part is rounded, and the smaller part is the remainder, which a float32 holds
/// exactly (Sterbenz). Below 2^-100 the remainder could be a denormal number, which processors flush to zero: then the
/// larger part gets the whole value.
Divided<float> divide(float value, double share);

/// The place by which a photon or a point belongs to a cell; the position is relative to the file's origin.
CellPlace place_of(const formats::Photon& photon);
CellPlace place_of(const formats::IrradiancePointRecord& point);

/// Adds a block's photons to the cells: their flux, times reflectance if the block has that column.
void add_flux(const formats::PhotonBlock& block, FluxCells& cells);
/// Adds points; the flux of a point is the irradiance of all kinds times area_of_point [m^2].
void add_flux(std::span<const formats::IrradiancePointRecord> points, double area_of_point, FluxCells& cells);

/// Low and high part of a block: photons in file order, without photons that have no flux in that part. A photon
/// without any flux is always in the low part.
Divided<formats::PhotonBlock> divide(const formats::PhotonBlock& block, const FluxCells& cells);

/// The low part has all points, the high part the points with irradiance in it. All kinds of a point are divided by the
/// same share.
Divided<std::vector<formats::IrradiancePointRecord>> divide(std::span<const formats::IrradiancePointRecord> points,
                                                            const FluxCells& cells);

/// The inverse of divide(): adds the high part to the low part, which becomes the whole to the last bit. Returns for
/// each point the high part's share of the point's light, summed over kinds and channels. The result is empty if a
/// point of `high` is not in `low`, or if the order of the points differs.
std::vector<float> join_parts(std::span<formats::IrradiancePointRecord> low,
                              std::span<const formats::IrradiancePointRecord> high);

/// The inverse of divide() for photons: adds the high part's flux to the low part, which becomes the whole. Photons
/// keep the order of the low part; photons without a low part come last. `low` and `high` must be the two parts of one
/// map; the caller checks this.
void join_parts(formats::PhotonMap& low, const formats::PhotonMap& high);

}  // namespace tempolux
