// tests/support/photons.h -- reads all photons of a map into one array, in file order.
#pragma once

#include <vector>

#include "lib/photon/photon_trace.h"

namespace tempolux::test {

inline std::vector<formats::Photon> photons_of(const PhotonTracer& tracer) {
  std::vector<formats::Photon> photons;
  for (std::size_t batch = 0; batch < tracer.batch_count(); ++batch) {
    const std::vector<formats::Photon> some = tracer.trace(batch).block.photons;
    photons.insert(photons.end(), some.begin(), some.end());
  }
  return photons;
}

}  // namespace tempolux::test
