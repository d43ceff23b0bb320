#include "formats/paths/paths.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "formats/container.h"
#include "formats/hash.h"

namespace tempolux::formats {
namespace {

constexpr Format kFormat{{"\x89TPATH\r\n", 8}, ".paths", "photon-trace"};
constexpr std::string_view kBlockMark = "PATH";
constexpr std::size_t kEndBodySize = 16;
constexpr std::uint32_t kMaxGroupCount = 1u << 24;

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ' ') words.emplace_back();
    else words.back() += c;
  }
  return words;
}

bool is_kinds(const std::string& list) {
  for (unsigned kinds = 1; kinds < 16; ++kinds) {
    std::string names;
    for (unsigned k = 0; k < 4; ++k)
      if ((kinds >> k) & 1)
        names.append(names.empty() ? "" : ",").append(std::array{"direct", "caustic", "indirect", "volume"}[k]);
    if (names == list) return true;
  }
  return false;
}

/// Checks the values for both reader and writer: returns the fault, or "" if there is none.
std::string_view fault_of(const PathsHeader& h) {
  if (h.group_count < 1 || h.group_count > kMaxGroupCount) return "groups is not in 1 .. 16777216";
  if (!is_kinds(h.kinds)) return "kinds is not a list of direct, caustic, indirect, volume in this order";
  if (h.movers.empty() || h.movers.size() > kMostIntervals) return "movers are not 1 to 64 hashes";
  for (const std::string& hash : h.movers)
    if (hash.empty() || hash.size() > 128 || !std::ranges::all_of(hash, [](char c) { return c > 0x20 && c < 0x7f; }))
      return "movers are not hashes of 1 to 128 visible ASCII characters";
  if (!h.identity.known()) return "frames are missing";
  if (std::int64_t(h.movers.size()) > std::int64_t(h.identity.last_frame) - h.identity.first_frame + 1)
    return "more movers than frames";
  return fault_of_common(h.origin, h.identity);
}

std::string header_text(const PathsHeader& h) {
  HeaderText text("paths");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.line("kinds", h.kinds);
  text.origin(h.origin);
  text.line("groups", text_of(h.group_count));
  text.line("emitted", text_of(h.emitted_count));
  text.line("seed", text_of(h.seed));
  std::string movers;
  for (const std::string& hash : h.movers) movers += (movers.empty() ? "" : " ") + hash;
  text.line("movers", movers);
  if (!h.identity.emission.empty()) text.line("emission", h.identity.emission);
  text.identity(h.identity);
  text.history(h.history);
  return text.finish();
}

Line take_line(std::string_view key, std::string_view value, PathsHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "kinds") return h.kinds = value, Line::good;
  if (key == "groups") return result(parse_numbers(value, &h.group_count, 1));
  if (key == "emitted") return result(parse_numbers(value, &h.emitted_count, 1));
  if (key == "seed") return result(parse_numbers(value, &h.seed, 1));
  if (key == "movers") return h.movers = words_of(value), Line::good;
  if (key == "emission") return h.identity.emission = value, result(!value.empty());
  return take_common_line(key, value, common_keys(h));
}

std::optional<HeaderError> parse_header_text(std::string_view text, bool allow_unknown, PathsHeader& h) {
  h = PathsHeader();
  constexpr std::array<std::string_view, 7> required{"kinds", "origin", "groups", "emitted",
                                                     "seed",  "movers", "frames"};
  const auto take = [&](std::string_view key, std::string_view value) { return take_line(key, value, h); };
  if (auto error = parse_lines(text, allow_unknown, required, take)) return error;
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

/// Checks path after path by the rules of paths.md, section 3, and computes the sums of the end block.
class Checked {
 public:
  explicit Checked(const PathsHeader& header)
      : groups_(header.group_count), emitted_(header.emitted_count), intervals_(header.movers.size()) {}

  /// Adds a path: returns the fault, or "" if the path may follow the earlier ones.
  std::string_view add(const TouchedPath& path) {
    if (path.path >= emitted_) return "path is not below emitted";
    if (path.intervals == 0 || (intervals_ < 64 && path.intervals >> intervals_))
      return "intervals are none of the file's";
    const std::array<std::uint64_t, 2> place{path.path % groups_, path.path / groups_};
    if (count_ > 0 && place <= last_) return "paths are not in the order of their groups";
    last_ = place;
    ++count_;
    bits_ += std::uint64_t(std::popcount(path.intervals));
    return "";
  }
  std::uint64_t count() const { return count_; }
  std::uint64_t bits() const { return bits_; }

 private:
  std::uint64_t groups_, emitted_, intervals_, count_ = 0, bits_ = 0;
  std::array<std::uint64_t, 2> last_{};
};

}  // namespace

std::size_t interval_of(int frame, int first, int last, std::size_t interval_count) {
  return std::size_t((std::int64_t(frame) - first) * std::int64_t(interval_count) / (std::int64_t(last) - first + 1));
}

struct PathsWriter::State {
  ContainerWriter out;
  Checked checked;

  State(ContainerWriter::Sink sink, const PathsHeader& header)
      : out(std::move(sink), kFormat, header_text(header)), checked(header) {}
};

PathsWriter::PathsWriter(std::function<void(const void*, std::size_t)> sink, const PathsHeader& header)
    : state_(std::make_unique<State>(std::move(sink), header)) {}
PathsWriter::~PathsWriter() = default;

void PathsWriter::write(std::span<const TouchedPath> paths) {
  State& s = *state_;
  if (s.out.finished()) throw std::invalid_argument("PathsWriter: paths after the end");
  for (const TouchedPath& path : paths)
    if (const std::string_view fault = s.checked.add(path); !fault.empty())
      throw std::invalid_argument("PathsWriter: path " + std::to_string(path.path) + ": " + std::string(fault));
  for (std::size_t first = 0; first < paths.size(); first += kMaxBlockCount) {
    const auto some = paths.subspan(first, std::min<std::size_t>(paths.size() - first, kMaxBlockCount));
    std::string body;
    put_array(body, some);
    s.out.write_block(kBlockMark, {std::uint32_t(some.size())}, body);
  }
}

void PathsWriter::finish() {
  State& s = *state_;
  if (s.out.finished()) throw std::invalid_argument("PathsWriter: finished twice");
  std::string body;
  put(body, s.checked.count());
  put(body, s.checked.bits());
  s.out.finish(body);
}

PathsFile load_paths(const std::string& path) {
  ContainerReader in(path, kFormat);
  PathsFile file;
  in.expect_good(parse_header_text(in.text(), in.later_minor(), file.header));
  file.paths.reserve(in.bytes().size() / sizeof(TouchedPath));
  Checked checked(file.header);
  std::vector<char> body;
  while (in.read_records(kBlockMark, sizeof(TouchedPath), body))
    for (std::size_t i = 0; i < body.size() / sizeof(TouchedPath); ++i) {
      file.paths.push_back(get<TouchedPath>(body.data() + i * sizeof(TouchedPath)));
      if (const std::string_view fault = checked.add(file.paths.back()); !fault.empty())
        in.bytes().fail(in.body_offset() + i * sizeof(TouchedPath), std::string(fault),
                        "correct the program that wrote it");
    }
  const std::string end = in.read_end(kEndBodySize);
  if (get<std::uint64_t>(end.data()) != checked.count() || get<std::uint64_t>(end.data() + 8) != checked.bits())
    in.bytes().fail(in.body_offset(), "end block does not count the file's paths and intervals");
  in.bytes().expect_end();
  return file;
}

std::string digest_of(const PathsFile& file) {
  Hasher paths;
  paths.add_bytes(file.paths.data(), file.paths.size() * sizeof(TouchedPath));
  return hash_hex("paths: 1\norigin: " + hex_of(file.header.origin) +
                  "\ngroups: " + std::to_string(file.header.group_count) +
                  "\npaths: " + std::to_string(file.paths.size()) + " #" + paths.hex() + "\n");
}

}  // namespace tempolux::formats
