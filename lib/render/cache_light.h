// lib/render/cache_light.h -- indirect light from irradiance records, caustic light from photons.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>

#include "lib/gather/place_records.h"
#include "lib/render/camera_view.h"
#include "lib/render/photon_light.h"

namespace tempolux {

/// Indirect irradiance interpolated between records; where none is near it is gathered on the spot, which is
/// slow, exact and counted. Where a place is seen directly, records with larger radii are tried before: one of the pixel's
/// own is a fraction of a pixel away. Through glass and gloss places are seen that nobody looked at when records were
/// placed, and what is near them need not be theirs: inside a ball of glass it was the ground below. Caustic irradiance is that of `photons`, if given.
class CacheLight : public DiffuseLight {
 public:
  /// `gather` is asked for once, when it is first needed; it may take its time and run parallel loops. It may
  /// return nullptr: then there is no light where no record is near.
  CacheLight(const RecordStore& records, std::function<const FinalGather*()> gather, const PhotonLight* photons)
      : records_(records), make_gather_(std::move(gather)), photons_(photons) {}

  Irradiance at(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, bool direct_view, const Rgb* caustic) const override;
  std::uint64_t gathered_on_the_spot() const { return missing_.load(); }

 private:
  const RecordStore& records_;
  std::function<const FinalGather*()> make_gather_;
  mutable std::once_flag gather_made_;
  mutable const FinalGather* gather_ = nullptr;
  const PhotonLight* photons_;
  mutable std::atomic<std::uint64_t> missing_{0};
};

/// What up to kLooksTogether raster positions see: the first surface with a Lambert lobe, through mirrors and glass by the
/// likelier of reflection and transmission, or by one drawn from Look::random.
void seen_through(const Tracer& tracer, const CameraView& view, std::span<const Look> looks,
                  std::span<std::optional<SeenPoint>> seen);

}  // namespace tempolux
