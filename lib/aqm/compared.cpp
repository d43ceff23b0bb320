// lib/aqm/compared.cpp -- selects planes and checks that they match.
#include "lib/aqm/compared.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "formats/error.h"
#include "lib/image/image.h"

namespace tempolux {
namespace {

std::string layer_name(const std::string& layer) { return layer.empty() ? "RGB" : layer; }

/// Lists the image's content: "layers RGB, direct, indirect; channels Z, id.object".
std::string what_is_there(const Image& image) {
  std::string layers, channels;
  std::set<std::string> in_layers;
  for (const std::string& layer : image.layers()) {
    layers += (layers.empty() ? "" : ", ") + layer_name(layer);
    for (const char* suffix : {"R", "G", "B"}) in_layers.insert(layer.empty() ? suffix : layer + "." + suffix);
  }
  for (const Channel& channel : image.channels)
    if (!in_layers.contains(channel.name)) channels += (channels.empty() ? "" : ", ") + channel.name;
  return "it has layers " + (layers.empty() ? "none" : layers) + "; other channels " +
         (channels.empty() ? "none" : channels);
}

void check_size(const NamedImage& image, const NamedImage& test) {
  const auto size = [](const Image& i) { return std::to_string(i.width) + "x" + std::to_string(i.height); };
  if (image.image->width == test.image->width && image.image->height == test.image->height) return;
  throw InputError(image.name + ": " + size(*image.image) + " pixels, but " + test.name + " has " + size(*test.image) +
                   "; compare frames of one size");
}

/// The planes of `image`, in the order of the planes `like`.
std::vector<const std::vector<float>*> planes_like(const NamedImage& image, const std::string& layer,
                                                   const std::vector<std::string>& like) {
  LayerPlanes found = layer_planes(image, layer);
  if (found.suffixes == like) return found.planes;
  std::string wanted;
  for (const std::string& suffix : like) wanted += (wanted.empty() ? "" : ", ") + suffix;
  throw InputError(image.name + ": layer " + layer_name(layer) + " has other channels than the test frame's (" +
                   wanted + "); " + what_is_there(*image.image));
}

void check_some_count(const std::vector<std::uint8_t>& counted, const NamedImage& image, const char* remedy) {
  if (std::ranges::find(counted, 1) == counted.end())
    throw InputError(image.name + ": leaves no pixel to compare; " + remedy);
}

void check_finite(const Compared& pair, const std::vector<const std::vector<float>*>& planes, const std::string& name,
                  const std::string& layer) {
  for (std::size_t c = 0; c < planes.size(); ++c)
    for (std::size_t i = 0; i < planes[c]->size(); ++i)
      if (!std::isfinite((*planes[c])[i]) && pair.counts(i))
        throw InputError(name + ": layer " + layer_name(layer) + " channel " +
                         (pair.channels[c].empty() ? layer : pair.channels[c]) + " at column " +
                         std::to_string(i % std::size_t(pair.width)) + ", row " +
                         std::to_string(i / std::size_t(pair.width)) +
                         ": not a finite number; leave such pixels out with --mask");
}

}  // namespace

LayerPlanes layer_planes(const NamedImage& image, const std::string& layer) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  LayerPlanes found;
  const auto take = [&](const Channel* channel, const std::string& suffix) {
    if (!channel || !channel->ids.empty()) return;
    found.suffixes.push_back(suffix);
    found.planes.push_back(&channel->values);
  };
  for (const char* suffix : {"R", "G", "B"}) take(image.image->find(prefix + suffix), suffix);
  if (found.planes.size() == 3) return found;

  found = {};
  take(image.image->find(layer.empty() ? "Y" : layer), "");
  if (!found.planes.empty()) return found;
  std::vector<const Channel*> members;
  for (const Channel& channel : image.image->channels)
    if (!layer.empty() && channel.name.starts_with(prefix)) members.push_back(&channel);
  std::ranges::sort(members, {}, &Channel::name);
  for (const Channel* member : members) take(member, member->name.substr(prefix.size()));
  if (!found.planes.empty()) return found;
  throw InputError(image.name + ": layer " + layer_name(layer) + " is not in this file; " +
                   what_is_there(*image.image));
}

Compared compare_layers(const ComparedInputs& inputs) {
  const auto& [test, reference, second, mask, layer, smooth, except] = inputs;
  for (const NamedImage* other : {&reference, &second, &mask, &smooth, &except})
    if (other->image) check_size(*other, test);

  Compared pair;
  pair.width = test.image->width;
  pair.height = test.image->height;
  LayerPlanes planes = layer_planes(test, layer);
  pair.channels = std::move(planes.suffixes);
  pair.test = std::move(planes.planes);
  pair.reference = planes_like(reference, layer, pair.channels);
  if (second.image) pair.second = planes_like(second, layer, pair.channels);
  if (smooth.image) pair.smooth = planes_like(smooth, layer, pair.channels);
  if (mask.image) {
    pair.counted = nonzero_pixels(*mask.image);
    check_some_count(pair.counted, mask, "make it other than 0 where pixels count");
  }
  if (except.image) {
    if (pair.counted.empty()) pair.counted.assign(except.image->pixel_count(), 1);
    const std::vector<std::uint8_t> left_out = nonzero_pixels(*except.image);
    for (std::size_t i = 0; i < left_out.size(); ++i)
      if (left_out[i]) pair.counted[i] = 0;
    check_some_count(pair.counted, except, "it is other than 0 everywhere that counts");
  }
  for (const NamedImage* from : {&test, &reference}) {
    const Channel* ids = from->image->find("id.object");
    if (!pair.objects && ids && !ids->ids.empty()) pair.objects = &ids->ids;
  }
  check_finite(pair, pair.test, test.name, layer);
  check_finite(pair, pair.reference, reference.name, layer);
  check_finite(pair, pair.second, second.name, layer);
  check_finite(pair, pair.smooth, smooth.name, layer);
  return pair;
}

}  // namespace tempolux
