#!/bin/sh
# METHOD=still on the room whose box slides: sh tests/pipelines/still.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Most pixels are kept, and frames have the light of
# METHOD=frames. A frame made alone equals that of the range. One processor makes the same frames. Without a filter it
# works, too. Where the camera is another one, frames take no pixels from the middle. Files of another moment are
# refused.
bin=$1 failed=0 scene=pipelines/scenes/S2_cornell_moving.glb
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
run() {
  make V=1 -f Makefile.example --no-print-directory demo BIN="$bin" SIZE=64x36 PHOTONS=100k CHANNELS=RGBA,layers \
    SCENE=$scene "$@" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
}
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr | sed "s|$1/||"; }

run METHOD=still FRAMES=22-24 OUT="$work/still"
[ "$(ls "$work/still/still" | grep -c 'exr$')" = 1 ] || bad 'not one frame that gives the pixels that stay'
/usr/bin/env python3 - "$work"/still/raw/*.json << 'END' || bad 'not most pixels are kept'
import json, sys
shares = [json.load(open(name))["results"]["sampled_anew"] for name in sys.argv[1:]]
print("sampled anew:", shares)
sys.exit(len(shares) != 2 or max(shares) > 0.4)     # frame 23 is the middle of 0-47
END
run METHOD=frames FRAMES=22-24 OUT="$work/frames"
"$bin/aqm-compare" "$work/still/frames/%04d.exr" "$work/frames/frames/%04d.exr" --frames 22-24 --json "$work/c.json" -q \
  > /dev/null
# Two frames of independent noise of 1 code differ by 1 % of the mean, their means by a hundredth of that.
python3 -c 'import json, sys; t = json.load(open(sys.argv[1]))["total"]; e = t["rmse"] / t["mean_reference"], t["bias"]
print(e); sys.exit(e[0] > 0.08 or abs(e[1]) > 0.01)' "$work/c.json" || bad 'another light than METHOD=frames'
digests "$work/still" > "$work/expected"

run METHOD=still FRAMES=22 OUT="$work/alone"
digests "$work/alone" | diff - "$work/expected" | grep '^<' && bad 'frame 22 alone is another one'
run METHOD=still FRAMES=22-24 OUT="$work/one" -j1 RUN='taskset -c 0'
digests "$work/one" | diff "$work/expected" - || bad 'one processor, one job: other frames'
run METHOD=still FRAMES=22-23 FILTER=none OUT="$work/raw"
ls "$work"/raw/pictures/0022-*.exr "$work"/raw/pictures/0023-*.exr > /dev/null || bad 'no pictures without a filter'

python3 -B tests/pipelines/edit_gltf.py $scene "$work/pan.glb" camera-from 2 || exit 1
"$bin/scene-plan" "$work/pan.glb" --frames 0-3 --size 64x36 --method still -q -o "$work/pan" || exit 1
[ "$(sed -n 's/^raw\/\([0-9]*\).* --still .*/\1/p' "$work/pan/plan.mk" | tr '\n' ' ')" = '0002 0003 ' ] ||
  bad 'another camera: not frames 2 and 3 alone take pixels from the middle'

still=$(ls "$work"/still/still/*.exr) light=$(ls "$work"/still/cache/0022-*.irradcache)
"$bin/frame-render" $scene --frame 22 --size 64x36 --irradcache "$light" --still "$still" --still-frame 21 \
  --still-irradcache "$light" -o "$work/no.exr" -q 2> "$work/said" && bad 'a frame of another moment is taken'
grep -q 'frame' "$work/said" || bad "refused without a reason: $(cat "$work/said")"
"$bin/frame-render" $scene --frame 22 --size 64x36 --irradcache "$light" --still "$still" --still-frame 23 \
  -o "$work/no.exr" -q 2> "$work/said"
[ $? = 2 ] && grep -q -- '--still-' "$work/said" || bad "no word about the missing twin: $(cat "$work/said")"
for blur in '--f-stop 2 --focus 3' '--shutter 180'; do
  "$bin/frame-render" $scene --frame 22 --size 64x36 --irradcache "$light" --still "$still" --still-frame 23 $blur \
    --still-irradcache "$light" -o "$work/no.exr" -q 2> "$work/said"
  [ $? = 2 ] && grep -q 'blurs' "$work/said" || bad "$blur: $(cat "$work/said")"
done
[ ! -e "$work/no.exr" ] || bad 'a refused run left a file'
exit $failed
