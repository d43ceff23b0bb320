#!/bin/sh
# A file without a camera, packed by Draco, goes through the whole chain, and one line reports where the camera is put:
# sh tests/pipelines/content_camera.sh BIN. Run at the top of the tree.
bin=$1
unset MAKEFLAGS MFLAGS MAKELEVEL  # make below is independent of the make that runs the tests
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "$*"; cat "$work/log"; exit 1; }
run() { make -s -f Makefile.example demo BIN="$bin" OUT="$work/out" SCENE=tests/data/packed/scenes/draco-lossless.glb FRAMES=0 SIZE=32x18 \
  QUALITY=draft PHOTONS=2k POINTS='--point-count 200' TIME='--environment 1,1,1' > "$work/log" 2>&1; }
run || bad 'the chain does not run'
[ -s "$work/out/frames/0000.exr" ] || bad 'no frame was made'
grep -q '^scene-plan: .*no camera: --camera auto looks at' "$work/log" || bad 'nothing says where it looks from'
[ "$(grep -c 'no camera' "$work/log")" = 1 ] || bad 'it is said more than once'
"$bin/tempolux-info" "$work/out/frames/0000.exr" > "$work/log" || bad 'its frame cannot be read'
run || bad 'the chain does not run twice'
grep -qv 'no camera' "$work/log" && bad 'something was made again'
echo 'one camera for all tools'
