// lib/scene/gltf_animation.cpp -- reads animations as tracks: translation, rotation, scale and morph weights of nodes.
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <string>
#include <utility>

#include "formats/error.h"
#include "lib/scene/gltf_check.h"
#include "lib/scene/gltf_gate.h"
#include "lib/scene/gltf_pointer.h"
#include "lib/scene/material_properties.h"

namespace tempolux::gltf {
namespace {

using Path = AnimationTrack::Path;
using Interpolation = AnimationTrack::Interpolation;

constexpr std::array kInterpolations{std::pair{"LINEAR", Interpolation::linear}, std::pair{"STEP", Interpolation::step},
                                     std::pair{"CUBICSPLINE", Interpolation::cubic_spline}};

std::optional<Interpolation> interpolation_of(const std::string& name) {
  for (const auto& [known, interpolation] : kInterpolations)
    if (name == known) return interpolation;
  return std::nullopt;
}

/// True if the channel's target is a node of the scene; sets `path`.
bool wanted(const Import& import, const tinygltf::AnimationChannel& channel, const std::string& place, Path& path) {
  static const std::map<std::string, Path> paths{{"translation", Path::translation},
                                                 {"rotation", Path::rotation},
                                                 {"scale", Path::scale},
                                                 {"weights", Path::weights}};
  const std::string& name = channel.target_path;
  const auto found = paths.find(name);
  if (found == paths.end())
    import.fail(place + ".target.path", "\"" + name + "\" is not translation, rotation, scale or weights");
  path = found->second;
  if (channel.target_node == -1) return false;
  if (channel.target_node < 0 || std::size_t(channel.target_node) >= import.model.nodes.size())
    import.fail(place + ".target.node", "node " + std::to_string(channel.target_node) + " does not exist");
  // A node of another scene of the file is not imported, so its channel is ignored. A node that is never seen has no
  // mesh, so its morph weights are ignored.
  const int node = import.node_from_source[std::size_t(channel.target_node)];
  return node != -1 && !(path == Path::weights && import.scene.nodes[std::size_t(node)].never_seen);
}

/// Numbers per value of a track; for weights, the number of morph targets of the node's mesh.
std::size_t components_of(const Import& import, Path path, std::size_t property, int target, const std::string& place) {
  switch (path) {
    case Path::weights: break;
    case Path::material: return material_properties()[property].components();
    case Path::rotation: return 4;
    case Path::translation:
    case Path::scale:
    case Path::light_color: return 3;
    default: return 1;
  }
  const std::size_t count = import.scene.nodes[std::size_t(target)].weights.size();
  if (count == 0) import.fail(place, "animates morph weights of a node whose mesh has no morph targets");
  return count;
}

void read_values(Import& import, const tinygltf::AnimationSampler& sampler, const std::string& place,
                 AnimationTrack& track) {
  const bool spline = track.interpolation == Interpolation::cubic_spline;
  const bool weights = track.path == Path::weights;
  track.values = read_numbers(import, sampler.output, weights ? 1 : int(track.components), place + ".output");
  const std::size_t keys = track.times_s.size(), per_key = spline ? 3 : 1, n = track.components;
  if (track.values.size() != keys * per_key * n)
    import.fail(place + ".output", std::to_string(track.values.size() / n) + " values for " + std::to_string(keys) +
                                       " keys" + (spline ? " (a spline needs three each)" : "") +
                                       (weights ? " of " + std::to_string(n) + " morph targets" : ""));
  if (track.path != Path::rotation) return;
  // The tangents of a spline are not rotations.
  for (std::size_t i = spline ? 1 : 0; i < keys * per_key; i += per_key) {
    std::array<double, 4> rotation;
    std::copy_n(&track.values[i * 4], 4, rotation.begin());
    if (!normalize_rotation(rotation))
      import.fail(place + ".output", "key " + std::to_string(i / per_key) + " is a quaternion of zero length");
    std::copy_n(rotation.begin(), 4, &track.values[i * 4]);
  }
}

AnimationTrack read_track(Import& import, const tinygltf::Animation& source, int sampler_index, const PointedAt& at,
                          const std::string& place) {
  const auto [path, target, property] = at;
  if (sampler_index < 0 || std::size_t(sampler_index) >= source.samplers.size())
    import.fail(place + ".sampler", "sampler " + std::to_string(sampler_index) + " does not exist");
  const tinygltf::AnimationSampler& sampler = source.samplers[std::size_t(sampler_index)];
  AnimationTrack track;
  track.target = target;
  track.path = path;
  track.property = property;
  track.components = components_of(import, path, property, target, place);
  const std::optional<Interpolation> interpolation = interpolation_of(sampler.interpolation);
  track.interpolation = interpolation.value_or(Interpolation::linear);  // glTF's default; the keys stay valid
  track.times_s = read_numbers(import, sampler.input, 1, place + ".input");
  for (std::size_t i = 1; i < track.times_s.size(); ++i)
    if (!(track.times_s[i] > track.times_s[i - 1]))
      import.fail(place + ".input", "times must increase from key to key; key " + std::to_string(i) + " does not");
  if (track.times_s.front() < 0) import.fail(place + ".input", "the first time is negative");
  if (path < Path::weights && import.scene.nodes[std::size_t(target)].has_matrix)
    import.fail(place, "animates a node that is given by a matrix; export it as translation, rotation, scale");
  read_values(import, sampler, place, track);
  if (path == Path::visible && track.interpolation != Interpolation::step) {
    if (track.interpolation == Interpolation::cubic_spline)
      import.fail(place, "is a spline, but true and false cannot be");
    track.interpolation = Interpolation::step;
    import.mend(place, "visibility whose interpolation is not STEP is played as STEP", 1);
    return track;
  }
  if (!interpolation)
    import.mend(place,
                "channels whose interpolation \"" + one_line(sampler.interpolation, 40) +
                    "\" glTF does not have are played as LINEAR",
                1);
  return track;
}

std::string name_of(const tinygltf::Animation& source, std::size_t index) {
  return source.name.empty() ? "animation " + std::to_string(index) : source.name;
}

/// Throws if the user asked for an animation and no animation of the file has this name.
void check_name(const Import& import, const std::string& asked) {
  std::string names;
  for (std::size_t a = 0; a < import.model.animations.size(); ++a) {
    const std::string name = name_of(import.model.animations[a], a);
    if (asked == name) return;
    names += (names.empty() ? "" : ", ") + one_line(name, 60);
  }
  import.fail("animations",
              "none is named \"" + one_line(asked, 60) + "\"; there is " + (names.empty() ? "none at all" : names));
}

}  // namespace

bool is_played(const tinygltf::Model& model, std::size_t animation, const std::string& only) {
  return animation < model.animations.size() &&
         (only.empty() || name_of(model.animations[animation], animation) == only);
}

std::size_t target_count(const tinygltf::Mesh& mesh) {
  return mesh.primitives.empty() ? 0 : mesh.primitives.front().targets.size();
}

namespace {

/// Reads the tracks of one animation. An invalid channel is dropped with a warning; with `strict` it throws InputError.
std::vector<AnimationTrack> read_tracks(Import& import, std::size_t index, bool strict) {
  const tinygltf::Animation& source = import.model.animations[index];
  std::vector<AnimationTrack> tracks;
  const auto attempt = [&](const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      if (strict) throw;
      import.scene.warnings.push_back(error.what() + std::string("; this channel is not played"));
    }
  };
  for (std::size_t c = 0; c < source.channels.size(); ++c)
    attempt([&] {
      const std::string place = place_of("animations", index, source.name) + ".channels[" + std::to_string(c) + "]";
      Path path{};
      if (!wanted(import, source.channels[c], place, path)) return;
      const int target = import.node_from_source[std::size_t(source.channels[c].target_node)];
      tracks.push_back(read_track(import, source, source.channels[c].sampler, {path, target}, place));
    });
  for (const PointerChannel& channel : import.gated->pointers)
    attempt([&] {
      PointedAt at;
      if (channel.animation != index || !resolve_pointer(import, channel.pointer, at)) return;
      const std::string place =
          place_of("animations", index, source.name) + ": pointer " + one_line(channel.pointer, 100);
      tracks.push_back(read_track(import, source, channel.sampler, at, place));
    });
  return tracks;
}

}  // namespace

void import_animations(Import& import, const std::string& only) {
  if (!only.empty()) check_name(import, only);
  std::set<std::tuple<int, Path, std::size_t>> animated;
  for (std::size_t a = 0; a < import.model.animations.size(); ++a) {
    const tinygltf::Animation& source = import.model.animations[a];
    if (!is_played(import.model, a, only)) continue;
    std::vector<AnimationTrack> tracks = read_tracks(import, a, !only.empty());
    Animation animation;
    animation.name = source.name;
    for (AnimationTrack& track : tracks) {
      if (!animated.insert({track.target, track.path, track.property}).second) {
        import.ignore(
            "further animation of a property that an earlier animation moves already "
            "(--animation NAME chooses one)");
        continue;
      }
      import.scene.duration_s = std::max(import.scene.duration_s, track.times_s.back());
      animation.tracks.push_back(std::move(track));
    }
    if (!animation.tracks.empty()) import.scene.animations.push_back(std::move(animation));
  }
  keep_factors(import);
}

}  // namespace tempolux::gltf
