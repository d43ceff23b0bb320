#!/bin/sh
# After a change make runs the necessary commands and no others: sh tests/pipelines/rerun.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Compares the list of commands; scene-plan always runs.
export REPORT_CPU=1   # CPU seconds of the reference of own_scene.py
bin=$1
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
log=$work/log scene=$work/scene.glb source=pipelines/scenes/S2_cornell_moving.glb failed=0

edit() { python3 tests/pipelines/edit_gltf.py "$@" || exit 1; }

# make_runs WHAT EXPECTED [VARIABLE=VALUE...]: makes $target; the sorted list of commands must be EXPECTED.
target=demo segment=2
make_runs() {
  what=$1 expected=$2; shift 2
  : > "$log"
  if ! make -f Makefile.example --no-print-directory $target BIN="$bin" RUN="sh $PWD/tests/pipelines/record.sh $log" \
      OUT="$work/out" SCENE="$scene" FRAMES=0-3 TIME="--segment $segment" INDIRECT=records SIZE=32x18 PHOTONS=2k REFERENCE_SAMPLES=2 \
      POINTS='--point-count 1k' CACHE='--rays 20 --error-bound 1' PIXELS='--spp 1 --pixel-error 0' "$@" \
      > "$work/make.txt" 2>&1; then
    echo "FAILED: $what: make failed:"; cat "$work/make.txt"; exit 1
  fi
  sort "$log" > "$work/ran"
  for line in $expected; do echo "$line" | tr : ' '; done | sort > "$work/expected"
  if diff -u "$work/expected" "$work/ran" > "$work/diff"; then echo "ok: $what"; else
    echo "FAILED: $what: commands expected (-) and run (+):"; tail -n +3 "$work/diff"; failed=1
  fi
}

trace() { for f; do echo photon-trace:photons/$f.photons; done; }
points() { for f; do echo irradcache-build:points/$f.irradpoints; done; }
cache() { for f; do echo irradcache-build:cache/$f.irradcache; done; }
light() { trace "$@"; points "$@"; cache "$@"; }
frames() { for f; do echo frame-render:pictures/$f.exr tempolux-info:frames/$f.png; done; }
same() { for f; do echo tempolux-info:frames/$f.png; done; }
path() { for f; do echo frame-render:path/$f.exr aqm-compare:error/$f.json; done; }
exposure=tempolux-info:stdout  # of the first frame; all previews depend on it
sheet=tempolux-info:sheet.png

all='0000 0001 0002 0003'

cp "$source" "$scene"
began=$(date +%s.%N)
make_runs 'the first run makes everything' "$(light $all) $(frames $all) $exposure $sheet"
seconds=$(echo "$(date +%s.%N) $began" | awk '{ print $1 - $2 }')
target=timeline
make_runs 'who ran what when: nothing runs' ''
target=demo
python3 -B tests/pipelines/timeline.py "$work/out" "$seconds" > "$work/said" 2>&1 && echo "ok: timeline: $(cat "$work/said")" ||
  { echo "FAILED: timeline: $(cat "$work/said")"; failed=1; }
make_runs 'nothing changed: nothing runs' ''
touch "$scene"
make_runs 'scene touched: only scene-plan' ''
edit "$source" "$scene" same
make_runs 'scene exported again, equal in content: only scene-plan' ''

edit "$source" "$scene" camera-from 2
make_runs 'camera edited from frame 2 on: no photons, no points, frames 2 and 3' "$(cache 0002 0003) $(frames 0002 0003) $sheet"
cp "$source" "$scene"
dead=$(sh -c 'echo $$')
: > "$work/out/points/.0000-left.json.tmp.$(uname -n).$dead"   # by a tool that was killed after its picture was there
make_runs 'camera put back: what was made before is shown again' "$(same 0002 0003) $sheet"
[ -z "$(find "$work/out" -name '.*.tmp.*')" ] || { echo "FAILED: left: $(find "$work/out" -name '.*.tmp.*')"; failed=1; }
grep -q 'brightness steps.*look at' "$work/make.txt" || { echo 'FAILED: frames shown again: not said'; failed=1; }

make_runs 'an exposure: previews alone' "$(same $all) $sheet" EXPOSURE=1.5
"$bin/tempolux-info" --png "$work/stops.png" --exposure 1.5 "$work/out/frames/0002.exr" && cmp -s "$work/stops.png" "$work/out/frames/0002.png" ||
  { echo 'FAILED: the preview has another exposure'; failed=1; }
make_runs 'and the exposure that suits again' "$(same $all) $sheet"

rm "$work/out/photons/0000-"*.photons "$work/out/cache/0001-"*.irradcache "$work/out/frames/0002.exr" "$work/out/frames/0003.png"
make_runs 'files deleted: they come back, nothing else' "$(trace 0000) $(cache 0001) tempolux-info:frames/0003.png"
[ -s "$work/out/frames/0002.exr" ] || { echo 'FAILED: a frame deleted is not back'; failed=1; }

again="$(frames $all) $exposure $sheet"
make_runs 'options of the pixels: nothing before them' "$again" PIXELS='--spp 2 --pixel-error 0'
make_runs 'options of the records: neither photons nor points' "$(cache $all) $again" CACHE='--rays 25'
make_runs 'options of the points: no photons' "$(points $all) $(cache $all) $again" POINTS='--point-count 2k'
make_runs 'options of the photons: all but the plan' "$(light $all) $again" PHOTONS=3k
make_runs 'and all of them back: photons and points are there still' "$(cache $all) $(frames $all) $sheet"
make_runs 'fewer frames: no stage but the plan' "$sheet" FRAMES=0-2
make_runs 'and all of them again' "$sheet"

target=report
make_runs 'a report: path tracing of two frames' "$(path 0000 0003) error-report:report"
make_runs 'options of the reference: nothing else' "$(path 0000 0003) error-report:report" REFERENCE_SAMPLES=4
make_runs 'one frame more: that frame' "$(path 0001) error-report:report" REFERENCE_SAMPLES=4 REPORT_FRAMES='0000 0001 0003'
target=demo

rm -r "$work/out"
edit "$source" "$scene" lamp
six="$all 0004 0005"  # three segments of two frames
make_runs 'with a moving lamp' "$(light $six) $(frames $six) $exposure $sheet" FRAMES=0-5
edit "$source" "$scene" lamp 3
make_runs 'lamp edited at frame 3: nothing before it, nothing after its segment' "$(light 0003) $(frames 0003) $sheet" FRAMES=0-5

rm -r "$work/out"
segment=4
edit "$source" "$scene" still
make_runs 'nothing moves: one of everything, its frame copied' "$(light 0000) $(frames 0000) $(same 0001 0002 0003) $exposure $sheet"
edit "$scene" "$work/walk.glb" camera-from 2 && mv "$work/walk.glb" "$scene"
# The records of the second place do not reach the first one's picture: it is made again with equal content, and previews
# of equal frames are not drawn again.
make_runs 'the camera starts to move: no light, one cache for both places' \
  "$(cache 0000) frame-render:pictures/0000.exr $(frames 0002) $(same 0003) $exposure $sheet"
placed=$("$bin/tempolux-info" --json "$work/out/$(python3 -B tests/pipelines/planned.py "$work/out" name cache 0000)" | tr -d ' \n' | sed 's/.*"placed_frames":\(\[[][0-9,]*\]\),.*/\1/')
[ "$placed" = '[[0,0],[2,2]]' ] || { echo "FAILED: the cache was placed for frames $placed"; failed=1; }
edit "$scene" "$work/bright.glb" emission 2 && mv "$work/bright.glb" "$scene"
make_runs 'a lamp made brighter: one of everything that light is made of' \
  "$(light 0000) $(frames 0000 0002) $(same 0001 0003) $exposure $sheet"

rm -r "$work/out"
segment=2
edit "$source" "$work/scene.gltf" same
scene=$work/scene.gltf
make_runs 'a scene of two files' "$(light $all) $(frames $all) $exposure $sheet"
touch "$work/scene.bin"
make_runs 'its buffer touched: only scene-plan' ''

exit $failed
