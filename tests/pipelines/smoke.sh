#!/bin/sh
# Smoke in the chain: sh tests/pipelines/smoke.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Eight frames of a rising ball in two segments, maps
# updated by 20 %. A second run makes nothing. 1, 2, 3 and 7 threads make the same frames. If the smoke of one frame is
# edited and stays below the segment's majorants, the maps and frames from there to the segment's end are made again; if
# it exceeds them, those of the whole segment. Those of the other segment are never made again.
bin=$1 failed=0 make_vdb=$1/../tests/make-vdb
[ -x "$make_vdb" ] || { echo 'built without volumes'; exit 77; }
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
# smoke FRAME LARGEST: writes the ball of a frame, with this density in its middle.
smoke() {
  rm -f "$work/smoke_000$1.vdb"
  python3 -c '
import math, struct, sys
frame, largest = int(sys.argv[1]), float(sys.argv[2])
ball = lambda *p: largest * max(0.0, 1 - math.dist(p, (7.5, 5 + 0.7 * frame, 7.5)) / 5)
sys.stdout.buffer.write(b"".join(struct.pack("<f", ball(x, y, z)) for x in range(16) for y in range(16) for z in range(16)))' "$1" "$2" |
    "$make_vdb" "$work/smoke_000$1.vdb" 16 16 16 .06 -.45 .5 -.45 || exit 3
}
run() {
  make V=1 -f Makefile.example --no-print-directory demo BIN="$bin" SCENE=pipelines/scenes/S1_cornell.glb FRAMES=0-7 TIME='--segment 4' INDIRECT=records SIZE=32x18 PHOTONS=20k \
    VOLUME="$work/smoke_####.vdb" VOLUME_OPTIONS='--sigma-t 6 --albedo .8' UPDATE=20% POINTS='--point-count 1k' CACHE='--rays 20 --error-bound 1' \
    PIXELS='--spp 1 --pixel-error 0' "$@" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
}
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr "$1"/photons/*.photons | sed "s|$1/||"; }
made() { grep -o "$1"' .*--frame [0-7] ' "$work/log" | grep -o '[0-7] $' | tr -d ' ' | sort -u | tr -d '\n'; }
expect_made() { [ "$(made photon-trace)" = "$2" ] && [ "$(made volume-compose)" = "$2" ] || bad "$1: maps $(made photon-trace), frames $(made volume-compose), expected $2"; }

for f in 0 1 2 3 4 5 6 7; do smoke $f 1; done
run OUT="$work/out"
expect_made 'the first run' 01234567
[ "$(grep -c 'photon-trace.*--update' "$work/log")" = 6 ] || bad 'not all but the first map of each segment are updates'
run OUT="$work/out"
grep -q 'Nothing to be done' "$work/log" || bad "a second run: $(head -3 "$work/log")"
digests "$work/out" > "$work/expected"
for threads in 1 2 3 7; do
  TEMPOLUX_THREADS=$threads run OUT="$work/t$threads"
  digests "$work/t$threads" | diff "$work/expected" - || bad "$threads threads: other files"
  rm -r "$work/t$threads"
done

smoke 2 .5
run OUT="$work/out"
expect_made 'frame 2 with less smoke' 23
smoke 2 2
run OUT="$work/out"
expect_made 'frame 2 with more smoke than its majorants allow' 0123
smoke 2 1
run OUT="$work/out"
expect_made 'and back: the files are there still' ''
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr | sed "s|$1/||"; }
grep frames/ "$work/expected" > "$work/frames"
digests "$work/out" | diff "$work/frames" - || bad 'and back: other frames'
[ $failed = 0 ] && echo ok
exit $failed
