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
  Rgb total() const { return direct + caustic + indirect; }
};

/// Computes the clearance of a place up to `reach` [m]: lib/gather's point_clearance().
using ClearanceTest = std::function<Clearance(Vec3 position, Vec3 normal, float reach)>;

/// Finds the point that represents a hit: a point that faces the same way, lies in the same plane, and from which the
/// hit can be reached along the surface (Clearance). If there is none, the caller follows the light further.
/// A hit's cell is a cube of 1/1.4 spacing, for one of 64 directions. The point nearest to the middle of the cell is
/// tried first. It depends on the cell alone and is remembered, so most look-ups read one table entry. A point's
/// clearance depends on the point alone and is computed when it is first needed. If the first point does not represent
/// the hit, the eight points nearest to the hit are tried. Results are the same for any number of threads.
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
    bool beside_lamp = false;  ///< note_lamp()
  };

  /// `spacing` [m], > 0: mean distance of neighbouring points. `points` must outlive this object. Without `look`,
  /// clearance is not tested.
  PointLookup(std::span<const IrradiancePoint> points, float spacing, ClearanceTest look = {});

  /// A look-up in three steps: ask for several hits, then take all answers, then read them. Each step prefetches the
  /// memory that the next step needs.
  struct Question {
    Vec3 position, normal;
    std::uint64_t cell = 0;  ///< 0: too far from the origin to have a cell
  };
  struct Answer {
    std::uint32_t value = 0;  ///< point + 1; 0: no point faces this way
  };
  /// `normal` is unit, on the lit side. ask, answer and read are thread-safe.
  Question ask(Vec3 position, Vec3 normal) const;
  Answer answer(const Question& question) const;
  /// nullptr if no point represents the hit.
  const Light* read(const Question& question, Answer answer) const;
  /// All three steps for one hit.
  const Light* find(Vec3 position, Vec3 normal) const {
    const Question question = ask(position, normal);
    return read(question, answer(question));
  }
  /// The closest point that faces within 90 degrees of `normal`, even if a surface lies between. Gives the scale of
  /// the photons around a place, not its light. nullptr if no point faces this way.
  const Light* nearest(Vec3 position, Vec3 normal) const;
  std::size_t size() const { return points_.size(); }
  float spacing() const { return spacing_; }
  /// The light of point number `point`.
  const Light& light(std::uint32_t point) const { return lights_[point]; }
  const IrradiancePoint& point(const Light& read) const { return points_[read.point]; }
  std::span<const IrradiancePoint> points() const { return points_; }
  /// True if light of one kind changes little around a point. It does not if some neighbours (points within 1.5
  /// spacings) get kContrast times as much of it as others, because a shadow or a bright spot ends there. For
  /// indirect light the ratio must be kContrastOfIndirect for certain, see apart(). Direct light also needs at least
  /// two neighbours: a single point in a wall's shadow does not represent the whole wall.
  ///
  /// If direct light is uneven, the hit samples it by a shadow ray instead. The point's light would reach a spacing
  /// into shadows, where it matters: a chair sees mostly the ground in its own shadow. If indirect light is uneven
  /// (compared among points of one object), the gather ray continues. A lamp a finger's width below the ceiling
  /// lights the ceiling behind it a hundred times as strongly as the visible ceiling; the point's light would spread
  /// by a spacing from the gap onto the visible ceiling.
  ///
  /// A point's own light is not compared: it is estimated from a few shadow rays or photons. If points that came out
  /// too bright were left out, the mean of the light read would be too dark.
  bool is_uniform(const Light& light) const { return !light.beside_lamp && !(unevenness(light) & kDirect); }
  bool is_uniform_indirect(const Light& light) const { return !(unevenness(light) & kIndirect); }
  /// Skips the comparison of neighbours: light counts as uniform around all points. For a few points that represent
  /// many, whose real neighbours are much closer and so more alike. Must not be called during look-ups.
  void take_as_even() {
    for (Light& light : lights_) light.uneven.store(kKnown, std::memory_order_relaxed);
  }
  static constexpr float kContrast = 8;
  /// Marks a point's direct light as uneven because a lamp is close. Such a lamp lights a spot smaller than the
  /// spacing: most spots contain no point, and a point in a spot would represent too large an area. Must not be
  /// called during look-ups.
  void note_lamp(std::uint32_t point) { lights_[point].beside_lamp = true; }
  /// Continuing a gather ray costs several reads, and leaks at moderate contrast are small. With 8 instead of 32 S8's
  /// frame took 17 % and S4's records 11 % more CPU at the same error; the gap in CornellBox has a contrast of 100.
  static constexpr float kContrastOfIndirect = 32;
  /// True if indirect light at `bright` is kContrastOfIndirect times the light at `dark`, with three standard errors.
  /// An estimate from k = PointOptions::neighbours photons has a relative error of 1 / sqrt(k). An estimate with
  /// fewer photons has the widest radius of all points, and their number is not stored. As `bright` it proves
  /// nothing. As `dark` its photons are assumed to have the flux of those of `bright`: each adds e = E_bright
  /// r_bright^2 / (k r_dark^2), and n photons have the variance (n + 1) e^2 (one is added because finding no photon
  /// does not prove that there is none):
  ///     E_bright - c E_dark > 3 sqrt(E_bright^2 / k + c^2 (E_dark e + e^2)),   c = kContrastOfIndirect
  bool apart(const IrradiancePoint& bright, const IrradiancePoint& dark) const;

  /// A hit reads its point only if the hit is farther away than about this many radii of the point's density estimate.
  /// At closer hits the blur of the estimate would be visible.
  static constexpr float kNear = 2;
  /// True if a hit at `distance` m from the last Lambert lobe along the path is too close to read its point. u in [0,
  /// 1) varies the limit between half and one and a half times its value, so that it leaves no visible seam.
  static bool is_near(const Light& light, float distance, float u) {
    return distance < kNear * light.radius * (0.5f + u);
  }
  /// Share of the values of u for which a hit is not too close; `radius` is Light::radius.
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
    std::atomic<std::uint32_t> answer{0};  ///< Answer::value + 1; 0: not yet computed
  };
  std::uint8_t unevenness(const Light& light) const {
    const std::uint8_t known = light.uneven.load(std::memory_order_relaxed);
    return known == kNotAsked ? compare_neighbours(light) : known;
  }
  float widest_ = 0;  ///< m: largest radius of the points
  std::uint8_t compare_neighbours(const Light& light) const;
  bool represents(const Light& light, const Question& question) const;
  Answer answer_anew(const Question& question) const;
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

inline PointLookup::Answer PointLookup::answer(const Question& question) const {
  const Entry& entry = entries_[mix64(question.cell) & mask_];
  const std::uint32_t known =
      entry.cell.load(std::memory_order_relaxed) == question.cell ? entry.answer.load(std::memory_order_relaxed) : 0;
  const Answer answer = known ? Answer{known - 1} : answer_anew(question);
  if (answer.value) __builtin_prefetch(&lights_[answer.value - 1]);
  return answer;
}

inline const PointLookup::Light* PointLookup::read(const Question& question, Answer answer) const {
  if (!answer.value) return nullptr;
  const Light& light = lights_[answer.value - 1];
  return represents(light, question) ? &light : search(question);
}

}  // namespace tempolux
