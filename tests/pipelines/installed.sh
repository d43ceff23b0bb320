#!/bin/sh
# The installed files are sufficient: the pipeline renders two frames with them.
#
#     sh tests/pipelines/installed.sh BUILD          from the top of the tree
build=$(cd "$1" && pwd)
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
bad() { echo "$*"; exit 1; }
cmake --build "$build" --target manual > "$scratch/log" 2>&1 || bad "$(tail -3 "$scratch/log")"
cmake --install "$build" --prefix "$scratch/usr" > "$scratch/log" 2>&1 || bad "$(tail -3 "$scratch/log")"
for path in "$build"/bin/*; do
  tool=$(basename "$path")
  [ -x "$scratch/usr/bin/$tool" ] || bad "$tool is not installed"
  [ -s "$scratch/usr/share/man/man1/$tool.1" ] || bad "$tool has no man page"
  [ -s "$scratch/usr/share/bash-completion/completions/$tool" ] || bad "$tool has no completion"
done
[ -s "$scratch/usr/share/doc/tempolux/formats/photons/photons.md" ] || bad 'the format pages are not installed'
# The README's command, in a folder without sources.
scene=$PWD/pipelines/scenes/S2_cornell_moving.glb
(cd "$scratch" && make -s -f usr/share/doc/tempolux/Makefile.example SCENE="$scene" BIN="$scratch/usr/bin" OUT=out FRAMES=0,40 SIZE=32x18 QUALITY=draft \
  PHOTONS=2k POINTS='--point-count 500' > "$scratch/log" 2>&1) || bad "$(tail -5 "$scratch/log")"
[ -s "$scratch/out/sheet.png" ] && [ -s "$scratch/out/frames/0040.exr" ] || bad 'no frames were made'
# A module reads images. It must be found where it is installed; without it the message must name it.
trace() { "$scratch/usr/bin/photon-trace" pipelines/scenes/S1_cornell.glb --environment "$scratch/out/frames/0040.exr" \
  --photons 100 -q -o "$scratch/p.photons" 2> "$scratch/log"; }
trace || bad "environment: $(cat "$scratch/log")"
find "$scratch/usr" -name tempolux-images.so -exec rm {} +
trace
[ $? = 2 ] && [ "$(wc -l < "$scratch/log")" = 1 ] &&
  grep -q 'tempolux-images.so, which was not .*; install all of tempolux together, or copy its folder' "$scratch/log" ||
  bad "without its module: $(cat "$scratch/log")"
# The same holds for the program that unpacks geometry and WebP; a scene without packed data does not need it.
unpack() { "$scratch/usr/bin/photon-trace" "$1" --environment 1,1,1 --photons 100 -q -o "$scratch/p.photons" 2> "$scratch/log"; }
unpack tests/data/packed/scenes/draco-lossless.glb || bad "packed: $(cat "$scratch/log")"
find "$scratch/usr" -name tempolux-decode -exec rm {} +
unpack pipelines/scenes/S1_cornell.glb || bad "plain, without the helper: $(cat "$scratch/log")"
unpack tests/data/packed/scenes/draco-lossless.glb
[ $? = 2 ] && [ "$(wc -l < "$scratch/log")" = 1 ] &&
  grep -q 'unpacking needs tempolux-decode, which was not .*; install all of tempolux together' "$scratch/log" ||
  bad "packed, without the helper: $(cat "$scratch/log")"
echo 'installed, and rendered two frames'
