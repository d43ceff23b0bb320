#include <algorithm>
#include <cstring>
#include <utility>

#include "formats/base_file.h"
#include "formats/float_bits.h"
#include "formats/hash.h"
#include "formats/radsamples/layout.h"

namespace tempolux::formats {

using namespace radsamples;

namespace {

/// Reads consecutive blocks that have the same mark.
class Blocks {
 public:
  explicit Blocks(ContainerReader& in) : in_(in), mark_(in.read_mark()) {}

  /// Reads the next block if it has this mark: its body of count * size bytes, and the body's offset.
  bool next(std::string_view mark, std::size_t size) {
    if (mark_ != mark) return false;
    std::uint32_t entries = 0;
    in_.read_head(mark_, {&entries, 1}, "the head of a block");
    if (entries > kMaxBlockCount)
      in_.bytes().fail(in_.body_offset() - 8, "block of " + std::to_string(entries) + " entries; 65536 at most");
    in_.bytes().expect(std::uint64_t(entries) * size, "a block");
    count = entries;
    body.resize(count * size);
    in_.read_body(body.data(), body.size(), "a block");
    in_.end_block("a block");
    mark_ = in_.read_mark();
    return true;
  }
  [[noreturn]] void fail(std::size_t offset, std::string_view fault) const {
    in_.bytes().fail(in_.body_offset() + offset, std::string(fault), "correct the program that wrote it");
  }
  void expect_end() const {
    if (mark_ != kEndMark)
      in_.bytes().fail(in_.bytes().offset() - kMarkSize, "unknown mark of a block, or blocks in another order");
  }
  std::vector<char> body;
  std::size_t count = 0;

 private:
  ContainerReader& in_;
  std::string mark_;
};

/// Passes the samples that the file itself holds to `take`, record by record.
void read_samples(Blocks& blocks, const RadsamplesFile& file, const TakeSamples& take) {
  const std::uint64_t wanted = own_samples(file);
  const std::size_t size = kSampleSize + (file.header.anchors ? kAnchorSize : 0);
  std::vector<RadianceSample> samples;  // samples of the next record that were read so far
  std::vector<std::uint32_t> anchors;
  std::size_t next = 0;
  std::uint64_t done = 0;
  const auto give = [&] {
    std::size_t first = 0;
    for (; next < file.records.size(); ++next) {
      if (!is_own(file, next)) continue;
      const std::size_t count = file.records[next].samples();
      if (samples.size() - first < count) break;
      take(file, next, std::span(samples).subspan(first, count),
           file.header.anchors ? std::span(anchors).subspan(first, count) : std::span<std::uint32_t>());
      first += count;
    }
    samples.erase(samples.begin(), samples.begin() + std::ptrdiff_t(first));
    if (file.header.anchors) anchors.erase(anchors.begin(), anchors.begin() + std::ptrdiff_t(first));
  };
  while (blocks.next(kSamplesMark, size)) {
    if (done % kMaxBlockCount != 0) blocks.fail(0, "a block of samples before this one is not full");
    if (done + blocks.count > wanted) blocks.fail(0, "more samples than the records have");
    const std::size_t first = samples.size();
    done += blocks.count;
    samples.resize(first + blocks.count);
    std::memcpy(static_cast<void*>(samples.data() + first), blocks.body.data(), blocks.count * kSampleSize);
    if (file.header.anchors) {
      anchors.resize(first + blocks.count);
      std::memcpy(anchors.data() + first, blocks.body.data() + blocks.count * kSampleSize, blocks.count * kAnchorSize);
    }
    for (std::size_t i = 0; i < blocks.count; ++i)
      if (const std::string_view fault = fault_of(
              samples[first + i], file.header.anchors ? anchors[first + i] : kNoAnchor, file.point_light.size());
          !fault.empty())
        blocks.fail(i * kSampleSize, fault);
    give();
  }
  if (done != wanted) blocks.fail(0, "fewer samples than the records have");
}

enum class Role { whole_or_overlay, base };
RadsamplesFile read(const std::string& path, Role role, const TakeSamples& take);

/// Passes the base's samples to `take` for the records that use them. `fail` receives a description of a fault.
template <class Fail>
void take_from_base(const RadsamplesFile& file, const std::string& path, const TakeSamples& take, const Fail& fail) {
  const RadsamplesHeader& a = file.header;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wanted;  // number of the record in the base and in the overlay
  for (std::uint32_t i = 0; i < file.records.size(); ++i)
    if (!is_own(file, i)) wanted.emplace_back(file.kept_from[i] - 1, i);
  std::sort(wanted.begin(), wanted.end());
  std::size_t next = 0;
  RadsamplesDigest digest;
  const auto check = [&](const RadsamplesFile& base) {
    const RadsamplesHeader& b = base.header;
    if (a.anchors != b.anchors || a.points_hash != b.points_hash || a.diagonal != b.diagonal ||
        a.segment != b.segment || a.high_hash.empty() != b.high_hash.empty() ||
        file.point_light.size() != base.point_light.size())
      fail("its base " + a.base_name + " has other columns, points, segment or diagonal, or another part of the light");
  };
  const RadsamplesFile base =
      read(path, Role::base,
           [&](const RadsamplesFile& head, std::size_t record, std::span<const RadianceSample> samples,
               std::span<const std::uint32_t> anchors) {
             check(head);
             digest.add(samples, anchors);
             for (; next < wanted.size() && wanted[next].first == record; ++next) {
               const RadsamplesRecord& own = file.records[wanted[next].second];
               if (head.records[record].rings != own.rings || head.records[record].sectors != own.sectors) break;
               take(file, wanted[next].second, samples, anchors);
             }
           });
  check(base);
  if (digest.of(base) != a.base_digest)
    fail("its base " + a.base_name + " has another digest than when the overlay was written");
  if (next < wanted.size())
    fail("record " + std::to_string(wanted[next].second) + " has samples of a record that its base " + a.base_name +
         " does not have");
}

RadsamplesFile read(const std::string& path, Role role, const TakeSamples& take) {
  ContainerReader in(path, kFormat);
  RadsamplesFile file;
  in.expect_good(parse_header_text(in.text(), in.minor(), in.later_minor(), file.header));
  const bool overlay = !file.header.base_name.empty();
  if (overlay && role == Role::base)
    in.bytes().fail(kHeaderFixedSize, "it is the base of an overlay and an overlay itself", "make both again");
  Blocks blocks(in);
  while (blocks.next(kPointsMark, kPointSize))
    for (std::size_t i = 0; i < blocks.count; ++i) {
      file.point_light.push_back(get<std::array<float, 3>>(blocks.body.data() + i * kPointSize));
      if (!is_finite(file.point_light.back()) || is_negative(file.point_light.back()))
        blocks.fail(i * kPointSize, "light of a point is not finite or is negative");
    }
  if (!file.header.anchors && !file.point_light.empty()) blocks.fail(0, "light of points without the column anchor");
  while (blocks.next(kRecordsMark, sizeof(RadsamplesRecord)))
    for (std::size_t i = 0; i < blocks.count; ++i) {
      file.records.push_back(get<RadsamplesRecord>(blocks.body.data() + i * sizeof(RadsamplesRecord)));
      const std::uint32_t kept_from = std::exchange(file.records.back().reserved, 0);
      if (overlay) file.kept_from.push_back(kept_from);
      if (const std::string_view fault = fault_of(file.records.back()); !fault.empty())
        blocks.fail(i * sizeof(RadsamplesRecord), fault);
    }
  read_samples(blocks, file, take);
  blocks.expect_end();
  const std::string end = in.read_end(kEndBodySize);
  const Totals totals = totals_of(file);
  if (get<std::uint64_t>(end.data()) != totals.points || get<std::uint64_t>(end.data() + 8) != totals.records ||
      get<std::uint64_t>(end.data() + 16) != totals.samples)
    in.bytes().fail(in.body_offset(), "end block does not count the file's points, records and samples");
  if (get<std::array<double, 3>>(end.data() + 24) != totals.irradiance)
    in.bytes().fail(in.body_offset() + 24, "total is not the sum of the records' irradiance");
  in.bytes().expect_end();
  if (overlay)
    take_from_base(file, path_of_base(path, file.header.base_name), take,
                   [&](const std::string& fault) { in.bytes().fail(kHeaderFixedSize, fault, "make both again"); });
  return file;
}

}  // namespace

RadsamplesFile read_radsamples(const std::string& path, const TakeSamples& take) {
  return read(path, Role::whole_or_overlay, take);
}

RadsamplesFile load_radsamples(const std::string& path) {
  std::vector<RadianceSample> samples;
  std::vector<std::uint32_t> anchors;
  // In an overlay samples do not arrive in the order of the records.
  std::vector<std::pair<std::vector<RadianceSample>, std::vector<std::uint32_t>>> by_record;
  RadsamplesFile file =
      read_radsamples(path, [&](const RadsamplesFile& head, std::size_t record, std::span<const RadianceSample> some,
                                std::span<const std::uint32_t> their_anchors) {
        if (head.header.base_name.empty()) {
          samples.insert(samples.end(), some.begin(), some.end());
          anchors.insert(anchors.end(), their_anchors.begin(), their_anchors.end());
          return;
        }
        by_record.resize(head.records.size());
        by_record[record].first.assign(some.begin(), some.end());
        by_record[record].second.assign(their_anchors.begin(), their_anchors.end());
      });
  for (const auto& own : by_record) {
    samples.insert(samples.end(), own.first.begin(), own.first.end());
    anchors.insert(anchors.end(), own.second.begin(), own.second.end());
  }
  file.samples = std::move(samples);
  file.anchors = std::move(anchors);
  return file;
}

struct RadsamplesDigest::State {
  Hasher samples, anchors;
  std::uint64_t sample_count = 0, anchor_count = 0;
};

RadsamplesDigest::RadsamplesDigest() : state_(std::make_unique<State>()) {}
RadsamplesDigest::~RadsamplesDigest() = default;

void RadsamplesDigest::add(std::span<const RadianceSample> samples, std::span<const std::uint32_t> anchors) {
  state_->samples.add_bytes(samples.data(), samples.size_bytes());
  state_->anchors.add_bytes(anchors.data(), anchors.size_bytes());
  state_->sample_count += samples.size();
  state_->anchor_count += anchors.size();
}

std::string RadsamplesDigest::of(const RadsamplesFile& head) const {
  const auto line = [](std::uint64_t count, const Hasher& hasher) {
    return std::to_string(count) + " #" + hasher.hex() + "\n";
  };
  const auto hash = [&](const auto& values) {
    Hasher hasher;
    hasher.add_bytes(values.data(), values.size() * sizeof(values[0]));
    return line(values.size(), hasher);
  };
  const std::array<double, 1> diagonal{head.header.diagonal};
  return hash_hex("radsamples: 1\norigin: " + hex_of(head.header.origin) + "\ndiagonal: " + hex_of(diagonal) +
                  "\npoints: " + hash(head.point_light) + "records: " + hash(head.records) +
                  "samples: " + line(state_->sample_count, state_->samples) +
                  "anchors: " + line(state_->anchor_count, state_->anchors));
}

std::string digest_of(const RadsamplesFile& file) {
  RadsamplesDigest digest;
  digest.add(file.samples, file.anchors);
  return digest.of(file);
}

}  // namespace tempolux::formats
