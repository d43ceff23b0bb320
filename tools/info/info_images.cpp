// tools/info/info_images.cpp -- tempolux-info on images: facts, difference, pictures.
#include <algorithm>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/core/json.h"
#include "lib/image/any_io.h"
#include "lib/image/cryptomatte.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "lib/image/preview.h"
#include "lib/image/statistics.h"
#include "lib/image/why_mask.h"
#include "tools/common/file_head.h"
#include "tools/info/each_file.h"
#include "tools/info/info_facts.h"

namespace tempolux::tools {
namespace {

/// Loads a picture of any format that lib/image reads. The arguments concern EXR files: allow_nan accepts NaN, and
/// only_rgb reads only R, G and B if the file has them.
Image load(const std::string& path, bool allow_nan, bool only_rgb = false) {
  if (!head_of(path).starts_with("\x76\x2f\x31\x01")) return load_image(path);
  return load_exr(path, {.allow_nan = allow_nan, .only_rgb = only_rgb});
}

/// Loads the channels that a picture of the image needs.
Image load_shown(const std::string& path, const PictureOptions& options) {
  return load(path, true, options.layer.empty());
}

constexpr std::string_view kHistory = "tempolux:history";

/// History and identity first, then all other attributes by their names in the file.
Facts attribute_facts(const Image& image) {
  Facts facts = {{"history", Facts::array()}, {"identity", nullptr}};
  for (const auto& [name, value] : image.text) {
    if (name == kHistory) facts["history"] = lines_of(value);
    else if (name.starts_with(kIdentityPrefix)) facts["identity"][name.substr(kIdentityPrefix.size())] = value;
    else facts[name] = value;
  }
  for (const auto& [name, value] : image.numbers) facts[name] = value;
  for (const auto& [name, value] : image.matrices) facts[name] = value;
  return facts;
}

/// Adds the file's name to errors of lib/image about layers.
template <class Make>
auto named(const std::string& path, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) { throw InputError(path + ": " + error.what()); }
}

/// Layers of mattes by name, with the number of their ranks and of the names in their manifest.
Facts matte_facts(const Image& image) {
  Facts facts = Facts::array();
  for (const MatteLayer& layer : matte_layers_in(image)) {
    const Facts manifest = Facts::parse(layer.manifest, nullptr, false);
    facts.push_back(
        {{"layer", layer.name}, {"ranks", layer.ranks}, {"names", manifest.is_object() ? manifest.size() : 0}});
  }
  return facts;
}

Facts channel_facts(const ChannelStatistics& channel) {
  Facts facts = {{"channel", channel.name}, {"type", channel.ids ? "uint" : "float"}, {"min", channel.min}};
  facts.update({{"max", channel.max}, {"mean", channel.mean}, {"zeros", channel.zeros}});
  if (channel.infinities > 0) facts["infinities"] = channel.infinities;
  if (channel.nans > 0) facts["nans"] = channel.nans;
  return facts;
}

/// For a mask: the number of pixels masked for each cause, and the share of the picture for which it is the first
/// cause.
Facts cause_facts(const Image& image, const std::string& path) {
  Facts facts = Facts::array();
  const double pixels = double(image.pixel_count());
  double traced = 0;
  for (const WhyCount& cause : count_whys(whys_in(image, path))) {
    traced += double(cause.first);
    facts.push_back({{"cause", cause.name}, {"pixels", cause.pixels}, {"share", double(cause.first) / pixels}});
  }
  facts.push_back({{"cause", "all"}, {"pixels", std::uint64_t(traced)}, {"share", traced / pixels}});
  return facts;
}

/// The picture of an image: a mask has one colour for each cause; any other image shows the layer of `preview`.
Picture picture_of(const std::string& path, const Image& image, const PreviewOptions& preview) {
  if (preview.layer.empty() && !image.find("R") && is_why_mask(image)) return why_picture(image, whys_in(image, path));
  return named(path, [&] { return make_picture(image, preview); });
}

/// Automatic exposure in stops; 0 for a mask, whose colours are fixed.
double stops_of(const std::string& path, const Image& image, const std::string& layer) {
  if (layer.empty() && !image.find("R") && is_why_mask(image)) return 0;
  return named(path, [&] { return auto_exposure_stops(image, layer); });
}

}  // namespace

Facts image_facts(const std::string& path, bool allow_nan) {
  const Image image = load(path, allow_nan);
  Facts facts = {{"file", path}, {"type", "image"}, {"width", image.width}, {"height", image.height}};
  facts.update(attribute_facts(image));
  facts["layers"] = Facts::array();
  const std::vector<std::string> layers = image.layers();
  for (const std::string& layer : layers) facts["layers"].push_back(layer.empty() ? "RGB" : layer);
  if (Facts mattes = matte_facts(image); !mattes.empty()) facts["mattes"] = std::move(mattes);
  facts["channels"] = Facts::array();
  for (const ChannelStatistics& channel : channel_statistics(image))
    facts["channels"].push_back(channel_facts(channel));
  if (is_why_mask(image)) facts["causes"] = cause_facts(image, path);
  if (std::ranges::find(layers, "") != layers.end()) facts["auto_exposure_stops"] = auto_exposure_stops(image, "");
  facts["digest"] = digest_of(image);
  return facts;
}

Facts channel_differences_of(const std::string& a, const std::string& b) {
  Facts facts = Facts::array();
  for (const ChannelDifference& channel : channel_differences(load(a, true), load(b, true)))
    if (channel.differing > 0)
      facts.push_back({{"channel", channel.name},
                       {"pixels", channel.differing},
                       {"largest", channel.largest},
                       {"at", {channel.x, channel.y}}});
  return facts;
}

void write_picture(const std::string& path, const PictureOptions& options, Output& output) {
  const bool mesh = is_meshirrad(path);
  const Image image = mesh ? mesh_picture(path, options.layer) : load_shown(path, options);
  PreviewOptions preview{options.layer, options.exposure_stops};
  if (mesh && !options.layer.empty() && !preview.exposure_stops) preview.exposure_stops = 0;  // 33 frames are white
  save_png(output.temporary_path(), picture_of(path, image, preview));
}

void write_sheet(const std::vector<std::string>& paths, const PictureOptions& options, Output& output) {
  for (const std::string& path : options.marked)
    if (std::find(paths.begin(), paths.end(), path) == paths.end())
      throw InputError("--mark " + path + ": is not among the images of the sheet");
  PreviewOptions preview{options.layer, options.exposure_stops};
  const double steps = double(paths.size()) * (preview.exposure_stops ? 1 : 2);
  double done = 0;
  const auto step = [&] {
    if (options.progress) options.progress(++done / steps);
  };
  if (!preview.exposure_stops) {  // frames are read twice, so that few are in memory
    std::vector<double> stops;
    const auto read = [&](const std::string& path) { return stops_of(path, load_shown(path, options), options.layer); };
    each_file(paths, read, [&](const std::string&, double of_frame) {
      stops.push_back(of_frame);
      step();
    });
    preview.exposure_stops = sequence_exposure_stops(stops);
  }
  std::vector<Picture> pictures;
  const auto tile = [&](const std::string& path) {
    return contact_sheet({picture_of(path, load_shown(path, options), preview)}, 1, options.tile_width);
  };
  each_file(paths, tile, [&](const std::string& path, Picture picture) {
    if (std::find(options.marked.begin(), options.marked.end(), path) != options.marked.end()) mark(picture);
    pictures.push_back(std::move(picture));
    step();
  });
  save_png(output.temporary_path(), contact_sheet(pictures, options.columns, options.tile_width));
}

}  // namespace tempolux::tools
