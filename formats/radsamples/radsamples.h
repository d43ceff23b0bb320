// formats/radsamples/radsamples.h -- reads and writes .radsamples files, version 1.2.
//
// radsamples.md defines the format. If this code disagrees with that page, the page is right.
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

/// A record whose radiance samples are kept, and the values computed from the samples. The samples are stored in the
/// order of the records.
struct RadsamplesRecord {
  std::array<float, 3> position{};          ///< m; world space minus the header's origin
  std::array<float, 3> normal{0, 0, 1};     ///< shading normal on the lit side; length 1 within 1e-4
  std::uint64_t key = 0;                    ///< key of its rays' random numbers; the same as long as the record exists
  std::uint32_t surface = 0, triangle = 0;  ///< place of the record: numbers in the scene at the frame
  std::array<float, 2> barycentric{};       ///< coordinates of the triangle's corners 1 and 2
  std::uint16_t rings = 1, sectors = 3;     ///< number of cells: rings x sectors, one sample each
  std::uint32_t updates = 0;                ///< number of updates since the record was first gathered
  std::uint16_t object = 0xffff;
  SurfaceSet set = SurfaceSet::static_set;
  std::uint8_t fading = 0;         ///< 0; 1 to 3: the record fades out, its radius is multiplied by (4 - fading) / 4
  std::uint32_t narrows_from = 0;  ///< reserved
  float footprint = 0;             ///< m: size of a pixel at the record when the record was placed
  float expected_share = 1, lit_share = 1;  ///< reserved
  float radius = 1;                         ///< m, > 0: before neighbours reduce it
  float radius_unclamped = 1;               ///< m, >= 0, before limits; +inf: no gather ray hit a surface
  std::array<float, 3> irradiance{};        ///< W/m^2, >= 0
  std::array<std::array<float, 3>, 3> rotational{}, translational{};  ///< as in .irradcache
  float clearance_reach = 1;                                          ///< m, > 0 or +inf
  std::array<std::uint8_t, 16> clearance{};
  float further_share = 0;     ///< reserved
  float birth_weight = 0;      ///< sum of the weights that earlier records had at its place when it was placed
  std::uint32_t reserved = 0;  ///< written as 0, read as 0

  std::size_t samples() const { return std::size_t(rings) * sectors; }
  bool operator==(const RadsamplesRecord&) const = default;
};
static_assert(sizeof(RadsamplesRecord) == 200);

/// The values of the header.
struct RadsamplesHeader {
  std::string history;
  Identity identity;
  std::array<double, 3> origin{};             ///< m, world space
  double diagonal = 1;                        ///< m, > 0: diagonal of the segment's bounds, the unit of distances
  std::array<std::int32_t, 2> segment{0, 0};  ///< first and last frame of the segment
  bool anchors = false;     ///< true if samples have the column `anchor`; the file then also has the light of points
  std::string points_hash;  ///< hash of the places of points that may be anchors; "" without anchors
  /// Hash of the points' light that is sampled explicitly (photonmap-split). Samples hold the light that rays
  /// contribute besides it. "": samples hold all light.
  std::string high_hash;
  /// Only in an overlay: name and digest of its base, from which records take samples.
  std::string base_name, base_digest;
};

/// The content of a file.
struct RadsamplesFile {
  RadsamplesHeader header;
  /// W/m^2, all kinds together, at this frame: by point that anchors name
  std::vector<std::array<float, 3>> point_light;
  std::vector<RadsamplesRecord> records;
  std::vector<RadianceSample> samples;  ///< record after record; for an overlay including samples from the base
  std::vector<std::uint32_t> anchors;   ///< by sample; empty without the column
  /// Only in an overlay, by record: 0 if the overlay holds the record's samples; else 1 + the number of the base's
  /// record with the samples. Empty if there is no base.
  std::vector<std::uint32_t> kept_from;
};

/// Writes a file front to back, without seeking. Samples that the base holds are left out. Throws
/// std::invalid_argument for a value out of the format's range; the file then stays without its end block.
class RadsamplesWriter {
 public:
  /// `head`: the content without samples and anchors; it must outlive the writer.
  RadsamplesWriter(std::function<void(const void*, std::size_t)> sink, const RadsamplesFile& head);
  ~RadsamplesWriter();
  /// Writes the samples of the next record, and its anchors if the file has the column. Call it for every record,
  /// also for records whose samples the base holds.
  void write(std::span<const RadianceSample> samples, std::span<const std::uint32_t> anchors);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};
/// Writes a file whose samples are in memory.
void write_radsamples(const std::function<void(const void*, std::size_t)>& sink, const RadsamplesFile& file);

/// Receives a record's samples and its anchors (none without the column). `head`: the part of the file that was read
/// so far, without samples.
using TakeSamples = std::function<void(const RadsamplesFile& head, std::size_t record, std::span<const RadianceSample>,
                                       std::span<const std::uint32_t>)>;
/// Reads and checks a file; "-" is standard input. Passes each record's samples to `take` once instead of keeping
/// them: in order of the records, but in an overlay its own samples first, then the base's. Throws InputError "FILE:
/// byte OFFSET: REASON; REMEDY" for every truncation, flipped bit and value out of range, and for a base that is
/// missing, has another digest or is itself an overlay. The caller must then discard the samples that it received.
/// Memory: 200 bytes per record, and one block.
RadsamplesFile read_radsamples(const std::string& path, const TakeSamples& take);
/// Reads a file with all samples. Memory: 12 bytes per sample; twice as much for an overlay.
RadsamplesFile load_radsamples(const std::string& path);

/// Hash of the data without header and history (radsamples.md, section 9). An overlay has the digest of the same
/// content written whole. Receives the samples in the order of the records, in pieces of any size.
class RadsamplesDigest {
 public:
  RadsamplesDigest();
  ~RadsamplesDigest();
  /// Adds the samples of further records, in the order of the file, and their anchors.
  void add(std::span<const RadianceSample> samples, std::span<const std::uint32_t> anchors);
  /// The digest after all samples were added; the samples in `head` are not read.
  std::string of(const RadsamplesFile& head) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
std::string digest_of(const RadsamplesFile& file);

}  // namespace tempolux::formats
