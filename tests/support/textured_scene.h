// tests/support/textured_scene.h -- what the tests of textures share.
#pragma once

#include "lib/light/lights.h"
#include "lib/render/known_light.h"
#include "lib/render/path_tracer.h"
#include "lib/scene/texture_lookup.h"
#include "tests/support/materials.h"
#include "tests/support/photons.h"
#include "tests/support/png_bytes.h"
#include "tests/support/scenes.h"

namespace tempolux::test {

/// The emission table of a single frame.
inline EmissionTable table_of(HandMadeScene& scene) { return build_emission_table({&scene.frame(), 1}); }

}  // namespace tempolux::test
