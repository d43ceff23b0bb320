#!/bin/sh
# MOVING=time on the room whose box slides: sh tests/pipelines/temporal.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Frames equal those of MOVING=anew except for noise. A
# second run makes nothing. One processor makes the same frames. After an edit of one frame the frames of its segment
# are made again, and no others. A run that was killed and started again makes the same frames. A frame made alone
# equals that of the range. If nothing moves, none of these stages runs.
bin=$1 failed=0 scene=pipelines/scenes/S2_cornell_moving.glb
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
edit() { python3 -B tests/pipelines/edit_gltf.py "$@" || exit 1; }
planned() { python3 -B tests/pipelines/planned.py "$@"; }
make_it() {
  make V=1 -f Makefile.example --no-print-directory demo BIN="$bin" FRAMES=0-7 TIME='--segment 4' INDIRECT=records SIZE=48x27 PHOTONS=10k POINTS='--point-count 1k' \
    CACHE='--rays 50 --error-bound 0.5' PIXELS='--spp 2 --pixel-error 0' CHANNELS=RGBA,layers "$@"
}
run() { make_it "$@" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }; }
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr | sed "s|$1/||"; }
# Two jobs may print their commands on one line.
gathered() { sed 's/gather-temporal final /\n&/g' "$work/log" | grep -o 'gather-temporal final .*--frame [0-7] ' | sed 's/.*\([0-7]\) $/000\1/' | tr '\n' ' '; }

cp $scene "$work/scene.glb"
run SCENE="$work/scene.glb" MOVING=anew OUT="$work/anew"
run SCENE="$work/scene.glb" MOVING=time OUT="$work/time"
[ "$(planned "$work/time" moving)" = time ] || bad 'the plan does not say time'
[ "$(gathered | tr ' ' '\n' | sort | tr -d '\n')" = 00000001000200030004000500060007 ] || bad "gathered over time: $(gathered)"
grep -q 'final .*--frame 4 .*--previous' "$work/log" && bad 'the second segment follows from the first'
"$bin/aqm-compare" "$work/time/frames/%04d.exr" "$work/anew/frames/%04d.exr" --frames 0-7 --layer indirect --json "$work/c.json" -q > /dev/null
# 10 000 paths and 50 rays a record: two seeds of MOVING=anew differ by 4 %.
python3 -c 'import json, sys; t = json.load(open(sys.argv[1]))["total"]; e = t["rmse"] / t["mean_reference"]; print(e); sys.exit(e > 0.08)' "$work/c.json" ||
  bad 'differs from MOVING=anew by more than 8 %'
digests "$work/time" > "$work/expected"

run SCENE="$work/scene.glb" MOVING=time OUT="$work/time"
grep -q 'Nothing to be done' "$work/log" || bad "a second run: $(head -3 "$work/log")"
run SCENE="$work/scene.glb" MOVING=time OUT="$work/alone" FRAMES=6
digests "$work/alone" | diff - "$work/expected" | grep '^<' && bad 'frame 6 alone is another one'
run SCENE="$work/scene.glb" MOVING=time OUT="$work/one" -j1 RUN='taskset -c 0'
digests "$work/one" | diff "$work/expected" - || bad 'one processor, one job: other frames'

# Killed while records are made, and started again.
make_it SCENE="$work/scene.glb" MOVING=time OUT="$work/killed" > "$work/log" 2>&1 &
for i in $(seq 200); do ls "$work"/killed/kept/0001-*.radsamples > /dev/null 2>&1 && break; sleep 0.05; done
kill -9 $! 2>/dev/null
wait $! 2>/dev/null
sleep 0.5
run SCENE="$work/scene.glb" MOVING=time OUT="$work/killed"
digests "$work/killed" | diff "$work/expected" - || bad 'killed and typed again: other frames'

# A walkthrough: make follows a segment from any of its frames.
run SCENE="$work/scene.glb" MOVING=time OUT="$work/walk" METHOD=walkthrough

# The box moves differently at frame 1: the frames of its segment are made again, those of the other segment are not.
edit $scene "$work/scene.glb" nudge 1
run SCENE="$work/scene.glb" MOVING=time OUT="$work/time"
case "$(gathered)" in *000[4-7]*) bad "an edit at frame 1 gathered $(gathered)";; *0001*) ;; *) bad "an edit at frame 1 gathered $(gathered)";; esac

# With divided bright points samples hold the low part (pipelines/split.md).
run SCENE=$scene MOVING=time SPLIT=on OUT="$work/both"
grep -q 'gather-temporal final .*--points split/0002-.*.low.irradpoints --high split/0002-.*.high.irradpoints --previous' "$work/log" || bad "SPLIT=on: $(grep -m1 gather-temporal "$work/log")"
grep -q 'irradcache-build records' "$work/log" && bad 'SPLIT=on: records are made anew, too'
"$bin/aqm-compare" "$work/both/frames/%04d.exr" "$work/anew/frames/%04d.exr" --frames 0-7 --layer indirect --json "$work/c.json" -q > /dev/null
python3 -c 'import json, sys; t = json.load(open(sys.argv[1]))["total"]; e = t["rmse"] / t["mean_reference"]; print(e, t["bias"]); sys.exit(e > 0.08)' "$work/c.json" ||
  bad 'SPLIT=on: differs from MOVING=anew by more than 8 %'
run SCENE=$scene MOVING=time SPLIT=on OUT="$work/both"
grep -q 'Nothing to be done' "$work/log" || bad "SPLIT=on, a second run: $(head -3 "$work/log")"

edit $scene "$work/still.glb" still
run SCENE="$work/still.glb" MOVING=auto OUT="$work/still"
ls "$work/still/kept" > /dev/null 2>&1 && bad 'nothing moves: a folder for what is kept'
[ $failed = 0 ] && echo ok
exit $failed
