// tools/common/arguments.h -- parses values on a command line: frames, names, counts, sizes, lists.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tempolux::tools {

/// Frames of a range: item{,item}; item = A, A-B, A-BxS (every S-th) or A-ByS (all but every S-th).
/// B below A counts down; numbers may be negative ("-5--2"). Duplicates are dropped, the order is kept.
/// Throws InputError if the text is malformed or empty, if a frame is outside +-10^8, or for more than 10^6 frames.
std::vector<int> parse_frames(const std::string& text);

/// A name with the frame number inserted: a run of n '#' becomes the number with at least n digits; "%d", "%4d" and
/// "%04d" are as in printf; "%%" is a per cent sign. All patterns in the name are replaced, also in folders; a name
/// without a pattern stays. Throws InputError for any other use of '%'.
std::string frame_name(const std::string& pattern, int frame);
/// "f.0012.exr" with "_a" becomes "f.0012_a.exr".
std::string name_with(const std::string& path, const std::string& ending);
/// True if frame_name() inserts a number into the name.
bool has_frame_pattern(const std::string& pattern);

/// "250000", "10k", "1.5M", "1G": decimal factors 10^3, 10^6, 10^9; must come out whole and below 2^63.
/// Throws InputError.
std::uint64_t parse_count(const std::string& text);
/// The shortest text that parse_count converts to `count`.
std::string format_count(std::uint64_t count);
/// "512", "64KiB", "1.5GiB"; K, M, G, T and KB, MB, GB, TB are 1024^n too. Throws InputError.
std::uint64_t parse_bytes(const std::string& text);

/// "640x360". Throws InputError; each from 1 to 65536.
void parse_size(const std::string& text, int& width, int& height);

/// True if the text can only be a colour. A file of such a name: ./1
bool is_color(const std::string& text);
/// "0.2,0.3,0.5" or "1" for all three: finite, from 0 to 1e30. Throws InputError.
std::array<float, 3> parse_color(const std::string& text);

}  // namespace tempolux::tools
