// tools/info/info_facts.h -- facts about a file as JSON, which tempolux-info prints as JSON or as text.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/identity.h"
#include "formats/record_statistics.h"
#include "lib/core/json_file.h"
#include "tools/common/output.h"

namespace tempolux {
struct Image;
}

namespace tempolux::tools {

using Facts = nlohmann::ordered_json;

/// True for a .meshirrad file, by its first bytes. Throws InputError for a file that is none of ours, no image, no
/// JSON.
bool is_meshirrad(const std::string& path);

/// The lines of a history.
Facts lines_of(const std::string& text);
/// The first facts of a file with a text header: name, type, history, identity (null if it is unknown).
Facts start_of(const std::string& path, const char* type, const std::string& history,
               const formats::Identity& identity);
/// Smallest, largest and mean; nullptr if there are no numbers.
Facts spread_facts(const formats::Spread& spread);
/// The names of a file's columns, joined by commas; "none" if it has none.
std::string column_names(std::initializer_list<std::pair<bool, const char*>> columns);

/// The facts of each file type. Each function reads the whole file, so it also checks the file. Throws InputError
/// naming the place.
Facts photon_facts(const std::string& path);
Facts paths_facts(const std::string& path);
Facts irradpoints_facts(const std::string& path);
Facts irradcache_facts(const std::string& path);
Facts radsamples_facts(const std::string& path);
Facts meshirrad_facts(const std::string& path);
Facts image_facts(const std::string& path, bool allow_nan);
Facts json_facts(const std::string& path);
Facts facts_of(const std::string& path, bool allow_nan);

/// Looks at the end of a file, which a file that was cut off lacks: a container's end block, the last lines of an EXR
/// image, IEND of a PNG. Other files are read to their end; one of no known type is whole if it is not empty. Throws
/// InputError if the end is missing.
void check_end(const std::string& path);
/// `totals`: bytes between the mark of the end block and its chain.
void check_container_end(const std::string& path, std::size_t totals);
void check_png_end(const std::string& path);
void check_json_end(const std::string& path);

/// The differences of two files of one type. "differing" has each fact that is not the same in both, by its place in
/// the facts (a JSON Pointer), with both values; "equal" is true if the digests are equal, so history and identity do
/// not count. Throws InputError if the types differ.
Facts difference_of(const std::string& a, const std::string& b);
/// For two images of one size: the channels that differ, with the number of pixels, and the largest difference.
Facts channel_differences_of(const std::string& a, const std::string& b);

/// Text for people: one fact per line, indented; long lists are cut, with the number of further items.
std::string facts_as_text(const Facts& facts);

/// Exports photons, irradiance points or records in file order: PLY (binary, with colours for viewers: the brightest is
/// white) or CSV.
void export_photons(const std::string& path, const std::string& format, Output& output);
void export_irradpoints(const std::string& path, const std::string& format, Output& output);
void export_irradcache(const std::string& path, const std::string& format, Output& output);
/// Throws InputError for a file of another type.
void export_points(const std::string& path, const std::string& format, Output& output);

/// The bias that several frames report of their light (docs/methods/account.md), combined.
struct FramesAccount {
  std::string line;                   ///< a sentence; empty if no frame was audited
  std::vector<std::string> warnings;  ///< layers with a bias of more than 2 % of the picture and three standard errors
};
/// Reads the attributes of EXR files. The audits of n frames are independent, so the error of their mean is
/// sqrt(sum of squared errors) / n.
FramesAccount account_of_frames(const std::vector<std::string>& files);

struct PictureOptions {
  std::string layer;                     ///< "": R, G, B
  std::optional<double> exposure_stops;  ///< nothing: auto
  int columns = 0, tile_width = 320;     ///< of a contact sheet; columns 0: about square
  std::vector<std::string> marked;       ///< of a contact sheet: files whose pictures get a border
  std::function<void(double)> progress;  ///< of a contact sheet, [0, 1]; may be empty
};
/// An orthographic image of the elements of a .meshirrad file, seen along -(1, 1, 1), 640 pixels on its longer side.
/// Elements with photons that face the eye are drawn as discs; closer discs hide others; the background is black.
/// layer "": irradiance, W/m^2; "window": number of frames in the element's window, divided by 33; "age": frames from
/// the element's own frame to the middle of its window, divided by 16. Throws InputError.
Image mesh_picture(const std::string& path, const std::string& layer);
/// An image, or a .meshirrad file by mesh_picture(), as PNG.
void write_picture(const std::string& path, const PictureOptions& options, Output& output);
/// Writes a contact sheet: images in a grid, all with one exposure.
void write_sheet(const std::vector<std::string>& paths, const PictureOptions& options, Output& output);

}  // namespace tempolux::tools
