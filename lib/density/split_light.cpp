#include "lib/density/split_light.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "lib/core/arrays.h"

namespace tempolux {
namespace {

using formats::IrradiancePointRecord;
using formats::Photon;
using formats::PhotonBlock;

constexpr float kLeastDivided = 0x1p-100f;

bool is_zero(const std::array<float, 3>& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

/// Appends photon i of a block, as `photon`, with the block's columns.
void append(PhotonBlock& to, const PhotonBlock& from, std::size_t i, const Photon& photon) {
  to.photons.push_back(photon);
  if (!from.directions.empty()) to.directions.push_back(from.directions[i]);
  if (!from.albedos.empty()) to.albedos.push_back(from.albedos[i]);
}

Divided<std::array<float, 3>> divide_channels(const std::array<float, 3>& value, double share) {
  Divided<std::array<float, 3>> parts;
  for (std::size_t c = 0; c < 3; ++c) {
    const Divided<float> part = divide(value[c], share);
    parts.low[c] = part.low, parts.high[c] = part.high;
  }
  return parts;
}

}  // namespace

Divided<float> divide(float value, double share) {
  if (share >= 1) return {value, 0};
  if (share <= 0) return {0, value};
  if (!(std::abs(value) >= kLeastDivided)) return share >= 0.5 ? Divided<float>{value, 0} : Divided<float>{0, value};
  if (share >= 0.5) {
    const float low = float(double(value) * share);
    return {low, value - low};
  }
  const float high = float(double(value) * (1 - share));
  return {value - high, high};
}

CellPlace place_of(const Photon& photon) {
  return {vec_of(photon.position), vec_of(formats::decode_normal(photon.normal)), photon.object};
}

CellPlace place_of(const IrradiancePointRecord& point) {
  return {vec_of(point.position), vec_of(formats::decode_normal(point.normal)), point.object};
}

void add_flux(const PhotonBlock& block, FluxCells& cells) {
  for (std::size_t i = 0; i < block.photons.size(); ++i) {
    std::array<float, 3> flux = block.photons[i].flux;
    if (!block.albedos.empty())
      for (std::size_t c = 0; c < 3; ++c) flux[c] *= float(block.albedos[i][c]) / 255;
    cells.add(place_of(block.photons[i]), flux);
  }
}

void add_flux(std::span<const IrradiancePointRecord> points, double area_of_point, FluxCells& cells) {
  for (const IrradiancePointRecord& point : points) {
    std::array<float, 3> flux{};
    // Clamps the sum of the three kinds to finite values: such a point is bright under any limit.
    for (std::size_t c = 0; c < 3; ++c)
      flux[c] = float(std::min(
          (double(point.direct[c]) + double(point.caustic[c]) + double(point.indirect[c])) * area_of_point, 3e38));
    cells.add(place_of(point), flux);
  }
}

Divided<PhotonBlock> divide(const PhotonBlock& block, const FluxCells& cells) {
  Divided<PhotonBlock> parts;
  parts.low.group = parts.high.group = block.group;
  for (std::size_t i = 0; i < block.photons.size(); ++i) {
    const double share = cells.low_share(place_of(block.photons[i]));
    const auto flux = divide_channels(block.photons[i].flux, share);
    Photon part = block.photons[i];
    part.flux = flux.high;
    const bool has_high = !is_zero(flux.high);
    if (has_high) append(parts.high, block, i, part);
    part.flux = flux.low;
    if (!has_high || !is_zero(flux.low)) append(parts.low, block, i, part);
  }
  return parts;
}

Divided<std::vector<IrradiancePointRecord>> divide(std::span<const IrradiancePointRecord> points,
                                                   const FluxCells& cells) {
  Divided<std::vector<IrradiancePointRecord>> parts;
  for (const IrradiancePointRecord& point : points) {
    const double share = cells.low_share(place_of(point));
    IrradiancePointRecord low = point, high = point;
    high.noise = {};
    for (const auto kind :
         {&IrradiancePointRecord::direct, &IrradiancePointRecord::caustic, &IrradiancePointRecord::indirect}) {
      const auto part = divide_channels(point.*kind, share);
      low.*kind = part.low, high.*kind = part.high;
    }
    parts.low.push_back(low);
    if (!is_zero(high.direct) || !is_zero(high.caustic) || !is_zero(high.indirect)) parts.high.push_back(high);
  }
  return parts;
}

std::vector<float> join_parts(std::span<IrradiancePointRecord> low, std::span<const IrradiancePointRecord> high) {
  std::vector<float> shares(low.size(), 0.0f);
  std::size_t at = 0;
  for (const IrradiancePointRecord& bright : high) {
    while (at < low.size() &&
           (low[at].position != bright.position || low[at].normal != bright.normal || low[at].object != bright.object))
      ++at;
    if (at == low.size()) return {};
    double part = 0, whole = 0;
    for (const auto kind :
         {&IrradiancePointRecord::direct, &IrradiancePointRecord::caustic, &IrradiancePointRecord::indirect})
      for (std::size_t c = 0; c < 3; ++c) {
        (low[at].*kind)[c] += (bright.*kind)[c];
        part += double((bright.*kind)[c]);
        whole += double((low[at].*kind)[c]);
      }
    shares[at++] = whole > 0 ? float(std::min(1.0, part / whole)) : 0.0f;
  }
  return shares;
}

namespace {

/// Key of a photon: all that its two parts share, which is everything except the flux.
auto place_key(const Photon& p) { return std::tuple(p.position, p.normal, p.object, p.kind, p.bounce); }

/// Numbers of the photons sorted by key; equal keys keep the order of the file.
std::vector<std::size_t> order_by_key(std::span<const Photon> photons) {
  std::vector<std::size_t> order(photons.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return place_key(photons[i]); });
  return order;
}

}  // namespace

void join_parts(formats::PhotonMap& low, const formats::PhotonMap& high) {
  const std::vector<std::size_t> lows = order_by_key(low.photons), highs = order_by_key(high.photons);
  std::vector<bool> alone(high.photons.size());
  std::size_t at = 0;
  for (const std::size_t h : highs) {
    const Photon& part = high.photons[h];
    while (at < lows.size() && place_key(low.photons[lows[at]]) < place_key(part)) ++at;
    alone[h] = at == lows.size() || place_key(low.photons[lows[at]]) != place_key(part);
    if (alone[h]) continue;
    Photon& whole = low.photons[lows[at++]];
    for (std::size_t c = 0; c < 3; ++c) whole.flux[c] += part.flux[c];
  }
  for (std::size_t h = 0; h < alone.size(); ++h) {
    if (!alone[h]) continue;
    low.photons.push_back(high.photons[h]);
    if (!high.directions.empty()) low.directions.push_back(high.directions[h]);
  }
  low.header.part.clear();
  low.totals.photon_count = low.photons.size();
}

}  // namespace tempolux
