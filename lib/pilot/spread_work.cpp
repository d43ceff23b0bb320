#include "lib/pilot/spread_work.h"

#include <cmath>

#include "lib/gather/final_gather.h"
#include "lib/render/photon_light.h"
#include "lib/render/pixel_noise.h"

namespace tempolux {
namespace {

/// Ratio of the squared error of a density of k photons to light^2 / k. The ratio is above 1 because photons differ in
/// flux, and because photons near the rim of the density's disc have less weight. The caustic light of S8 and of
/// furnished_day has the ratios 2.4 and 2.3 (docs/methods/ways.md).
constexpr double kOfPhotons = 2.4;
constexpr double kPhotonsOfAPlace = PhotonLightOptions{}.caustic_neighbours;
/// Number of pixels over which the filter averages inside surfaces: it leaves .03 to .09 of the samples' squared error
/// there (docs/notebook/st-filter.md).
constexpr double kFilterPixels = 16;
/// Filtered samples leave a squared error in proportion to n^-kFiltered, n: number of samples (docs/methods/ways.md).
constexpr double kFiltered = 0.75;
constexpr double kFewestSamples = 4;  ///< of a pixel, as in the preset final
constexpr int kShares = 12;           ///< steps of the share of samples below 1

double share_of(int step) { return std::exp2(-step / 4.0); }

/// Error and work of a picture that takes other numbers of samples, light paths and rays than AskedPicture.
class Spread {
 public:
  Spread(const RoughFrame& rough, const AskedPicture& asked)
      : rough_(rough),
        asked_(asked),
        sample_error_(asked.sample_error * std::pow(asked.samples, 1 - stratified_rate())) {}

  double error(const SpreadWork& with) const {
    return Seen::kSamples * sample_error_ * std::pow(with.samples, -kFiltered) +
           seen_map_error(rough_, asked_.pixels, with.photons) +
           (with.rays > 0 ? Seen::kRecords * asked_.ray_error / with.rays : 0);
  }
  double work(const SpreadWork& with) const {
    return asked_.pixels * asked_.sample_work * asked_.samples * with.samples + asked_.ray_work * with.rays +
           further(with.photons) * (path() / asked_.pictures + Work::kPhotonRead * rough_.photons_per_path);
  }
  bool allows(std::uint64_t photons) const {
    return photons <= asked_.photons || (photons <= asked_.most_photons && further(photons) * path() <= asked_.work);
  }

 private:
  double path() const { return Work::kRay * (1 + rough_.photons_per_path); }
  double further(std::uint64_t photons) const { return double(photons) - double(asked_.photons); }

  const RoughFrame& rough_;
  const AskedPicture& asked_;
  double sample_error_;
};

}  // namespace

double seen_map_error(const RoughFrame& rough, double pixels, std::uint64_t photons) {
  double error = 0;
  for (const CausticPart& part : rough.caustic) {
    const double by_pixel = part.photons * double(photons) / (pixels / kPilotParts);
    for (const double box : kSeenBoxes)
      error += kOfPhotons * part.seen_square / (kPhotonsOfAPlace + by_pixel * (box * box - 1 + kFilterPixels));
  }
  return error;
}

SpreadWork spread_work(const RoughFrame& rough, const AskedPicture& asked) {
  const Spread spread(rough, asked);
  SpreadWork best{1, asked.rays, asked.photons};
  const double allowed = spread.error(best), fixed = asked.work - spread.work(best);
  const auto product = [&](const SpreadWork& with) { return (fixed + spread.work(with)) * spread.error(with); };
  const auto consider = [&](const SpreadWork& other) {
    if (other.rays > 0 && other.rays < FinalGather::kDistanceRays) return;
    if (spread.error(other) <= allowed && product(other) < product(best)) best = other;
  };
  for (std::uint64_t photons = asked.photons; photons > 0 && spread.allows(photons); photons *= 2)
    for (int step = 0; step <= kShares && (step == 0 || asked.samples * share_of(step) >= kFewestSamples); ++step)
      for (const int rays : {asked.rays / 2, asked.rays, 2 * asked.rays, 4 * asked.rays})
        consider({share_of(step), rays, photons});
  return best;
}

}  // namespace tempolux
