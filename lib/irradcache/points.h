// lib/irradcache/points.h -- irradiance points: what a gather ray reads at its hit.
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

/// Irradiance at one side of a surface point, by kind of the light that arrives [W/m^2].
struct IrradiancePoint {
  Vec3 position;             ///< m, scene space
  Vec3 normal;               ///< unit, geometric, on the side that is lit
  std::uint32_t object = 0;  ///< id.object
  float radius = 0;          ///< m: of the density estimate behind `indirect`; 0: none was possible
  Rgb direct{0.0f};          ///< L D, by light sampling
  Rgb caustic{0.0f};         ///< L S+ D, by density
  Rgb indirect{0.0f};        ///< everything else, by density
  Rgb total() const { return direct + caustic + indirect; }
};

/// What is seen around a place: its clearance up to `reach` [m]. lib/gather's point_clearance().
using ClearanceTest = std::function<Clearance(Vec3 position, Vec3 normal, float reach)>;

/// Finds the point that stands for a hit: one that faces the same way, lies in the same plane, and from which the hit
/// can be reached along the surface (Clearance). Where no point stands for the hit there is no answer: whoever asks
/// follows the light further.
///
/// The point nearest to the middle of the hit's cell (a cube of 1/1.4 spacing, one of 64 directions) is asked first. A
/// cell's first choice depends on the cell alone and is remembered, so that most look-ups are one table access; what a
/// point sees around it depends on the point alone and is looked at when it is first read. If that one does not stand
/// for the hit, the eight nearest to the hit are asked. Answers are the same for any number of threads.
class PointLookup {
 public:
  /// What a gather ray reads: a cache line.
  struct alignas(64) Light {
    Vec3 position, normal;
    Rgb all{0.0f};                                                  ///< W/m^2, of all kinds
    float radius = 0;                                               ///< as IrradiancePoint's
    std::uint32_t point = 0;                                        ///< index of the IrradiancePoint
    mutable std::array<std::atomic<std::uint64_t>, 2> clearance{};  ///< Clearance::shares; kNotLooked: either
    mutable std::atomic<std::uint8_t> uneven{kNotAsked};
    bool beside_lamp = false;  ///< note_lamp()
  };

  /// spacing: mean distance of neighbouring points, m, > 0. Keeps the span; it must outlive this. Without a test a
  /// point stands for all that faces its way and is asked first or near, whatever is between.
  PointLookup(std::span<const IrradiancePoint> points, float spacing, ClearanceTest look = {});

  /// A look-up in three steps. Memory is slow: ask for several places, then take the answers, then read them;
  /// each step fetches what the next needs.
  struct Question {
    Vec3 position, normal;
    std::uint64_t cell = 0;  ///< 0: too far out to have one
  };
  struct Answer {
    std::uint32_t value = 0;  ///< point + 1; 0: none faces this way
  };
  /// normal: unit, on the lit side. All thread-safe.
  Question ask(Vec3 position, Vec3 normal) const;
  Answer answer(const Question& question) const;
  /// nullptr if no point stands for the hit.
  const Light* read(const Question& question, Answer answer) const;
  /// The three at once.
  const Light* find(Vec3 position, Vec3 normal) const {
    const Question question = ask(position, normal);
    return read(question, answer(question));
  }
  std::size_t size() const { return points_.size(); }
  float spacing() const { return spacing_; }
  /// Of point number `point`.
  const Light& light(std::uint32_t point) const { return lights_[point]; }
  const IrradiancePoint& point(const Light& read) const { return points_[read.point]; }
  std::span<const IrradiancePoint> points() const { return points_; }
  /// Is a point's light of a kind that of the places near it? Not where some of the points beside it (within 1.5
  /// spacings) get kContrast times as much of it as others, of indirect light surely kContrastOfIndirect times
  /// (apart()): there a shadow or a bright spot ends. Nor where fewer than two points are beside it, for its direct
  /// light: what shows that one point in a wall's shadow is not all of the wall? Direct light: a hit is to sample it
  /// itself. Read instead, light would reach a spacing into shadows and out of gaps, where much of what sees it is: the
  /// ground in a chair's shadow is seen by the chair. Indirect light (beside points of the same object alone): a ray is
  /// to go on from the hit. A lamp a finger below the ceiling lights the gap behind it a hundred times as strongly as
  /// what is seen of the ceiling; read instead, that light would reach a spacing out of the gap. A point's own light
  /// has no say in it: it is known by a few shadow rays or photons, and were those that came out bright replaced, what
  /// is read would be dark in the mean.
  bool is_even(const Light& light) const { return !light.beside_lamp && !(unevenness(light) & kDirect); }
  bool is_even_indirect(const Light& light) const { return !(unevenness(light) & kIndirect); }
  static constexpr float kContrast = 8;
  /// From now on the direct light of this point is not that of the places it stands for: a lamp so near lights a spot
  /// smaller than the spacing, which a point misses as a rule and stands for all of it where it does not. Not to be
  /// called while others look up.
  void note_lamp(std::uint32_t point) { lights_[point].beside_lamp = true; }
  /// A ray that goes on costs several that are read, and what leaks from a place of moderate contrast is little. With 8
  /// instead of 32 S8's frame took 17 % and S4's records 11 % more CPU at the same error; CornellBox's gap has 100.
  static constexpr float kContrastOfIndirect = 32;
  /// Is indirect light at `bright` that many times what it is at `dark`, by three standard errors? An estimate of k =
  /// PointOptions::neighbours photons errs by 1 / sqrt(k) of itself; one that found fewer has the widest radius of all,
  /// and does not say how many: as `bright` it proves nothing. As `dark` it is taken for one of photons like those of
  /// `bright`: each adds e = E_bright r_bright^2 / (k r_dark^2), and the variance of n of them is (n + 1) e^2 (one
  /// more, as none found does not prove that there is none):
  ///     E_bright - c E_dark > 3 sqrt(E_bright^2 / k + c^2 (E_dark e + e^2)),   c = kContrastOfIndirect
  bool apart(const IrradiancePoint& bright, const IrradiancePoint& dark) const;

  /// A hit reads its point only if the hit is farther away than about this many radii of the point's density estimate.
  /// Nearer hits would show the blur of the estimate.
  static constexpr float kNear = 2;
  /// Is a hit at `distance` m along the way from the last Lambert lobe so near? u in [0, 1) moves the limit between
  /// half and one and a half of it, so that it shows no seam.
  static bool is_near(const Light& light, float distance, float u, float radii = kNear) {
    return distance < radii * light.radius * (0.5f + u);
  }
  /// Share of the u for which a hit is not near; radius: Light::radius.
  static float share_of_far(float radius, float distance) {
    return radius > 0 ? std::clamp(distance / (kNear * radius) - 0.5f, 0.0f, 1.0f) : 1.0f;
  }

  static constexpr float kReach = 2;  ///< spacings: farther off no point stands for a hit

 private:
  static constexpr std::uint8_t kNotAsked = 0, kKnown = 1, kDirect = 2, kIndirect = 4;  ///< of Light::uneven: the last
                                                                                        ///< two are bits beside kKnown
  static constexpr std::uint64_t kNotLooked = 0;  ///< eight spokes of no length are kept as one of 1/255
  struct Entry {
    std::atomic<std::uint64_t> cell{0};
    std::atomic<std::uint32_t> answer{0};  ///< Answer::value + 1; 0: not there yet
  };
  std::uint8_t unevenness(const Light& light) const {
    const std::uint8_t known = light.uneven.load(std::memory_order_relaxed);
    return known == kNotAsked ? compare_neighbours(light) : known;
  }
  float widest_ = 0;  ///< m: of the points' radii
  std::uint8_t compare_neighbours(const Light& light) const;
  bool stands_for(const Light& light, const Question& question) const;
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
  return stands_for(light, question) ? &light : search(question);
}

}  // namespace tempolux
