// lib/scene/gltf_animation.cpp -- animations as tracks: translation, rotation and scale of nodes.
#include <set>
#include <string>
#include <utility>

#include "lib/scene/gltf_check.h"

namespace tempolux::gltf {
namespace {

using Path = AnimationTrack::Path;
using Interpolation = AnimationTrack::Interpolation;

Interpolation interpolation_of(const Import& import, const std::string& name, const std::string& place) {
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  import.fail(place + ".interpolation", "\"" + name + "\" is not LINEAR, STEP or CUBICSPLINE");
}

/// True and the path if the channel is one we play; what we do not play is noted.
bool wanted(Import& import, const tinygltf::AnimationChannel& channel, const std::string& place, Path& path) {
  const std::string& name = channel.target_path;
  if (name == "weights") {
    import.ignore("morph target animation");
    return false;
  }
  if (name == "translation")
    path = Path::translation;
  else if (name == "rotation")
    path = Path::rotation;
  else if (name == "scale")
    path = Path::scale;
  else
    import.fail(place + ".target.path", "\"" + name + "\" is not translation, rotation, scale or weights");
  if (channel.target_node == -1) return false;
  if (channel.target_node < 0 || std::size_t(channel.target_node) >= import.model.nodes.size())
    import.fail(place + ".target.node", "node " + std::to_string(channel.target_node) + " does not exist");
  return import.node_from_source[std::size_t(channel.target_node)] !=
         -1;  // else in another scene of the file
}

void read_values(Import& import, const tinygltf::AnimationSampler& sampler, const std::string& place,
                 AnimationTrack& track) {
  const int components = track.path == Path::rotation ? 4 : 3;
  const bool spline = track.interpolation == Interpolation::cubic_spline;
  const std::vector<double> numbers = read_numbers(import, sampler.output, components, place + ".output");
  const std::size_t per_key = spline ? 3 : 1, count = numbers.size() / std::size_t(components);
  if (count != track.times_s.size() * per_key)
    import.fail(place + ".output", std::to_string(count) + " values for " +
                                       std::to_string(track.times_s.size()) + " keys" +
                                       (spline ? " (a spline needs three each)" : ""));
  import.take_memory(count * sizeof(std::array<double, 4>), place);
  track.values.assign(count, {});
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < std::size_t(components); ++c)
      track.values[i][c] = numbers[i * std::size_t(components) + c];
    const bool is_tangent = spline && i % 3 != 1;
    if (components == 4 && !is_tangent && !normalize_rotation(track.values[i]))
      import.fail(place + ".output",
                  "key " + std::to_string(i / per_key) + " is a quaternion of zero length");
  }
}

AnimationTrack read_track(Import& import, const tinygltf::Animation& source,
                          const tinygltf::AnimationChannel& channel, Path path, const std::string& place) {
  if (channel.sampler < 0 || std::size_t(channel.sampler) >= source.samplers.size())
    import.fail(place + ".sampler", "sampler " + std::to_string(channel.sampler) + " does not exist");
  const tinygltf::AnimationSampler& sampler = source.samplers[std::size_t(channel.sampler)];
  AnimationTrack track;
  track.node = import.node_from_source[std::size_t(channel.target_node)];
  track.path = path;
  track.interpolation = interpolation_of(import, sampler.interpolation, place);
  track.times_s = read_numbers(import, sampler.input, 1, place + ".input");
  for (std::size_t i = 1; i < track.times_s.size(); ++i)
    if (!(track.times_s[i] > track.times_s[i - 1]))
      import.fail(place + ".input",
                  "times must increase from key to key; key " + std::to_string(i) + " does not");
  if (track.times_s.front() < 0) import.fail(place + ".input", "the first time is negative");
  if (import.scene.nodes[std::size_t(track.node)].has_matrix)
    import.fail(place,
                "animates a node that is given by a matrix; export it as translation, rotation, scale");
  read_values(import, sampler, place, track);
  return track;
}

}  // namespace

void import_animations(Import& import) {
  std::set<std::pair<int, Path>> animated;
  for (std::size_t a = 0; a < import.model.animations.size(); ++a) {
    const tinygltf::Animation& source = import.model.animations[a];
    Animation animation;
    animation.name = source.name;
    for (std::size_t c = 0; c < source.channels.size(); ++c) {
      const std::string place =
          place_of("animations", a, source.name) + ".channels[" + std::to_string(c) + "]";
      Path path{};
      if (!wanted(import, source.channels[c], place, path)) continue;
      AnimationTrack track = read_track(import, source, source.channels[c], path, place);
      if (!animated.insert({track.node, path}).second) {
        import.ignore("further animation of a property that an earlier animation moves already");
        continue;
      }
      import.scene.duration_s = std::max(import.scene.duration_s, track.times_s.back());
      animation.tracks.push_back(std::move(track));
    }
    if (!animation.tracks.empty()) import.scene.animations.push_back(std::move(animation));
  }
}

}  // namespace tempolux::gltf
