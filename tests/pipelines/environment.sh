#!/bin/sh
# A scene lit by its environment alone, through all stages: sh tests/pipelines/environment.sh BIN [SCENE MAP]
# Run at the top of the tree; BIN is the folder with the tools. Path tracing and the chain photon-trace ->
# irradcache-build -> frame-render agree in the mean. A file made with another environment is refused, and the plan
# depends on the environment. SCENE and MAP: another scene with a camera, and a map, for which both must agree, too.
bin=$1
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
. tests/support/chain.sh
failed=0
bad() { echo "FAILED: $*"; failed=1; }
python3 -B - "$work" <<'END' || exit 3
import sys
sys.path.insert(0, "tests/stress")
from family_environment import write_hdr
from scenes import Scene
work = sys.argv[1]
scene = Scene()
floor, brick, white = scene.material(0.4), scene.material([0.5, 0.25, 0.15]), scene.material(0.75)
scene.quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3), floor)
scene.quad((-2, 0, -2), (2, 0, -2), (2, 2, -2), (-2, 2, -2), brick)
scene.quad((-2, 0, 1), (-2, 0, -2), (-2, 2, -2), (-2, 2, 1), white)
scene.camera((4, 3, 5), (-0.5, 0.6, -0.8), fov=0.7)
scene.save(work + "/yard.gltf")
pixel = lambda value, e: bytes([int(128 * v) for v in value]) + bytes([e])
sky, ground = pixel((0.5, 0.7, 1.0), 129), pixel((0.6, 0.5, 0.4), 126)
sun = sky * 20 + pixel((1.0, 0.9, 0.8), 142) * 2 + sky * 42
write_hdr(work + "/sky.hdr", 64, [(9, sky), (2, sun), (5, sky), (16, ground)])
END
yard=$work/yard.gltf sky="--environment $work/sky.hdr"

# compare SCENE ENVIRONMENT: compares the means over all channels of the frames by path tracing and by the chain.
mean() { "$bin/tempolux-info" --json "$1" | python3 -c 'import json, sys
means = {c["channel"]: c["mean"] for c in json.load(sys.stdin)["channels"]}
print(sum(means[c] for c in "RGB") / 3)'; }
compare() {
  of_photons='--photons 400k --kinds caustic,indirect' of_records='--size 96x54' of_pixels='--size 96x54 --spp 16'
  "$bin/frame-render" "$1" $2 --size 96x54 -q --spp 64 -o "$work/path.exr" &&
  light "$work/p" "$1" $2 && frame "$work/p" "$1" $2 --photons "$work/p.photons" || { bad "$1: exit $?"; return; }
  python3 -c 'import sys
path, chain = map(float, sys.argv[1:])
print(f"mean {path:.5f} by paths, {chain:.5f} by the chain: {100 * (chain / path - 1):+.2f} %")
sys.exit(not abs(chain / path - 1) < 0.015)' "$(mean "$work/path.exr")" "$(mean "$work/p.exr")" || bad "$1: means differ by more than 1.5 %"
}
if [ -n "$3" ]; then compare "$2" "--environment $3"; else echo 'skipped: no scene and map of your own given'; fi
compare "$yard" "$sky"

# A file made with another environment, or with none, is stale.
for other in "$sky --environment-strength 2" "$sky --environment-rotation 45" "--environment 1"; do
  "$bin/frame-render" "$yard" $other --photons "$work/p.photons" --size 8x8 -o "$work/x.exr" 2> "$work/stderr"
  [ $? = 2 ] && grep -q 'another state of the scene: lights differ' "$work/stderr" || bad "$other: $(cat "$work/stderr")"
done
"$bin/photon-trace" "$yard" --photons 1k -o "$work/x.photons" 2> "$work/stderr"
[ $? = 2 ] && grep -q -e --environment "$work/stderr" || bad "without a light: $(cat "$work/stderr")"

# The plan names the environment and depends on it; of the hashes only that of the lights changes with it.
"$bin/scene-plan" "$yard" $sky -q -o "$work/plan" || bad "scene-plan: exit $?"
grep -q '"environment": "sky.hdr"' "$work/plan/plan.json" || bad 'plan.json does not name the environment'
grep -q 'sky.hdr$' "$work/plan/state/inputs" || bad 'the plan does not depend on the environment'
hashes() { python3 -c 'import json, sys; s = json.load(open(sys.argv[1]))["segments"][0]; print(s["frames"][0]["hashes"]["lights"] if sys.argv[2] == "lights" else s["hashes"][sys.argv[2]])' "$work/plan/plan.json" $1; }
before=$(hashes lights) static=$(hashes static_geometry)
"$bin/scene-plan" "$yard" $sky --environment-strength 2 -q -o "$work/plan" || bad "scene-plan: exit $?"
[ "$(hashes lights)" != "$before" ] || bad 'twice the strength, the same lights'
[ "$(hashes static_geometry)" = "$static" ] || bad 'twice the strength, another geometry'
for goal in '-s plan' '-n demo'; do
  make $goal -f Makefile.example BIN="$bin" SCENE="$yard" ENVIRONMENT="$work/sky.hdr" FRAMES=0 OUT="$work/out" > "$work/make.txt" 2>&1
done
grep -q 'frame-render .*--environment "$ENVIRONMENT"' "$work/make.txt" || bad "make does not pass ENVIRONMENT on: $(tail -3 "$work/make.txt")"

# The same bytes for any number of threads.
for threads in 1 3; do
  "$bin/photon-trace" "$yard" $sky -q --photons 20k --threads $threads -o "$work/$threads.photons" || bad "photon-trace: exit $?"
  "$bin/frame-render" "$yard" $sky -q --size 32x18 --spp 4 --threads $threads -o "$work/$threads.exr" || bad "frame-render: exit $?"
done
cmp "$work/1.photons" "$work/3.photons" || bad 'photons differ between 1 and 3 threads'
cmp "$work/1.exr" "$work/3.exr" || bad 'frames differ between 1 and 3 threads'
[ $failed = 0 ] && echo ok
exit $failed
