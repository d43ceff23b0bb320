#!/bin/sh
# A file without a camera, packed by Draco, goes through the whole chain: every tool that looks through a camera says where it
# put one, and all say the same. Run at the top of the tree: sh tests/pipelines/content_camera.sh BIN
bin=$1
unset MAKEFLAGS MFLAGS MAKELEVEL  # of the make that runs the tests: the one below is no part of it
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "$*"; cat "$work/log"; exit 1; }
run() { make -s -f Makefile.example demo BIN="$bin" OUT="$work/out" SCENE=tests/data/packed/scenes/draco-lossless.glb FRAMES=0 SIZE=32x18 \
  QUALITY=draft PHOTONS=2k POINTS='--point-count 200' TIME='--environment-color 1,1,1' > "$work/log" 2>&1; }
run || bad 'the chain does not run'
[ -s "$work/out/frames/0000.exr" ] || bad 'no frame was made'
for tool in scene-plan irradcache-build frame-render; do
  [ -e "$work/out/cache/0000.irradcache" ] || [ $tool != irradcache-build ] || continue  # where paths do without
  grep -q "^$tool: .*no camera: --camera auto looks at" "$work/log" || bad "$tool does not say where it looks from"
done
[ "$(grep 'no camera' "$work/log" | sed 's/^[^:]*: //' | sort -u | wc -l)" = 1 ] || bad 'the tools do not agree'
"$bin/tempolux-info" "$work/out/frames/0000.exr" > "$work/log" || bad 'its frame cannot be read'
run || bad 'the chain does not run twice'
grep -q . "$work/log" && bad 'something was made again'
echo 'one camera for all tools'
