#!/bin/sh
# MOVING=light and records on the room whose box slides: sh tests/pipelines/dynamic.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Frames equal those of MOVING=anew except for noise, and
# their direct light to the bit. A second run makes nothing. One processor makes the same frames. A moved camera traces
# no photon. If nothing moves, none of these stages runs.
bin=$1 failed=0 scene=pipelines/scenes/S2_cornell_moving.glb
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
edit() { python3 -B tests/pipelines/edit_gltf.py "$@" || exit 1; }
run() {
  make V=1 -f Makefile.example --no-print-directory demo BIN="$bin" FRAMES=0-3 INDIRECT=records SIZE=48x27 PHOTONS=10k POINTS='--point-count 1k' \
    CACHE='--rays 50 --error-bound 0.5' PIXELS='--spp 2 --pixel-error 0' CHANNELS=RGBA,layers "$@" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
}
planned() { python3 -B tests/pipelines/planned.py "$@"; }
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr | sed "s|$1/||"; }
# same NAME LAYER LIMIT: RMSE of the layer of four frames between NAME and anew, over the layer's mean
same() {
  "$bin/aqm-compare" "$work/$1/frames/%04d.exr" "$work/${1%-*}-anew/frames/%04d.exr" --frames 0-3 --layer "$2" --json "$work/c.json" -q > /dev/null
  python3 -c 'import json, sys; t = json.load(open(sys.argv[1]))["total"]; e = t["rmse"] / max(t["mean_reference"], 1e-9); print(e); sys.exit(e > float(sys.argv[2]))' \
    "$work/c.json" "$3" || bad "$1: $2 differs from MOVING=anew by more than $3 of its mean"
}

edit $scene "$work/mirror.glb" mirror
edit $scene "$work/still.glb" still
for name in box mirror; do
  case $name in box) file=$scene;; *) file=$work/mirror.glb;; esac
  for moving in anew light records; do run SCENE="$file" MOVING=$moving OUT="$work/$name-$moving"; done
  for moving in light records; do
    [ "$(planned "$work/$name-$moving" moving)" = $moving ] || bad "the plan does not say $moving"
    [ "$("$bin/tempolux-info" --json "$work/$name-$moving/moved/0002-"*.photons | grep -c '"map": "dynamic"')" = 1 ] || bad "$name: no dynamic map"
    same $name-$moving direct 1e-6
    # 10 000 paths and 50 rays a record: two seeds of MOVING=anew differ by 4 %.
    same $name-$moving indirect 0.08
    # Caustic photons are those of the global map in another order, so sums in float32 differ.
    # Caustic photons are those of the global map in another order. Their numbers there choose the probes of footprints.
    [ $name = box ] || same $name-$moving caustic 0.12
  done
done

run SCENE=$scene MOVING=records OUT="$work/box-records"
grep -q 'Nothing to be done' "$work/log" || bad "a second run: $(head -3 "$work/log")"
digests "$work/box-records" > "$work/expected"
run SCENE=$scene MOVING=records OUT="$work/one" -j1 RUN='taskset -c 0'
digests "$work/one" | diff "$work/expected" - || bad 'one processor, one job: other frames'

# A camera that moves sees the same light.
edit $scene "$work/walk.glb" camera-from 2
cp $scene "$work/scene.glb"
run SCENE="$work/scene.glb" MOVING=records OUT="$work/scene"
cp "$work/walk.glb" "$work/scene.glb"
run SCENE="$work/scene.glb" MOVING=records OUT="$work/scene"
grep -qE 'photon-trace|irradcache-build points' "$work/log" && bad 'the camera moved: light was computed again'
grep -q 'frame-render .*--frame 2 ' "$work/log" || bad 'the camera moved: its frame was not rendered'

run SCENE="$work/still.glb" MOVING=auto OUT="$work/still"
[ "$(planned "$work/still" moving)" = anew ] || bad 'nothing moves, and the plan has it follow'
grep -q '^stands' "$work/still/plan.mk" && bad 'nothing moves: plan.mk names what stands'
ls "$work/still/stands" > /dev/null 2>&1 && bad 'nothing moves: a folder for what stands'
[ $failed = 0 ] && echo ok
exit $failed
