// lib/render/data_channels.h -- channels of the surfaces that rays through the pixels' centres see.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/localised_light.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

class Shutter;

/// Throws InputError, which lists the known groups, if `channels` holds an unknown group.
void check_channels(const std::vector<std::string>& channels);

/// The scene and the camera one frame later or earlier. null: there is no such frame.
struct NeighbourFrame {
  const SceneFrame* frame = nullptr;
  const CameraView* view = nullptr;
};
/// Adds the requested data channels of one ray through each pixel's centre. A surface with alpha mode BLEND is met or
/// passed at random, once per pixel. Where the ray meets no surface, Z is infinity, id is kNone, all else is 0.
/// - Z: CameraView::depth [m]; P: position in world space [m]; id: object.
/// - N: shading normal with normal map, unit, world axes, on the side that is seen.
/// - albedo: diffuse_albedo_of_both(), with textures at the pixel's level.
/// - motion: in pixels, +u right, +v up, to the point's place in the frame `next` (forward) and `previous` (backward).
void add_data_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       const NeighbourFrame& next, const NeighbourFrame& previous, Image& image);

/// Adds "seen.Z", "seen.N.X .Y .Z", "seen.id" and "seen.albedo.R .G .B" if `channels` has "seen". The ray through the
/// pixel's centre continues at mirrors and smooth glass (delta lobes, also those above a Lambert lobe), by the likelier
/// of reflection and transmission, up to kMostMirrors times. The first surface without a delta lobe has
/// - Z: depth of the virtual image [m], which lies on the pixel's ray at the length of the whole path. In a plane
/// mirror 1/Z is linear over pixels, as without a mirror. 0 where the path leaves the scene.
/// - N: shading normal, on the side that the ray meets.
/// - id: object; after mirrors a hash of all objects on the path.
/// - albedo: the share of uniform light that all lobes reflect. Without a mirror on the path it is the share of the
/// lobes S alone, because layer specular then holds no other light of this surface. 1 where the path leaves the scene.
void add_seen_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       Image& image);

/// If `channels` has "influence", adds the float channels "influence" (LocalisedLight::influence) and "blend"
/// (LocalisedLight::gathered_share). Their place is the first Lambert lobe that the ray through the pixel's centre
/// reaches (seen_through); 0 where there is none. An infinite influence, as on movers, is stored as the upper
/// threshold. Throws InputError if "influence" is requested and `light` is null.
void add_influence_channels(const RenderScene& scene, const CameraView& view, const LocalisedLight* light,
                            const std::vector<std::string>& channels, Image& image);

/// Adds two uint channels, if `channels` has "coverage".
///
/// "coverage" holds four bits for each of the eight neighbouring pixels, in rows from the top: bits 0-3 for the upper
/// left neighbour, bits 28-31 for the lower right one. The bits count how many of 16 rays, spread uniformly over the
/// pixel, see the surface that the neighbour's centre sees; if several neighbours see this surface, the closest one
/// counts. A count of 16 is stored as 15. "coverage.other" counts the rays that see a surface which neither the pixel's
/// own centre nor a neighbour's centre sees. All other rays see the surface of the pixel's own centre. If both channels
/// are 0, the pixel sees one surface.
///
/// Two hits are on one surface if they have the same object and material, the cosine between their normals is above
/// PixelSurfaces::kSameNormal, and each hit lies within a pixel's width of the other's plane. Costs nine rays per
/// pixel: one through the centre, and eight that search for surfaces which no centre sees, such as wires. Where these
/// rays and the centres of the neighbours see two surfaces, a pixel costs 16 further rays. Nothing is shaded. The rays
/// do not depend on seed or frame.
///
/// Returns by pixel 1 where one of the channels is not 0; empty without "coverage".
std::vector<std::uint8_t> add_coverage_channel(const RenderScene& scene, const CameraView& view,
                                               const std::vector<std::string>& channels, Image& image);

/// Finds the edges of a blurred picture. Returns 1 for each pixel in which eight rays over the pixel, the lens and the
/// time that the shutter is open meet several surfaces, else 0. Surfaces differ as in add_coverage_channel. Points of
/// moving surfaces are compared at the frame's time. The rays do not depend on seed or frame. shutter: may be null.
std::vector<std::uint8_t> soft_edges(const RenderScene& scene, const CameraView& view, const Shutter* shutter);

}  // namespace tempolux
