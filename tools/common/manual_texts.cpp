// tools/common/manual_texts.cpp -- texts of the man pages besides options.
#include "tools/common/manual.h"

namespace tempolux::tools {
namespace {

constexpr ManualText kTexts[] = {
    {"scene-plan",
     "Reads a glTF scene and a range of frames, evaluates them, and decides which stages of the pipeline have work and "
     "why, which frames share their light, and what has changed since the last run. make includes its plan.mk.\n"
     "\n"
     "State files are rewritten only when their content differs, so moving the camera traces no photon again. Pilots "
     "of some tenths of a second decide how indirect light is found (--indirect) and which parts of a frame's light "
     "follow from the static light (--moving).",
     "plan/plan.mk: make variables (formats/plan/plan.md)\n"
     "plan/plan.json: the same for people and scripts\n"
     "state/*: view files, majorants, the decisions for each segment, and the state of input files",
     "scene-plan room.glb --frames 0-47 -o plan\n"
     "less plan/plan.json",
     "photon-trace irradcache-build frame-render"},
    {"photon-trace",
     "Starts light paths at the lights of a scene and records where they arrive, with flux, normal, object and kind. "
     "All emitted flux is stored, absorbed or escapes, and the end of the file has the sum of each.\n"
     "\n"
     "--map static traces the scene without movers, once for all frames of a segment. --map dynamic then traces the "
     "touched paths of a frame and writes the signed change that the movers make. The sum of static and dynamic map is "
     "the global map, photon by photon (docs/methods/dynamic.md).",
     ".photons: photons in blocks with checksums (formats/photons/photons.md)\n"
     ".paths: which paths movers can touch, and when (formats/paths/paths.md)",
     "photon-trace room.glb --frame 12 --photons 200k --kinds caustic,indirect -o 12.photons\n"
     "# A map for each frame of a range; the scene is read once.\n"
     "photon-trace room.glb --frames 0-47 -o map.####.photons\n"
     "# A house in wide country: photons of sun and sky are aimed where the cameras of the plan look.\n"
     "photon-trace house.glb --frame 0 --importance out/state/0000-*.view -o 0.photons\n"
     "# The static light of a segment, and the change that movers make at each frame.\n"
     "photon-trace room.glb --frame 0 --map static -o s.photons --paths s.paths\n"
     "photon-trace room.glb --frames 0-23 --map dynamic --static s.paths -o d.####.photons\n"
     "# Smoke: all of frame 0, then a tenth of the paths of each frame; then 30k further paths for frame 12.\n"
     "photon-trace room.glb --frame 0 --kinds indirect,volume --majorants out/state/0000-*.majorants -o "
     "p.0000.photons\n"
     "photon-trace room.glb --frames 1-23 --kinds indirect,volume --majorants out/state/0000-*.majorants --update "
     "p.####.photons --share 10% "
     "--strategy census -o p.####.photons\n"
     "photon-trace room.glb --frame 12 --kinds indirect,volume --majorants out/state/0000-*.majorants --update "
     "p.0012.photons --refine 30k -o more.photons",
     "scene-plan irradcache-build tempolux-info"},
    {"photonmap-split",
     "Divides the light of photons or irradiance points into two files whose sum is the whole to the last bit. "
     "Cells of a grid keep light up to a limit (--energy), and the same share of every record in a cell goes to the "
     "high part, which can then be sampled explicitly, like lights. Cells are summed without rounding, so the order of "
     "records, blocks and threads do not matter. Photons "
     "from a pipe are read twice, so they are stored in a temporary file next to the low part.",
     ".photons: read and written (formats/photons/photons.md)\n"
     ".irradpoints: read and written (formats/irradpoints/irradpoints.md)",
     "photonmap-split 12.irradpoints --low low.irradpoints --high high.irradpoints\n"
     "photon-trace room.glb --photons 200k -o - | photonmap-split - --low low.photons --high high.photons --energy 8",
     "photon-trace irradcache-build tempolux-info"},
    {"irradcache-build",
     "Spreads irradiance points over all surfaces and estimates from photons how much light arrives at each (points); "
     "gathers indirect light in records where a camera needs them, densely where it changes (records); or both in one "
     "run.",
     ".photons: read (formats/photons/photons.md)\n"
     ".irradpoints: irradiance by kind at points (formats/irradpoints/irradpoints.md)\n"
     ".irradcache: irradiance records with gradients (formats/irradcache/irradcache.md)",
     "irradcache-build room.glb --frame 12 --photons 12.photons --size 640x360 -o 12.irradcache\n"
     "# In two steps, so that the points can be examined or shared.\n"
     "irradcache-build points room.glb --frame 12 --photons 12.photons -o 12.irradpoints\n"
     "irradcache-build records room.glb --frame 12 --points 12.irradpoints --size 640x360 -o 12.irradcache\n"
     "irradcache-build records room.glb --frame 12 --points low.irradpoints --high high.irradpoints -o 12.irradcache",
     "photon-trace frame-render tempolux-info"},
    {"gather-temporal",
     "Gathers indirect light in records whose samples of incoming radiance are kept from frame to frame. The first "
     "frame of a segment is gathered as irradcache-build does it. In later frames a sample is traced again only if "
     "something moves across its ray, or if the light of the surface it hit has changed; some further samples, drawn "
     "by age, get a new direction; all others follow the irradiance points of the frame. New records are placed where "
     "the kept ones do not reach.\n"
     "\n"
     "A range of frames keeps the samples in memory and writes those of each frame. Single frames with --previous give "
     "the same files. Points of all frames must be "
     "made with the same options: points on static surfaces then have the same places.\n"
     "\n"
     "gather-temporal density SCENE --photons FILE -o FILE makes light textures from the photons of many frames "
     "instead: each element of the surfaces uses as many frames before and after as its light stays constant "
     "(docs/methods/density.md). Its options: gather-temporal density --help.",
     ".irradpoints: light on all surfaces, read (formats/irradpoints/irradpoints.md)\n"
     ".radsamples: records with their samples (formats/radsamples/radsamples.md)\n"
     ".irradcache: the records of a frame (formats/irradcache/irradcache.md)\n"
     ".photons, .meshirrad: read and written by gather-temporal density (formats/meshirrad/meshirrad.md)",
     "gather-temporal final room.glb --frames 0-23 --points p.####.irradpoints --size 640x360 -o s.####.radsamples "
     "--cache c.####.irradcache\n"
     "# One frame after the other, as make does.\n"
     "gather-temporal final room.glb --frame 0 --points p.0000.irradpoints --size 640x360 -o s.0000.radsamples --cache "
     "c.0000.irradcache\n"
     "gather-temporal final room.glb --frame 1 --points p.0001.irradpoints --size 640x360 --previous s.0000.radsamples "
     "-o s.0001.radsamples "
     "--cache c.0001.irradcache\n"
     "# Fast previews with little noise, from the photons of many frames.\n"
     "photon-trace room.glb --frames 0-47 --photons 25k --seed-mode frame --kinds indirect -o p.####.photons\n"
     "gather-temporal density room.glb --frames 0-47 --photons p.####.photons -o d.####.meshirrad\n"
     "frame-render room.glb --frames 0-47 --size 640x360 --meshirrad d.####.meshirrad -o f.####.exr",
     "irradcache-build frame-render tempolux-info"},
    {"frame-render",
     "Traces the pixels of a frame. Direct light is sampled at the lights; indirect light is read from an irradiance "
     "cache or estimated from photons, caustic light from photons. With path tracing camera paths find all light, "
     "which is unbiased and slow. Camera paths find light that the files lack: without photons they find caustic "
     "light; without a record a ray over the hemisphere finds indirect light and ends at the points, if there are any. "
     "Points alone suffice, too. Light that a single sample found is spread over the surrounding pixels without "
     "changing any layer's sum; path tracing does not spread.",
     "frame .exr: colour, depth, normals, ids (formats/frames/frames.md)",
     "frame-render room.glb --frame 12 --size 640x360 --irradcache 12.irradcache --points 12.irradpoints -o 12.exr\n"
     "# Caustic light in a scene with movers: the static map, and the change that movers make.\n"
     "frame-render room.glb --frame 12 --irradcache 12.irradcache --photons s.photons --dynamic d.0012.photons -o "
     "12.exr\n"
     "# From points alone: no records are placed, and there is more noise.\n"
     "frame-render room.glb --frame 12 --size 640x360 --points 12.irradpoints -o 12.exr\n"
     "# By paths, but for the light that mirrors and glass throw: photon-trace --kinds caustic.\n"
     "frame-render glass.glb --frame 12 --size 640x360 --photons 12.photons -o 12.exr\n"
     "# A reference in two independent halves, so that its noise is known.\n"
     "frame-render room.glb --frame 12 --size 640x360 --integrator path --spp 256 --halves -o ref.exr",
     "irradcache-build aqm-compare tempolux-info"},
    {"ibr-warp",
     "Makes a frame from one or two rendered key frames: each of its pixels looks up its surface point in the keys and "
     "takes their colour there, layer by layer. A mask names pixels that the keys do not give well enough, with the "
     "cause; frame-render traces them over the warped frame. ibr-warp also writes the flow of each pixel: where its "
     "surface point is in the next and in the previous frame.",
     "key .exr: frames with RGBA, Z, N, id and better with the layer specular (formats/frames/frames.md)\n"
     "flow .exr: pixel flow (formats/flow/flow.md)\n"
     "mask .exr: pixels to trace, with causes (formats/mask/mask.md)",
     "ibr-warp 8.exr 16.exr --scene room.glb --frame 12 -o 12.exr --mask why.exr --flow flow.exr\n"
     "# Trace the missing pixels.\n"
     "frame-render room.glb --frame 12 --size 640x360 --irradcache 12.irradcache --points 12.irradpoints --base 12.exr "
     "--mask why.exr -o "
     "12.exr\n"
     "# Frames of another renderer, with Z and the matrices of their cameras.\n"
     "ibr-warp left.exr --view right.exr -o warped.exr --mask why.exr",
     "frame-render aqm-compare tempolux-info"},
    {"st-filter",
     "Removes noise from a frame with few samples: planes are fitted to the light around each pixel, in its own frame "
     "and in neighbouring frames along the pixel flow. Another pixel counts if it shows the same surface (id.object, "
     "Z, N); in large windows its weight also depends on how well its value agrees. Two halves of the light, LAYER "
     "plus and minus LAYER.noise (frame-render --channels halves), give the error of each candidate; where the "
     "unfiltered samples have less error they stay. With albedo only light is filtered, not textures. Emission and "
     "specular light are filtered by the surfaces in mirrors and glass (channels seen). With coverage edges are "
     "composed from the surfaces that a pixel shows.\n"
     "\n"
     "Frames of other programs get halves from their variance, or from the differences of neighbours if they have "
     "albedo; without either they stay as they are.\n"
     "\n"
     "st-filter mesh SCENE --photons FILE -o FILE makes light textures instead: photons are counted by small triangles "
     "of the surfaces and smoothed along the surfaces; frame-render --meshirrad reads them "
     "(docs/methods/light_textures.md). Its options: st-filter mesh --help.",
     "frame .exr: read and written (formats/frames/frames.md)\n"
     "flow .exr: pixel flow to the next and the previous frame (formats/flow/flow.md)\n"
     ".meshirrad: written by st-filter mesh (formats/meshirrad/meshirrad.md)",
     "frame-render room.glb --frames 0-47 --spp 4 --pixel-error 0.016 --seed-mode frame --irradcache c.####.irradcache "
     "--channels RGBA,layers,Z,N,id,albedo,motion,coverage,halves,seen -o f.####.exr\n"
     "st-filter f.####.exr --frames 0-47 -o filtered.####.exr\n"
     "# One frame, from its own file and two files before and after it.\n"
     "st-filter f.0008.exr f.0009.exr f.0010.exr f.0011.exr f.0012.exr -o filtered.0010.exr\n"
     "# A light texture, and a frame lit by it.\n"
     "st-filter mesh room.glb --frame 12 --photons 12.photons -o 12.meshirrad\n"
     "frame-render room.glb --frame 12 --size 640x360 --meshirrad 12.meshirrad -o 12.exr",
     "frame-render aqm-compare tempolux-info"},
    {"volume-compose",
     "Adds the smoke of a scene to a frame: photons in media (photon-trace --kinds ...,volume) are summed in cells and "
     "filtered, each pixel's rays march through the smoke to the surfaces of the scene, and lights are sampled on the "
     "way. The base is a frame of the same scene, whose light frame-render has already attenuated, or any frame with a "
     "channel Z.",
     "frame .exr: read and written, with layer volume (formats/frames/frames.md)\n"
     ".photons: read (formats/photons/photons.md)\n"
     ".vdb: density of the smoke, OpenVDB",
     "photon-trace room.glb --frame 12 --photons 300k --kinds caustic,indirect,volume -o 12.photons\n"
     "irradcache-build room.glb --frame 12 --photons 12.photons --size 640x360 -o 12.irradcache\n"
     "frame-render room.glb --frame 12 --size 640x360 --photons 12.photons --irradcache 12.irradcache -o 12.exr\n"
     "volume-compose room.glb --frame 12 --photons 12.photons --base 12.exr -o 12.smoke.exr",
     "photon-trace frame-render tempolux-info"},
    {"aqm-compare",
     "Measures the error of a frame or a sequence against a reference: RMSE, relMSE, bias, PSNR, flicker. With two "
     "independent halves of a reference, the noise of the reference cancels. With --flow or --metric aqm it predicts "
     "in how many pixels a viewer sees a difference.",
     "comparison .json: the figures (formats/comparison/comparison.md)",
     "aqm-compare 12.exr --reference-halves ref_a.exr ref_b.exr --difference wrong.png", "frame-render error-report"},
    {"error-report",
     "Draws error against run time: reads the statistics of the tools and the comparisons of their frames, writes "
     "tables, "
     "plots and one HTML page.",
     "report/: Markdown, plots, HTML (formats/report/report.md)\n"
     "stats .json: the cost of a run (formats/stats/stats.md)",
     "error-report --run scene=room,curve=draft,label=12 photons.json+frame.json 12.error.json -o report",
     "aqm-compare frame-render"},
    {"tempolux-info",
     "Prints facts about a file, checks it to its end, digests its data, compares two files, exports points and makes "
     "pictures. The first bytes of a file determine its type, not its name.",
     ".photons .irradpoints .irradcache .radsamples .exr .json: read; the pages in formats/ define them",
     "tempolux-info 12.photons\n"
     "tempolux-info --check out/photons/*.photons\n"
     "tempolux-info 12.exr --png 12.png\n"
     "tempolux-info --sheet sheet.png --columns 8 out/frames/*.exr",
     "photon-trace irradcache-build frame-render"},
};

}  // namespace

ManualText manual_text(const std::string& tool) {
  for (const ManualText& text : kTexts)
    if (tool == text.tool) return text;
  return {"", "", "", "", ""};
}

}  // namespace tempolux::tools
