#!/bin/sh
# Mattes through the chain: sh tests/pipelines/mattes.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Filtered frames, blurred ones, frames whose pixels stay
# and frames that are warped have mattes that a reader written from the page decodes and whose coverage adds up to
# alpha. A renamed node makes frames again and no light, and only where mattes are asked for.
bin=$1 failed=0 scene=pipelines/scenes/S2_cornell_moving.glb
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
export PYTHONDONTWRITEBYTECODE=1
bad() { echo "FAILED: $*"; failed=1; }
run() {
  make -f Makefile.example --no-print-directory demo BIN="$bin" SIZE=64x36 PHOTONS=50k SCENE=$scene "$@" > "$work/log" 2>&1 ||
    { cat "$work/log"; exit 1; }
}
good() {   # good FOLDER NAME: all of its frames have mattes, and this object is seen
  for frame in "$1"/frames/*.exr; do
    python3 tests/formats/read_mattes.py "$frame" --alpha 1e-6 > "$work/seen" 2>&1 || bad "$frame: $(tail -1 "$work/seen")"
    grep -q "CryptoObject .* $2\$" "$work/seen" || bad "$frame: $(cat "$work/seen")"
  done
}
mattes=CHANNELS=RGBA,cryptomatte
run METHOD=frames FRAMES=22-23 $mattes OUT="$work/frames" && good "$work/frames" MovingBox
run METHOD=frames FRAMES=22 SHUTTER=180 FSTOP=1 FOCUS=2 FILTER=3 $mattes OUT="$work/blurred" && good "$work/blurred" MovingBox
run METHOD=still FRAMES=22-24 $mattes OUT="$work/still" && good "$work/still" MovingBox
python3 -B pipelines/scenes/make_walkthrough.py pan pipelines/scenes/S3_indirect_room.glb "$work/pan.glb" || exit 1
run SCENE="$work/pan.glb" METHOD=walkthrough FRAMES=0-4 KEY_DISTANCE=4 $mattes OUT="$work/walk" && good "$work/walk" Suzanne
ls "$work"/walk/walked/*.warp.json > /dev/null || bad 'no frame was warped'
# Pixels that stay have the mattes of their own frame: those of frame 24 are not those of 23.
for frame in 0023 0024; do python3 tests/formats/read_mattes.py "$work/still/frames/$frame.exr" > "$work/$frame"; done
cmp -s "$work/0023" "$work/0024" && bad 'mattes of another frame'

python3 - $scene "$work/named.glb" << 'END' || exit 1
import sys
data = open(sys.argv[1], "rb").read()
assert b'"MovingBox"' in data
open(sys.argv[2], "wb").write(data.replace(b'"MovingBox"', b'"RenamedBx"'))   # as long, so that no size changes
END
made() { make -n -f Makefile.example --no-print-directory demo BIN="$bin" SIZE=64x36 PHOTONS=50k METHOD=frames FRAMES=22-23 \
  SCENE="$1" OUT="$work/frames" "$2" 2>&1 | grep -o 'frame-render\|photon-trace\|irradcache-build\|st-filter' | sort | uniq -c | tr -s ' \n' ' '; }
[ -z "$(made $scene $mattes)" ] || bad "a second run makes $(made $scene $mattes)"
[ "$(made "$work/named.glb" $mattes)" = ' 2 frame-render 2 st-filter ' ] || bad "a new name makes $(made "$work/named.glb" $mattes)"
run METHOD=frames FRAMES=22-23 CHANNELS=RGBA OUT="$work/frames"
[ -z "$(made "$work/named.glb" CHANNELS=RGBA)" ] || bad "without mattes a new name makes $(made "$work/named.glb" CHANNELS=RGBA)"
exit $failed
