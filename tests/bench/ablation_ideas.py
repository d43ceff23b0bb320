"""The ideas of the samplers, each with the change to the source that leaves it out.

A change is (file, text, replacement); the text must stand there exactly once. `ablation.py --check` (a test) says which ones the code has left behind.
`stage`: what must be part of a scene's chain for the idea to matter: frames, cache (records), points, photons.
"""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Idea:
    name: str
    what: str
    stage: str
    edits: tuple


IDEAS = (
    # ---- samples of light
    Idea("suns apart", "a ray to a sun beside that to another light", "frames",
         (("tools/stages/lit_frame.cpp", "!is_reference && lights_->has_suns()", "false"),)),
    Idea("matte rays meet lamps", "a ray that leaves a matte surface counts lamps it meets, weighed against light samples", "frames",
         (("lib/render/eye_light.cpp", "if (has_diffuse) diffuse *= mis_power(pdf, at.times_diffuse * x.bsdf.pdf_diffuse(wi, x.eye));", ""),
          ("lib/render/path_tracer.cpp", "times * (next.diffuse ? x.bsdf.pdf_diffuse(next.wi, x.eye)", "times * (next.diffuse ? 0.0f"))),
    Idea("gloss forks", "under a gloss both lobes are followed at the first surface", "frames",
         (("lib/render/path_tracer.cpp", "if (known_ && known_->forks() && ", "if (known_ && state.bounce > 1000 && known_->forks() && "),)),
    Idea("gloss reads points", "what a rough gloss shows is told by points, as what rays of the hemisphere meet", "frames",
         (("lib/render/eye_light.cpp", "(state.spread > 0 && !known.bright)", "(state.spread > 1000 && !known.bright)"),)),
    # ---- numbers of samples
    Idea("parts apart", "light samples, rays onward and camera rays have numbers of their own", "frames",
         (("lib/render/adaptive_frame.cpp",
           "const PartCounts more = missing_samples(have, noise_.wanted_at(x, y, times));",
           "PartCounts all = noise_.wanted_at(x, y, times);\n"
           "    all.own = all.lit = all.onward = std::max({all.own, all.lit, all.onward});\n"
           "    const PartCounts more = missing_samples(have, all);"),)),
    Idea("edges between pixels", "what is seen counts as uneven where neighbours differ", "frames",
         (("lib/render/pixel_noise.cpp", "(options_.samples == 1 ? 1 : kBetween)", "(options_.samples == 1 ? 1 : 0 * kBetween)"),)),
    # Stays whatever codes say: without it filtered frames have blotches (docs/notebook/outliers.md).
    Idea("outliers spread", "light that one sample alone claims goes to the pixels around", "frames",
         (("tools/stages/render_frame.cpp", "frame.spread_outliers = !options.keep_outliers &&", "frame.spread_outliers = false &&"),)),
    # ---- photons and points
    Idea("photons by importance", "photons of suns and skies start where cameras look", "photons",
         (("lib/pilot/seen_spheres.cpp", "gain >= kLeastGain};", "gain >= 1e9 * kLeastGain};"),)),
    Idea("more photons", "up to 16 times as many photon paths where few of them arrive", "photons",
         (("lib/pilot/rough_frame.cpp", "if (scene.lights.has_distant()) rough.paths_of_light", "if (scene.lights.count() > 1000000000) rough.paths_of_light"),)),
    Idea("points by importance", "points lie where cameras look", "points",
         (("lib/points/irradiance_points.cpp", "if (seen.empty()) return {};\n  std::vector<double> standing", "if (seen.size() < 1000000) return {};\n  std::vector<double> standing"),)),
    Idea("near hits go on", "rays that end nearer than two radii of an estimate go on for a bounce", "points",
         (("lib/irradcache/points.h", "static constexpr float kNear = 2;", "static constexpr float kNear = 0;"),)),
    Idea("shadow borders", "where points side by side have direct light that differs eightfold it is sampled instead", "points",
         (("lib/irradcache/points.cpp", "bool even() const { return !(least * kContrast < most); }", "bool even() const { return true; }"),)),
    Idea("answers by cell", "which point answers in a cell of half a spacing is found once", "points",
         (("lib/irradcache/points.cpp", "  std::size_t slot = mix64(q.cell) & mask_;\n  for (", "  std::size_t slot = mix64(q.cell) & mask_;\n  if (mask_ > 0) return search_cell(q.cell);\n  for ("),)),
    # ---- records
    Idea("gradients", "records are extrapolated by their gradients", "cache",
         (("lib/gather/place_records.cpp", "  for (Vec3& g : record.translational) g *= float(kept);\n", "  record.translational = record.rotational = {};\n"),)),
    Idea("looks at edges", "four more places in pixels at edges and behind glass get records", "cache",
         (("lib/gather/place_records.cpp", "k < kEdgeLooks; ++k", "k < 0 * kEdgeLooks; ++k"),
          ("lib/gather/world_records.cpp", "parallel_found<WantedPoint>(edges.size() * kEdgeLooks,", "parallel_found<WantedPoint>(edges.size() * 0,"))),
    Idea("no records in cracks", "a place that sees surfaces closer than a pixel gets no record", "cache",
         (("lib/gather/world_records.cpp", "  if (member.range < seen.footprint) return std::nullopt;\n", ""),)),
    Idea("clearance", "records know how far they see along their surface, so that none answers across a wall", "cache",
         (("lib/gather/final_gather.cpp", "  record.clearance = reach_.clearance(from.position, lit, record.normal, record.radius * Clearance::kPerRadius);",
           "  if (!(length2(lit) > 0)) record.clearance = reach_.clearance(from.position, lit, record.normal, record.radius * Clearance::kPerRadius);"),)),
    Idea("rays of records by a pilot", "scene-plan finds how many rays records need", "cache",
         (("lib/pilot/choose_light.cpp", "way.rays = rays_of_records(rough, order, of_pixels, way);", "way.rays = 500;"),)),
)
