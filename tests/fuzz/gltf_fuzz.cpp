// tests/fuzz/gltf_fuzz.cpp -- the glTF gate and loader, then the scene at two frames.
#include "lib/scene/at_frame.h"
#include "lib/scene/gltf_load.h"
#include "tests/fuzz/fuzz.h"

using namespace tempolux;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".glb");
  fuzz::expect_read_or_refused(path, [&] {
    const Scene scene = load_gltf(path);
    TimeOptions time;
    time.segment_length = 4;
    const SegmentScene segment(scene, segment_of(scene, 0, time), time);
    for (const int frame : {0, frame_in_animation(scene, 3, time)}) segment.at(frame);
  });
  return 0;
}
