// Photons in media: records represent the fluence, flux is balanced, and results do not depend on the division of work.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/photons/layout.h"
#include "lib/photon/photon_map.h"
#include "lib/photon/photon_trace.h"
#include "tests/support/closed_box.h"
#include "tests/support/media.h"

namespace tempolux {
namespace {

struct Sums {
  double surfaces = 0;  ///< W, stored at surfaces
  double collided = 0;  ///< W: records times extinction
  double fluence = 0;   ///< W m: sum of the records
  double direct = 0;    ///< W m: the part straight from the lamp
  Rgbd emitted{0.0}, escaped{0.0}, absorbed{0.0};
  std::size_t tentative = 0;
};

Sums trace_all(const SceneFrame& frame, const EmissionTable& table, const PhotonOptions& options) {
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  const PhotonTracer photons(tracer, lights, options);
  Sums sums;
  for (std::size_t b = 0; b < photons.batch_count(); ++b) {
    const PhotonBatch batch = photons.trace(b);
    for (const formats::Photon& photon : batch.block.photons) {
      if (photon.kind != formats::PathKind::tentative) {
        sums.surfaces += double(photon.flux[1]);
        continue;
      }
      ++sums.tentative;
      sums.fluence += double(photon.flux[1]);
      sums.collided += double(photon.flux[1] *
                              frame.media->extinction({photon.position[0], photon.position[1], photon.position[2]}));
      if (photon.bounce == 0) sums.direct += double(photon.flux[1]);
    }
    sums.emitted += batch.emitted;
    sums.escaped += batch.escaped;
    sums.absorbed += batch.absorbed;
  }
  return sums;
}

/// In a black room with a black medium, all flux that does not reach the walls has collided, for thin and for dense
/// media. Seen to fail: only accepted collisions recorded.
TEST(PhotonMedia, RecordsTimesExtinctionAreWhatCollides) {
  for (const float sigma : {0.01f, 1.0f, 30.0f}) {
    test::ClosedBox box(test::Shape::cube, 0);
    box.scene.set_media(test::cube_of_medium({0, 0.1, 0}, 1.2, {.sigma_t = sigma, .albedo = Rgb(0.0f)}));
    PhotonOptions options;
    options.photon_count = 100000;
    options.store_volume = true;
    const Sums sums = trace_all(box.scene.frame(), box.table, options);
    const double lost = sums.emitted.g - sums.surfaces;
    // The lost shares are .0036, .31 and 1. Each of 10^5 paths is lost or not, and leaves about four records with
    // exponentially distributed flux.
    const double share = lost / sums.emitted.g, sigma_of_share = std::sqrt(share * (1 - share + 0.5 * share) / 1e5);
    EXPECT_NEAR(sums.collided / sums.emitted.g, share, 5 * sigma_of_share) << sigma;
    EXPECT_NEAR(sums.absorbed.g, sums.emitted.g, 1e-9 * sums.emitted.g);
    EXPECT_GT(sums.tentative, sigma < 2 ? 200000u : 30000u) << "thin media get records too";
  }
}

/// A medium without absorption in a black room: all light of the lamp ends at the walls.
TEST(PhotonMedia, WhatScattersOnlyArrives) {
  test::ClosedBox box(test::Shape::cube, 0);
  box.scene.set_media(test::cube_of_medium({0, 0.1, 0}, 1.2, {.sigma_t = 5, .albedo = Rgb(1.0f), .g = 0.5f}));
  PhotonOptions options;
  options.photon_count = 50000;
  options.store_volume = true;
  const Sums sums = trace_all(box.scene.frame(), box.table, options);
  // Russian roulette with 0.9995 per scattering, about 15 scatterings: .0075 of the paths end, and the others make up
  // for them.
  EXPECT_NEAR(sums.surfaces, sums.emitted.g, 0.002 * sums.emitted.g);
  options.store_direct = false;
  const Sums without = trace_all(box.scene.frame(), box.table, options);
  EXPECT_EQ(without.direct, 0);
  EXPECT_NEAR(without.fluence, sums.fluence - sums.direct, 1e-6 * sums.fluence) << "the rest is the same records";
}

TEST(PhotonMedia, FileHasLedgerMajorantsAndDirections) {
  test::ClosedBox box(test::Shape::cube, 0.3f);
  PhotonOptions options;
  options.photon_count = 20000;
  options.store_volume = true;
  for (const float g : {0.0f, 0.7f}) {
    box.scene.set_media(test::cube_of_medium({}, 1.2, {.sigma_t = 3, .albedo = Rgb(0.8f), .g = g}));
    const Tracer tracer(box.scene.frame());
    const Lights lights(box.scene.frame(), box.table);
    const PhotonTracer photons(tracer, lights, options);
    std::string bytes;
    formats::PhotonHeader header;
    header.identity.first_frame = header.identity.last_frame = 12;
    write_photon_map(photons, header,
                     [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                     {});
    EXPECT_EQ(bytes.substr(8, 4), std::string("\1\0\3\0", 4));
    EXPECT_NE(bytes.find("majorants: " + photons.majorants().hash()), std::string::npos);
    EXPECT_NE(bytes.find(g == 0 ? "columns: none" : "columns: direction"), std::string::npos);
    EXPECT_NE(bytes.find("LEDU"), std::string::npos);
    EXPECT_EQ(photons.group_count(), 210u);
  }
}

}  // namespace
}  // namespace tempolux
