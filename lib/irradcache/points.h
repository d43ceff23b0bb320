// lib/irradcache/points.h -- irradiance points, which gather rays read at their hits.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/core/vec.h"
#include "lib/density/photon_index.h"
#include "lib/irradcache/clearance.h"

namespace tempolux {

/// Irradiance on one side of a surface point, by kind of light [W/m^2].
struct IrradiancePoint {
  Vec3 position;             ///< m, scene space
  Vec3 normal;               ///< unit, geometric, on the lit side
  std::uint32_t object = 0;  ///< id.object
  float radius = 0;          ///< m: radius of the density estimate of `indirect`; 0: the estimate found no photons
  Rgb direct{0.0f};          ///< by light sampling (paths L D)
  Rgb caustic{0.0f};         ///< by density estimation (paths L S+ D)
  Rgb indirect{0.0f};        ///< by density estimation: all other paths
  /// A random number of mean 0 whose mean square is the variance of caustic + indirect (path_signs.h). 0: unknown.
  Rgb noise{0.0f};
  Rgb total() const { return direct + caustic + indirect; }
};

/// Computes the clearance of a place up to `reach` [m]: point_clearance() in lib/points/irradiance_points.h.
using ClearanceTest = std::function<Clearance(Vec3 position, Vec3 normal, float reach)>;

/// Finds the point that represents a hit: a point that faces the same way, lies in the same plane, and from which the
/// hit can be reached along the surface (Clearance). If there is no such point, the caller continues the ray.
///
/// A hit belongs to a cell: a cube of 1/1.4 spacing and one of 64 directions of the normal. The point closest to the
/// middle of the cell is tried first. This point depends only on the cell and is stored, so most look-ups read one
/// table entry. A point's clearance is computed when it is first needed. If the first point does not represent the hit,
/// the eight points closest to the hit are tried. Results are the same for any number of threads.
class PointLookup {
 public:
  /// The data that a gather ray reads, in one cache line.
  struct alignas(64) Light {
    Vec3 position, normal;
    Rgb all{0.0f};            ///< W/m^2, sum of all kinds
    float radius = 0;         ///< m: IrradiancePoint::radius
    std::uint32_t point = 0;  ///< index of the IrradiancePoint
    /// Clearance::shares; kNotLooked if not yet computed
    mutable std::array<std::atomic<std::uint64_t>, 2> clearance{};
    mutable std::atomic<std::uint8_t> uneven{kNotAsked};
    bool beside_lamp = false;  ///< set by note_lamp()
  };

  /// `spacing` [m], > 0: mean distance of neighbouring points. `points` must outlive this object. If `look` is empty,
  /// clearance is not tested.
  PointLookup(std::span<const IrradiancePoint> points, float spacing, ClearanceTest look = {});

  /// A look-up has three steps, so that the memory for several hits is fetched at once: ask() for each hit, then
  /// answer() for each hit, then read(). Each step prefetches the memory that the next step needs. All are thread-safe.
  struct Question {
    Vec3 position, normal;
    std::uint64_t cell = 0;  ///< 0: too far from the origin to have a cell
  };
  /// `position`: m, scene space. `normal`: unit, on the lit side.
  Question ask(Vec3 position, Vec3 normal) const;
  /// The point of the hit's cell, + 1; 0: no point faces this way.
  std::uint32_t answer(const Question& question) const;
  /// The point that represents the hit, or nullptr. `answer`: the result of answer().
  const Light* read(const Question& question, std::uint32_t answer) const;
  /// All three steps for one hit.
  const Light* find(Vec3 position, Vec3 normal) const {
    const Question question = ask(position, normal);
    return read(question, answer(question));
  }
  /// The closest point that faces within 90 degrees of `normal`, even if a surface lies between; nullptr if no point
  /// faces this way. Its radius gives the scale of the photons around a place; its light may be that of another
  /// surface.
  const Light* nearest(Vec3 position, Vec3 normal) const;
  std::size_t size() const { return points_.size(); }
  float spacing() const { return spacing_; }
  /// The light of point number `point`.
  const Light& light(std::uint32_t point) const { return lights_[point]; }
  const IrradiancePoint& point(const Light& read) const { return points_[read.point]; }
  std::span<const IrradiancePoint> points() const { return points_; }
  /// True if direct light changes little around a point. If it does not, the hit samples direct light itself, because
  /// the point's light would extend by a spacing into a shadow, where an error is large: a chair sees mostly the ground
  /// in its own shadow. Direct light is uniform if the point has at least two neighbours (points within 1.5 spacings),
  /// and no neighbour gets kContrast times as much direct light as another. (A single point in a wall's shadow does not
  /// represent the whole wall.)
  ///
  /// The point's own light is not compared, because it is estimated from a few shadow rays or photons. If points whose
  /// estimates are too bright were left out, the mean of all light read would be too dark.
  bool is_uniform(const Light& light) const { return !light.beside_lamp && !(unevenness(light) & kDirect); }
  /// True if indirect light changes little around a point: no neighbour of the same object is apart() from another. If
  /// it does not, the gather ray continues. A lamp a finger's width below the ceiling lights the ceiling behind it a
  /// hundred times as strongly as the visible ceiling; a point's light would extend by a spacing from the gap onto the
  /// visible ceiling.
  bool is_uniform_indirect(const Light& light) const { return !(unevenness(light) & kIndirect); }
  /// Makes light count as uniform around all points, without a comparison. A pilot uses it, whose few points represent
  /// the many points of the frame: the neighbours in the frame will be much closer, and their light more similar. Must
  /// not be called during look-ups.
  void take_as_even() {
    for (Light& light : lights_) light.uneven.store(kKnown, std::memory_order_relaxed);
  }
  static constexpr float kContrast = 8;
  /// Marks a point's direct light as not uniform because a lamp is close. Such a lamp lights a spot smaller than the
  /// spacing: most spots contain no point, and a point inside a spot would represent too large an area. Must not be
  /// called during look-ups.
  void note_lamp(std::uint32_t point) { lights_[point].beside_lamp = true; }
  /// Smallest ratio of the indirect light of two neighbours that are apart(). A gather ray that continues costs as much
  /// as several that read a point, and errors at moderate contrast are small: with 8 instead of 32 S8's frame took 17 %
  /// and S4's records 11 % more CPU time at the same error. The gap above the lamp of CornellBox has a contrast of 100.
  static constexpr float kContrastOfIndirect = 32;
  /// True if indirect light at `bright` is at least c = kContrastOfIndirect times the light at `dark`, by three
  /// standard errors:
  ///     E_bright - c E_dark > 3 sqrt(E_bright^2 / k + c^2 (E_dark e + e^2))
  /// An estimate from k = PointOptions::neighbours photons has a relative error of 1 / sqrt(k). If an estimate found
  /// fewer photons, its radius is the largest of all points, and the number of its photons is not stored: then `bright`
  /// proves nothing. The photons of `dark` are assumed to have the flux of those of `bright`, so each adds
  /// e = E_bright r_bright^2 / (k r_dark^2), and n of them have the variance (n + 1) e^2. One is added to n because an
  /// estimate without photons does not prove that there is no light.
  bool apart(const IrradiancePoint& bright, const IrradiancePoint& dark) const;

  /// A hit reads its point only if it is farther away than about this many radii of the point's density estimate. At
  /// closer hits the blur of the estimate would be visible.
  static constexpr float kNear = 2;
  /// True if a hit is too close to read its point. `distance` [m]: length of the path since the last Lambert lobe. A
  /// random u in [0, 1) varies the limit from 1/2 to 3/2 of its value, so that the limit leaves no visible seam.
  static bool is_near(const Light& light, float distance, float u) {
    return distance < kNear * light.radius * (0.5f + u);
  }
  /// Probability over u that is_near() is false; `radius` is Light::radius [m].
  static float share_of_far(float radius, float distance) {
    return radius > 0 ? std::clamp(distance / (kNear * radius) - 0.5f, 0.0f, 1.0f) : 1.0f;
  }

  static constexpr float kReach = 2;  ///< spacings: largest distance between a hit and the point that represents it

 private:
  /// Values of Light::uneven; kDirect and kIndirect are bits added to kKnown.
  static constexpr std::uint8_t kNotAsked = 0, kKnown = 1, kDirect = 2, kIndirect = 4;
  /// Value of Light::clearance before it is computed. A clearance of eight spokes without length is stored as 1/255.
  static constexpr std::uint64_t kNotLooked = 0;
  struct Entry {
    std::atomic<std::uint64_t> cell{0};
    std::atomic<std::uint32_t> answer{0};  ///< answer() + 1; 0: not yet computed
  };
  std::uint8_t unevenness(const Light& light) const {
    const std::uint8_t known = light.uneven.load(std::memory_order_relaxed);
    return known == kNotAsked ? compare_neighbours(light) : known;
  }
  float widest_ = 0;  ///< m: largest radius of the points
  std::uint8_t compare_neighbours(const Light& light) const;
  bool represents(const Light& light, const Question& question) const;
  std::uint32_t find_answer(const Question& question) const;
  std::uint32_t search_cell(std::uint64_t cell) const;
  const Light* search(const Question& question) const;

  std::span<const IrradiancePoint> points_;
  ClearanceTest look_;
  PhotonIndex index_;
  float spacing_, inverse_cell_;
  std::vector<Light> lights_;  ///< by point
  std::size_t mask_;
  std::unique_ptr<Entry[]> entries_;
};

inline std::uint32_t PointLookup::answer(const Question& question) const {
  const Entry& entry = entries_[mix64(question.cell) & mask_];
  const std::uint32_t known =
      entry.cell.load(std::memory_order_relaxed) == question.cell ? entry.answer.load(std::memory_order_relaxed) : 0;
  const std::uint32_t answer = known ? known - 1 : find_answer(question);
  if (answer) __builtin_prefetch(&lights_[answer - 1]);
  return answer;
}

inline const PointLookup::Light* PointLookup::read(const Question& question, std::uint32_t answer) const {
  if (!answer) return nullptr;
  const Light& light = lights_[answer - 1];
  return represents(light, question) ? &light : search(question);
}

}  // namespace tempolux
