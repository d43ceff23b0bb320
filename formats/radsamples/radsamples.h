// formats/radsamples/radsamples.h -- read and write .radsamples files, version 1.2.
//
// radsamples.md is the definition of the format. If this code and that text disagree, the text is right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/error.h"
#include "formats/identity.h"
#include "formats/radsamples/sample.h"
#include "formats/surface_set.h"

namespace tempolux::formats {

/// One record whose hemisphere is kept, and what was made of it. Its samples stand in the order of the records.
struct RadsamplesRecord {
  std::array<float, 3> position{};          ///< m; world space minus the header's origin
  std::array<float, 3> normal{0, 0, 1};     ///< shading normal on the lit side; length 1 within 1e-4
  std::uint64_t key = 0;                    ///< of its rays; kept while the record lives
  std::uint32_t surface = 0, triangle = 0;  ///< where it lies: numbers in the scene at the frame
  std::array<float, 2> barycentric{};       ///< of the triangle's corners 1 and 2
  std::uint16_t rings = 1, sectors = 3;     ///< cells: rings x sectors samples
  std::uint32_t updates = 0;                ///< since it was gathered first
  std::uint16_t object = 0xffff;
  SurfaceSet set = SurfaceSet::static_set;
  std::uint8_t fading = 0;                  ///< 0; 1 to 3: it is being taken out, its radius times (4 - fading) / 4
  std::uint32_t narrows_from = 0;           ///< reserved
  float footprint = 0;                      ///< m: size of a pixel there when it was placed
  float expected_share = 1, lit_share = 1;  ///< reserved
  float radius = 1;                         ///< m, > 0: before neighbours narrow it
  float radius_unclamped = 1;               ///< m, >= 0, before limits; +inf: nothing was near
  std::array<float, 3> irradiance{};        ///< W/m^2, >= 0
  std::array<std::array<float, 3>, 3> rotational{}, translational{};  ///< as in .irradcache
  float clearance_reach = 1;                                          ///< m, > 0 or +inf
  std::array<std::uint8_t, 16> clearance{};
  float further_share = 0;     ///< further rays per cell that its unevenness would call for
  float birth_weight = 0;      ///< sum of the weights of the records before it, at its place, when it was placed
  std::uint32_t reserved = 0;  ///< written as 0, read as 0

  std::size_t samples() const { return std::size_t(rings) * sectors; }
  bool operator==(const RadsamplesRecord&) const = default;
};
static_assert(sizeof(RadsamplesRecord) == 200);

/// What the header says.
struct RadsamplesHeader {
  std::string history;
  Identity identity;
  std::array<double, 3> origin{};             ///< m, world space
  double diagonal = 1;                        ///< m, > 0: unit of distances, of the segment
  std::array<std::int32_t, 2> segment{0, 0};  ///< first and last frame
  bool anchors = false;                       ///< samples have the column `anchor`, and the file the light of points
  std::string points_hash;                    ///< of the anchored points' places; "" without anchors
  /// Hash of what of the points' light is high (photonmap-split): samples hold what rays bring without it. "": all of
  /// the light.
  std::string high_hash;
  /// Of an overlay: the file that records take samples from, and its digest.
  std::string base_name, base_digest;
};

/// A whole file.
struct RadsamplesFile {
  RadsamplesHeader header;
  std::vector<std::array<float, 3>>
      point_light;  ///< W/m^2 of all kinds: of the points that anchors name, at this frame
  std::vector<RadsamplesRecord> records;
  std::vector<RadianceSample> samples;  ///< of the first record, of the second, ..., an overlay's too
  std::vector<std::uint32_t> anchors;   ///< by sample; empty without the column
  /// Of an overlay, by record: 0, or 1 + the number of the base's record whose samples it has; empty without a base.
  std::vector<std::uint32_t> kept_from;
};

/// Writes a file front to back; never seeks. Samples that are the base's are left out. A value out of the format's
/// range is std::invalid_argument: a file in which something is wrong is not finished.
class RadsamplesWriter {
 public:
  /// `head`: a file without its samples and anchors; it must outlive the writer.
  RadsamplesWriter(std::function<void(const void*, std::size_t)> sink, const RadsamplesFile& head);
  ~RadsamplesWriter();
  /// The samples of the next record, and their anchors if there is that column. For each record, those that are the
  /// base's, too.
  void write(std::span<const RadianceSample> samples, std::span<const std::uint32_t> anchors);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};
/// The same of a file that is in memory.
void write_radsamples(const std::function<void(const void*, std::size_t)>& sink, const RadsamplesFile& file);

/// Receives a record's samples and anchors (none without the column). `head`: the file as far as it is read, without
/// samples.
using TakeSamples = std::function<void(const RadsamplesFile& head, std::size_t record, std::span<const RadianceSample>,
                                       std::span<const std::uint32_t>)>;
/// Reads and checks a file; "-" is standard input. Hands over the samples of each record once instead of keeping them:
/// in order, but of an overlay its own first. Every truncation, flipped bit and value out of range is an InputError
/// "FILE: byte OFFSET: REASON; REMEDY"; so is a base that is missing, has another digest or is an overlay itself: what
/// was handed over until then is worth nothing. Memory: 200 bytes per record, and one block.
RadsamplesFile read_radsamples(const std::string& path, const TakeSamples& take);
/// The same with all samples: 12 bytes each; of an overlay twice that.
RadsamplesFile load_radsamples(const std::string& path);

/// Hash of the data without header and history (radsamples.md, section 9): an overlay has that of the same written
/// whole. Takes the samples in the order of the records, in pieces of any size.
class RadsamplesDigest {
 public:
  RadsamplesDigest();
  ~RadsamplesDigest();
  void add(std::span<const RadianceSample> samples, std::span<const std::uint32_t> anchors);
  /// `head`: the file, with or without its samples.
  std::string of(const RadsamplesFile& head) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
std::string digest_of(const RadsamplesFile& file);

}  // namespace tempolux::formats
