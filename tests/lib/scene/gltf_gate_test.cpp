// tests/lib/scene/gltf_gate_test.cpp -- hostile and broken files end in one clear line.
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>

#include "tests/lib/scene/gltf_maker.h"

namespace tempolux {
namespace {

long peak_megabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

GltfMaker one_triangle() {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  return maker;
}

GltfMaker with_buffer(const Json& buffer) {
  GltfMaker maker = one_triangle();
  maker.json["buffers"] = {buffer};
  return maker;
}

std::string error_of(const GltfMaker& maker, const std::string& name = "bad.gltf") {
  return load_error(write_file(name, maker.text()));
}

TEST(GltfGate, EveryBadFileIsOneLineQuicklyAndWithoutMuchMemory) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(shared_scenes() / "bad")) {
    const std::string extension = entry.path().extension();
    if (extension != ".gltf" && extension != ".glb") continue;
    const auto start = std::chrono::steady_clock::now();
    std::string message;
    try {
      // meshoptimizer-fuzz.glb is a sound file with neither camera nor light: that is what a tool says of it.
      const Scene scene = load_gltf(entry.path().string());
      require_lights(scene);
      ADD_FAILURE() << entry.path() << " was accepted";
    } catch (const InputError& error) { message = error.what(); }
    EXPECT_TRUE(message.starts_with(entry.path().string() + ": ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 500u);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << entry.path();
    ++count;
  }
  EXPECT_EQ(count, 17);
  EXPECT_LT(peak_megabytes(), 300);
}

TEST(GltfGate, DeeplyNestedJsonIsRefused) {
  const std::string depth(200'000, '[');
  const std::string text = R"({"asset":{"version":"2.0"},"extras":)" + depth + std::string(200'000, ']') + "}";
  EXPECT_CONTAINS(load_error(write_file("deep.gltf", text)), "nested deeper than 64 levels");
}

TEST(GltfGate, NestingUpToTheLimitIsRead) {
  GltfMaker maker = one_triangle();
  Json nested = 1;
  for (int i = 0; i < 60; ++i) nested = Json::array({nested});
  maker.json["extras"] = nested;
  EXPECT_EQ(maker.load().meshes.size(), 1u);
}

TEST(GltfGate, ImagesAreNeverDecoded) {
  // 30000 x 30000 RGBA would be 3.6 GB; the header of such a PNG is enough to make a decoder allocate it.
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x75\x30\0\0\x75\x30\x08\x06\0\0\0", 29);
  GltfMaker maker = one_triangle();
  maker.json["images"] = {{{"uri", "data:image/png;base64," + base64(png)}},
                          {{"bufferView", 0}, {"mimeType", "image/png"}}};
  maker.json["textures"] = {{{"source", 0}}};
  const long before = peak_megabytes();
  EXPECT_EQ(maker.load().meshes.size(), 1u);
  EXPECT_LT(peak_megabytes() - before, 50);
}

TEST(GltfGate, UrisMustStayInTheScenesFolder) {
  write_file("outside.bin", std::string(36, '\0'));
  for (const char* uri :
       {"../outside.bin", "a/../../outside.bin", "%2e%2e/outside.bin", "../../../../../etc/hostname"}) {
    const std::string path = write_file("inside/scene.gltf", with_buffer({{"byteLength", 36}, {"uri", uri}}).text());
    EXPECT_CONTAINS(load_error(path), "leads out of the scene's folder");
  }
  const std::string absolute = (temporary_folder() / "outside.bin").string();
  const std::string path = write_file("inside/scene.gltf", with_buffer({{"byteLength", 36}, {"uri", absolute}}).text());
  EXPECT_CONTAINS(load_error(path), "is an absolute path");
}

TEST(GltfGate, SymbolicLinksMustStayInTheScenesFolder) {
  write_file("outside.bin", std::string(36, '\0'));
  const std::string path =
      write_file("links/scene.gltf", with_buffer({{"byteLength", 36}, {"uri", "link.bin"}}).text());
  fs::create_symlink("../outside.bin", temporary_folder() / "links/link.bin");
  EXPECT_CONTAINS(load_error(path), "leads out of the scene's folder");
}

TEST(GltfGate, FilesBesideTheSceneAreReadAndListed) {
  write_file("data of it.bin", one_triangle().bytes + "more than byteLength");
  const std::string path =
      write_file("beside.gltf", with_buffer({{"byteLength", 36}, {"uri", "data%20of%20it.bin"}}).text());
  const Scene scene = load_gltf(path);
  ASSERT_EQ(scene.files.size(), 2u);
  EXPECT_EQ(fs::path(scene.files[1]).filename(), "data of it.bin");
  EXPECT_EQ(scene.meshes[0].primitives[0].positions[1], (Vec3{1, 0, 0}));
}

TEST(GltfGate, OtherUrisAreRefused) {
  struct Case {
    const char *uri, *part;
  };
  for (const Case& c : {Case{"http://example.org/a.bin", "is not a relative path"},
                        Case{"file:///etc/hostname", "is not a relative path"}, Case{"", "is empty"},
                        Case{"a%zz.bin", "hexadecimal"}, Case{"a%", "hexadecimal"}, Case{"a%00.bin", "zero byte"},
                        Case{"none.bin", "buffers[0].uri: "}, Case{"none.bin", "cannot be opened"},
                        Case{".", "not a regular file"}, Case{"data:text/html,hello", "must be base64"},
                        Case{"data:a/b;base64,!!!!", "not base64"}, Case{"data:a/b;base64,AAAA", "decodes to 3 bytes"}})
    EXPECT_CONTAINS(error_of(with_buffer({{"byteLength", 36}, {"uri", c.uri}})), c.part);
}

TEST(GltfGate, ImageUrisAreCheckedToo) {
  GltfMaker maker = one_triangle();
  maker.json["images"] = {{{"uri", "%!QAAAQAAA5"}}};
  EXPECT_CONTAINS(error_of(maker), "images[0].uri");
  maker.json["images"] = {{{"uri", "../../secret.png"}}};
  EXPECT_CONTAINS(error_of(maker), "images[0].uri");
}

TEST(GltfGate, APipeAsBufferOrSceneDoesNotHang) {
  const std::string pipe = (temporary_folder() / "pipe.bin").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_CONTAINS(error_of(with_buffer({{"byteLength", 36}, {"uri", "pipe.bin"}})), "not a regular file");
  EXPECT_CONTAINS(load_error(pipe), "not a regular file");
  EXPECT_CONTAINS(load_error(temporary_folder().string()), "not a regular file");
}

TEST(GltfGate, BuffersThatNameOneFileManyTimesAreRefused) {
  write_file("big.bin", std::string(4 << 20, '\0'));
  GltfMaker maker = one_triangle();
  maker.json["buffers"] = Json::array();
  for (int i = 0; i < 3; ++i) maker.json["buffers"].push_back({{"byteLength", 4 << 20}, {"uri", "big.bin"}});
  EXPECT_CONTAINS(error_of(maker), "more than can be right");
}

TEST(GltfGate, FileSizeLimitHolds) {
  const std::string path = write_file("large.gltf", one_triangle().text());
  EXPECT_CONTAINS(load_error(path, {.max_file_bytes = 100}), "the limit is 100");
}

TEST(GltfGate, RequiredExtensionsAreNamedWithTheRemedy) {
  struct Case {
    const char *name, *remedy;
  };
  for (const Case& c : {Case{"KHR_texture_basisu", "ktxdecompress"}, Case{"KHR_never_heard_of", "export without it"}}) {
    GltfMaker maker = one_triangle();
    maker.json["extensionsRequired"] = {c.name};
    const std::string message = error_of(maker);
    EXPECT_CONTAINS(message, std::string(c.name) + " is not supported");
    EXPECT_CONTAINS(message, c.remedy);
  }
}

/// Loads with one warning, which names the extension and says what is read.
void expect_plain_copy_read(const GltfMaker& maker, const std::string& extension) {
  const Scene scene = maker.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings[0], extension + " is not unpacked: the plain copy beside it is read");
}

TEST(GltfGate, TexturesOfOtherFormatsAreRefusedOnlyWithoutAnotherSource) {
  const std::string name = "KHR_texture_basisu";
  GltfMaker maker = one_triangle();
  maker.json["extensionsUsed"] = {name};
  maker.json["images"] = {{{"uri", "a.png"}}, {{"uri", "a.other"}}};
  maker.json["textures"] = {{{"source", 0}, {"extensions", {{name, {{"source", 1}}}}}}};
  expect_plain_copy_read(maker, name);
  maker.json["textures"][0].erase("source");
  EXPECT_CONTAINS(error_of(maker), "textures[0]: " + name + " is not supported; convert");
  for (const char* other : {"EXT_texture_webp", "EXT_texture_avif"}) {
    maker.json["textures"][0]["extensions"] = {{name, {{"source", 1}}}, {other, {{"source", 0}}}};
    expect_plain_copy_read(maker, name);
  }
}

TEST(GltfGate, ExtrasOfNodesAreKept) {
  GltfMaker maker = one_triangle();
  maker.json["extras"] = {{"of the file", 1}};
  maker.add_node({{"name", "Smoke"}, {"extras", {{"grid", "density"}, {"albedo", {0.5, 0.25, 1}}}}});
  const Scene scene = maker.load();
  ASSERT_EQ(scene.nodes.size(), 2u);
  EXPECT_EQ(scene.nodes[0].extras, "");
  EXPECT_EQ(scene.nodes[1].extras, R"({"albedo":[0.5,0.25,1],"grid":"density"})");
}

TEST(GltfGate, UsedExtensionsThatNothingReadsGiveOneWarning) {
  GltfMaker maker = one_triangle();
  maker.json["extensionsUsed"] = {"KHR_materials_volume_scatter", "VENDOR_thing"};
  maker.json["nodes"][0]["extensions"]["UNDECLARED_one"] = {{"a", 1}};
  const Scene scene = maker.load();
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings[0], "KHR_materials_volume_scatter, UNDECLARED_one, VENDOR_thing");
}

TEST(GltfGate, OtherVersionsAreRefused) {
  for (const char* version : {"", "1.0", "3.0", "two"}) {
    GltfMaker maker = one_triangle();
    maker.json["asset"]["version"] = version;
    EXPECT_CONTAINS(error_of(maker), "asset.version");
  }
  GltfMaker maker = one_triangle();
  maker.json["asset"]["minVersion"] = "2.1";
  EXPECT_CONTAINS(error_of(maker), "asset.minVersion");
}

TEST(GltfGate, WrongTypesAreNamedWhereTheyAre) {
  GltfMaker maker = one_triangle();
  maker.json["accessors"][0]["count"] = -3;
  EXPECT_CONTAINS(error_of(maker), "accessors[0].count: must be a whole number");
  maker = one_triangle();
  maker.json["bufferViews"][0].erase("byteLength");
  EXPECT_CONTAINS(error_of(maker), "bufferViews[0].byteLength: is missing");
}

TEST(GltfGate, WholeNumbersMayBeWrittenWithAFraction) {
  GltfMaker maker = one_triangle();
  maker.json["accessors"][0]["count"] = 3.0;
  EXPECT_EQ(maker.load().meshes[0].primitives[0].positions.size(), 3u);
}

TEST(GltfGate, SyntaxErrorsSayTheLine) {
  EXPECT_CONTAINS(load_error(write_file("syntax.gltf", "{\n\"asset\": {\n]")), ": line 3: ");
  EXPECT_CONTAINS(load_error(write_file("empty.gltf", "")), "empty.gltf: ");
  EXPECT_CONTAINS(load_error(write_file("array.gltf", "[1]")), "is not an object");
}

TEST(GltfGate, EveryTruncationOfABinaryFileIsAnError) {
  const std::string whole = one_triangle().glb();
  EXPECT_EQ(load_gltf(write_file("whole.glb", whole)).meshes.size(), 1u);
  for (std::size_t length = 0; length < whole.size(); ++length)
    load_error(write_file("cut.glb", whole.substr(0, length)));
}

TEST(GltfGate, NoChangedByteCrashesOrHangs) {
  GltfMaker maker = one_triangle();
  maker.animate(0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  maker.add_light({{"type", "point"}});
  const std::string whole = maker.glb();
  int loaded = 0;
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const char change : {char(1), char(0x10), char(0x80), char(0xff)}) {
      std::string changed = whole;
      changed[at] = char(changed[at] ^ change);
      try {
        load_gltf(write_file("changed.glb", changed));
        ++loaded;  // names, padding and coordinates may have any value
      } catch (const InputError&) {}
    }
  EXPECT_GT(loaded, 0);
}

TEST(GltfGate, AccessorsOutsideTheirBytesAreRefusedIn64Bits) {
  struct Case {
    std::uint64_t count, offset;
  };
  for (const Case& c :
       {Case{4, 0}, Case{3, 4}, Case{4'000'000'000, 0}, Case{1ull << 59, 0}, Case{1, (1ull << 59) - 8}}) {
    GltfMaker maker = one_triangle();
    maker.json["accessors"][0]["count"] = c.count;
    maker.json["accessors"][0]["byteOffset"] = c.offset;
    EXPECT_CONTAINS(error_of(maker), "accessors[0]: ");
  }
}

TEST(GltfGate, AnAccessorWhoseEndWrapsAround64BitsIsRefused) {
  // 252 (count - 1) = 2^64 + 236: taken modulo 2^64, the 12 bytes from 236 on lie inside 360.
  GltfMaker maker;
  const int positions = maker.add_vec3(std::vector<float>(90));
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
  maker.json["bufferViews"][0]["byteStride"] = 252;
  maker.json["accessors"][0]["count"] = 73'201'365'371'863'302ull;
  EXPECT_EQ(252ull * (73'201'365'371'863'302ull - 1), 236ull);
  EXPECT_CONTAINS(error_of(maker), "do not fit bufferView 0");
}

TEST(GltfGate, SmallFilesThatAskForMuchMemoryAreRefused) {
  GltfMaker maker = one_triangle();
  maker.json["accessors"][0].erase("bufferView");
  maker.json["accessors"][0]["count"] = 100'000'000;
  maker.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 0}, {"componentType", 5125}}}, {"values", {{"bufferView", 0}}}};
  EXPECT_CONTAINS(error_of(maker), "far more memory");
}

}  // namespace
}  // namespace tempolux
