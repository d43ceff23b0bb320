#!/bin/sh
# What make runs again after a change, and nothing else: sh tests/pipelines/rerun.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Compares the list of commands run.
bin=$1
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
log=$work/log scene=$work/scene.glb source=pipelines/scenes/S2_cornell_moving.glb failed=0

edit() { python3 tests/pipelines/edit_gltf.py "$@" || exit 1; }

# make_runs WHAT EXPECTED [VARIABLE=VALUE...]: runs the demo; the commands run, sorted, must be EXPECTED.
make_runs() {
  what=$1 expected=$2; shift 2
  : > "$log"
  if ! make -f Makefile.example --no-print-directory demo BIN="$bin" RUN="sh tests/pipelines/record.sh $log" \
      OUT="$work/out" SCENE="$scene" FRAMES=0-3 TIME='--segment 2' SIZE=32x18 PHOTONS=2k SAMPLES=1 PATHS=2 "$@" \
      > "$work/make.txt" 2>&1; then
    echo "FAILED: $what: make failed:"; cat "$work/make.txt"; exit 1
  fi
  sort "$log" > "$work/ran"
  for line in $expected; do echo "$line" | tr : ' '; done | sort > "$work/expected"
  if diff -u "$work/expected" "$work/ran" > "$work/diff"; then echo "ok: $what"; else
    echo "FAILED: $what: commands expected (-) and run (+):"; tail -n +3 "$work/diff"; failed=1
  fi
}

plan=scene-plan:plan
trace() { for f; do echo photon-trace:photons/$f.photons; done; }
photon() { for f; do echo frame-render:photon/$f.exr tempolux-info:photon/$f.png; done; }
path() { for f; do echo frame-render:path/$f.exr tempolux-info:path/$f.png; done; }
exposure=tempolux-info:stdout  # of the first frame of the reference; all pictures hang on it
sheet=tempolux-info:out/sheet.png

all='0000 0001 0002 0003'

cp "$source" "$scene"
make_runs 'the first run makes everything' "$plan $(trace $all) $(photon $all) $exposure $(path $all) $sheet"
make_runs 'nothing changed: nothing runs' ''
touch "$scene"
make_runs 'scene touched: only scene-plan' "$plan"
edit "$source" "$scene" same
make_runs 'scene exported again, equal in content: only scene-plan' "$plan"

edit "$source" "$scene" camera-from 2
make_runs 'camera edited from frame 2 on: no photons, frames 2 and 3' "$plan $(photon 0002 0003) $(path 0002 0003) $sheet"
cp "$source" "$scene"
make_runs 'camera put back: the same again' "$plan $(photon 0002 0003) $(path 0002 0003) $sheet"

make_runs 'options of the photon view: neither photons nor the reference' "$(photon $all) $sheet" SAMPLES=2
make_runs 'options of the reference: nothing else but pictures' "$exposure $(path $all) $(for f in $all; do echo tempolux-info:photon/$f.png; done) $sheet" SAMPLES=2 PATHS=4
make_runs 'more photons: no reference' "$(trace $all) $(photon $all) $sheet" SAMPLES=2 PATHS=4 PHOTONS=3k
make_runs 'fewer frames: no stage but the plan' "$plan $sheet" SAMPLES=2 PATHS=4 PHOTONS=3k FRAMES=0-2
make_runs 'and all of them again' "$plan $sheet" SAMPLES=2 PATHS=4 PHOTONS=3k

rm -r "$work/out"
edit "$source" "$scene" lamp
make_runs 'with a moving lamp' "$plan $(trace $all) $(photon $all) $exposure $(path $all) $sheet"
edit "$source" "$scene" lamp 3
make_runs 'lamp edited at frame 3: only what frame 3 shows' "$plan $(trace 0003) $(photon 0003) $(path 0003) $sheet"

rm -r "$work/out"
edit "$source" "$scene" still
make_runs 'a still scene: one photon map' "$plan $(trace 0000) $(photon $all) $exposure $(path $all) $sheet"
edit "$scene" "$work/walk.glb" camera-from 2 && mv "$work/walk.glb" "$scene"
make_runs 'the camera starts to move: still one, and untouched' "$plan $(photon 0002 0003) $(path 0002 0003) $sheet"
edit "$scene" "$work/bright.glb" emission 2 && mv "$work/bright.glb" "$scene"
make_runs 'a lamp made brighter: one photon map, all frames' "$plan $(trace 0000) $(photon $all) $exposure $(path $all) $sheet"

rm -r "$work/out"
edit "$source" "$work/scene.gltf" same
scene=$work/scene.gltf
make_runs 'a scene of two files' "$plan $(trace $all) $(photon $all) $exposure $(path $all) $sheet"
touch "$work/scene.bin"
make_runs 'its buffer touched: only scene-plan' "$plan"

exit $failed
