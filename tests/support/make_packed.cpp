// make-packed FOLDER -- writes the test data tests/data/packed. In scenes/: a square packed by Draco, by meshopt, and
// with a WebP or an AVIF as its colour. In webp/ and avif/: these images. The fuzz replay changes these files byte by
// byte.
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/lib/scene/packed_scene.h"

int main(int argc, char** argv) {
  using namespace tempolux;
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  const auto save = [&](const char* name, const GltfMaker& maker, bool binary) {
    std::ofstream(folder / "scenes" / name, std::ios::binary) << (binary ? maker.glb() : maker.text());
  };
  save("draco-lossless.glb", test::draco_square(), true);
  save("draco-11-bits.glb", test::draco_square(11), true);
  save("meshopt.gltf", test::meshopt_square(), false);
  const std::vector<std::uint8_t> colours{255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 9, 9, 9, 9};
  const std::string webp = test::webp_bytes(2, 2, 4, colours), avif = test::avif_bytes(2, 2, 4, colours);
  save("webp.glb", test::webp_square(webp), true);
  save("avif.glb", test::avif_square(avif), true);
  std::ofstream(folder / "webp/colours.webp", std::ios::binary) << webp;
  std::ofstream(folder / "avif/colours.avif", std::ios::binary) << avif;
}
