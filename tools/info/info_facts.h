// tools/info/info_facts.h -- what tempolux-info knows about a file, as JSON that it prints as it is or as text.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/identity.h"
#include "tools/common/output.h"

namespace tempolux {
struct Image;
}

namespace tempolux::tools {

using Facts = nlohmann::ordered_json;

enum class FileType { photons, paths, irradpoints, irradcache, radsamples, meshirrad, lightgrid, image, json };
/// By the first bytes, not by the name; "-" is a .photons stream. Throws InputError.
FileType file_type(const std::string& path);

/// The lines of a history.
Facts lines_of(const std::string& text);
/// nullptr if it is not known.
Facts identity_facts(const formats::Identity& identity);

/// Reads the whole file, so every one of these is also a check. Throws InputError naming the place.
Facts photon_facts(const std::string& path);
Facts paths_facts(const std::string& path);
Facts irradpoints_facts(const std::string& path);
Facts irradcache_facts(const std::string& path);
Facts radsamples_facts(const std::string& path);
Facts meshirrad_facts(const std::string& path);
Facts lightgrid_facts(const std::string& path);
Facts image_facts(const std::string& path, bool allow_nan);
Facts json_facts(const std::string& path);
Facts facts_of(const std::string& path, bool allow_nan);
/// Hash of the data without header and history.
std::string digest_of_file(const std::string& path);

/// How two files of one type differ. "equal" is true if their digests are: history and identity are compared
/// and reported, but do not count.
Facts photon_difference(const std::string& a, const std::string& b);
Facts paths_difference(const std::string& a, const std::string& b);
Facts irradpoints_difference(const std::string& a, const std::string& b);
Facts irradcache_difference(const std::string& a, const std::string& b);
Facts radsamples_difference(const std::string& a, const std::string& b);
Facts meshirrad_difference(const std::string& a, const std::string& b);
Facts lightgrid_difference(const std::string& a, const std::string& b);
Facts image_difference(const std::string& a, const std::string& b);
Facts json_difference(const std::string& a, const std::string& b);
/// Throws InputError if the types differ.
Facts difference_of(const std::string& a, const std::string& b);

/// For people: one fact a line, indented; of long lists the head and the number of the rest.
std::string facts_as_text(const Facts& facts);

/// Photons, irradiance points or records as points, one by one in file order: PLY (binary, with colours for
/// viewers: the brightest is white) or CSV.
void export_photons(const std::string& path, const std::string& format, Output& output);
/// A line of CSV for each group of a .photons file: when it was traced, with how many paths. InputError if the file
/// does not say.
void print_groups(const std::string& path, Output& output);
void export_irradpoints(const std::string& path, const std::string& format, Output& output);
void export_irradcache(const std::string& path, const std::string& format, Output& output);
/// Throws InputError for a file of another type.
void export_points(const std::string& path, const std::string& format, Output& output);

/// What frames say of the bias of their light (docs/methods/account.md), together.
struct FramesAccount {
  std::string line;                   ///< in words; empty if no frame says anything
  std::vector<std::string> warnings;  ///< layers that are off by more than 2 % of the picture and three standard errors
};
/// By the attributes of EXR files. The audits of frames are independent, so the error of their mean is sqrt(sum of
/// squares) / n.
FramesAccount account_of_frames(const std::vector<std::string>& files);

struct PictureOptions {
  std::string layer;                     ///< "": R, G, B
  std::optional<double> exposure_stops;  ///< nothing: auto
  int columns = 0, tile_width = 320;     ///< of a sheet; columns 0: about square
  std::vector<std::string> marked;       ///< of a sheet: files whose pictures get a border
  std::function<void(double)> progress;  ///< of a sheet, [0, 1]; may be empty
};
/// Elements of a .meshirrad file as an image, orthographic along -(1, 1, 1), 640 pixels on its longer side: those that
/// photons arrived at and whose side faces the eye, as discs; nearer ones hide others, black elsewhere. layer "":
/// irradiance, W/m^2; "window": frames of the element's window as a share of 33; "age": frames that the middle of the
/// window lies after its own frame, / 16. Throws InputError.
Image mesh_picture(const std::string& path, const std::string& layer);
/// An image, or a .meshirrad file by mesh_picture(), as PNG.
void write_picture(const std::string& path, const PictureOptions& options, Output& output);
/// Images in a grid, all with one exposure.
void write_sheet(const std::vector<std::string>& paths, const PictureOptions& options, Output& output);

}  // namespace tempolux::tools
