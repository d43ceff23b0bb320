#!/bin/sh
# METHOD=preview on the room whose box slides: sh tests/pipelines/preview.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Frames equal those of METHOD=frames except for noise and
# blur. A second run makes nothing. One processor makes the same frames. A frame made alone equals that of the range. A
# segment whose light does not change has one map and one window. Smoke is refused.
bin=$1 failed=0 scene=pipelines/scenes/S2_cornell_moving.glb
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
edit() { python3 -B tests/pipelines/edit_gltf.py "$@" || exit 1; }
make_it() {
  make V=1 -f Makefile.example --no-print-directory "${goal:-demo}" BIN="$bin" FRAMES=0-5 TIME='--segment 6' SIZE=48x27 PIXELS='--spp 2 --pixel-error 0' \
    CHANNELS=RGBA,layers "$@"
}
run() { make_it "$@" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }; }
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr | sed "s|$1/||"; }
files() { ls "$1/$2" 2> /dev/null | grep -c "[.]$3\$"; }

run V= SCENE=$scene METHOD=preview PHOTONS=10k OUT="$work/preview"
grep -q 'to run .*indirect light by light textures$' "$work/log" || bad "make says: $(head -1 "$work/log")"
[ "$(files "$work/preview" counts meshirrad) $(files "$work/preview" windows meshirrad) $(files "$work/preview" cache irradcache)" = '6 6 0' ] ||
  bad 'not six counts, six windows and no record'
run SCENE=$scene INDIRECT=records PHOTONS=100k POINTS='--point-count 1k' CACHE='--rays 50 --error-bound 0.5' OUT="$work/frames"
"$bin/aqm-compare" "$work/preview/frames/%04d.exr" "$work/frames/frames/%04d.exr" --frames 0-5 --layer indirect --json "$work/c.json" -q > /dev/null
# Six frames of 10 000 paths make 60 000. Kernels of up to 2500 photons blur light over half a metre: 14 % of error at
# edges of light. The mean is right within 1.5 %.
python3 -c 'import json, sys; t = json.load(open(sys.argv[1]))["total"]; e = t["rmse"] / t["mean_reference"], t["bias"]; print(e); sys.exit(e[0] > 0.2 or abs(e[1]) > 0.03)' "$work/c.json" ||
  bad 'differs from METHOD=frames by more than 20 %, or its mean by more than 3 %'
digests "$work/preview" > "$work/expected"

run SCENE=$scene METHOD=preview PHOTONS=10k OUT="$work/preview"
grep -q 'Nothing to be done' "$work/log" || bad "a second run: $(head -3 "$work/log")"
run SCENE=$scene METHOD=preview PHOTONS=10k OUT="$work/alone" FRAMES=4
digests "$work/alone" | diff - "$work/expected" | grep '^<' && bad 'frame 4 alone is another one'
run SCENE=$scene METHOD=preview PHOTONS=10k OUT="$work/one" -j1 RUN='taskset -c 0'
digests "$work/one" | diff "$work/expected" - || bad 'one processor, one job: other frames'

# Only the camera moves: one map of 33 times as many paths serves all frames.
edit $scene "$work/still.glb" still
edit "$work/still.glb" "$work/walk.glb" camera-from 2
run SCENE="$work/walk.glb" METHOD=preview PHOTONS=1k OUT="$work/walk"
[ "$(files "$work/walk" photons photons) $(files "$work/walk" textures meshirrad) $(files "$work/walk" windows meshirrad)" = '1 0 1' ] || bad 'a walk: not one map and one window'
paths=$(sed -n 's/.*--photons \([0-9]*\) .*/\1/p' "$work/walk/plan.mk")
[ "$((paths % 33))" = 0 ] && [ "$paths" -ge 33000 ] || bad "a walk: not 33 times as many paths, $paths"

# The number of photons by what a viewer sees: all tried numbers are written, one is chosen, and the plan names it. The
# two renderings have different random numbers; otherwise no difference would be visible.
goal=measure
run SCENE=$scene METHOD=preview OUT="$work/measured" AQM=0%
python3 - "$work/measured/measured.json" << 'END' || bad "measured.json: $(cat "$work/measured/measured.json")"
import json, sys
(segment,) = json.load(open(sys.argv[1]))["segments"]
tried = segment["tried"]
assert segment["first"] == 0 and len(tried) >= 1 and tried[0]["photons"] == 3125, segment
assert all(b["photons"] == 2 * a["photons"] for a, b in zip(tried, tried[1:])) and all(0 <= t["aqm"] <= 1 for t in tried), tried
assert tried[0]["aqm"] > 0, tried
END
run SCENE=$scene FRAMES=5 OUT="$work/one" && grep -q '"frame": 5' "$work/one/measured.json" || bad "not the wished frame is measured: $(cat "$work/one/measured.json")"
goal=plan
echo '{"format": "tempolux measured", "version": "1.0", "segments": [{"first": 0, "frame": 2, "tried": [{"photons": 1000, "aqm": 0.3}, {"photons": 2000, "aqm": 0.1}, {"photons": 4000, "aqm": 0.05}]}]}' > "$work/measured.json"
for case in '20% 2000 10' '1% 4000 5'; do
  set -- $case
  run SCENE=$scene METHOD=preview OUT="$work/measured" AQM="$1" MEASURED="$work/measured.json"
  grep -q "measured: AQM $3 % with $2 photons a frame" "$work/measured/plan.json" || bad "AQM=$1 does not choose $2 photons: $(grep measured: "$work/measured/plan.json")"
done
make_it SCENE=$scene METHOD=frames OUT="$work/measured" MEASURED="$work/measured.json" > "$work/log" 2>&1 && bad 'MEASURED without METHOD=preview is taken'
exit $failed
