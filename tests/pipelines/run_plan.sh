#!/bin/sh
# A plan without make: sh tests/pipelines/run_plan.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. pipelines/examples/run_plan.py makes the files that make
# makes: the same names, the same digests, with one process and with four. A plan.json that lacks a file is refused; one
# that lacks an argument makes other files, so this comparison sees it.
bin=$1 failed=0 run=pipelines/examples/run_plan.py
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
unset MAKEFLAGS MFLAGS MAKELEVEL
bad() { echo "FAILED: $*"; failed=1; }
data() {
  find . -name '*.photons' -o -name '*.paths' -o -name '*.irrad*' -o -name '*.radsamples' -o -name '*.meshirrad' \
    -o -name '*.exr' | grep -v '^./raw/' | sort
}
digests() { (cd "$1" && data | xargs "$bin/tempolux-info" --digest); }
makes() {
  make -s -f Makefile.example BIN="$bin" SIZE=32x18 PHOTONS=4k CACHE='--rays 20 --error-bound 1' "$@" \
    > "$work/log" 2>&1 ||
    { cat "$work/log"; exit 1; }
}
# same NAME VARIABLE...: make, and run_plan.py with one process and with four
same() {
  name=$1; shift
  makes "$@" OUT="$work/$name"
  digests "$work/$name" > "$work/expected"
  [ "$(wc -l < "$work/expected")" -gt 2 ] || bad "$name: make has made $(cat "$work/expected")"
  for jobs in 1 4; do
    makes plan "$@" OUT="$work/$name-$jobs"
    python3 -B $run "$work/$name-$jobs" --jobs $jobs --bin "$bin" || bad "$name: $jobs processes"
    digests "$work/$name-$jobs" | diff "$work/expected" - || bad "$name: $jobs processes make other files than make"
  done
}
S1=pipelines/scenes/S1_cornell.glb S2=pipelines/scenes/S2_cornell_moving.glb
few='--point-count 1k' pixels='--spp 2 --pixel-error 0'
same time SCENE=$S2 FRAMES=4-6 INDIRECT=records MOVING=time POINTS="$few" PIXELS="$pixels" FILTER=3
same records SCENE=$S2 FRAMES=4-5 INDIRECT=records MOVING=records POINTS="$few" PIXELS="$pixels" CHANNELS=RGBA,Z,motion
same split SCENE=pipelines/scenes/S3_indirect_room.glb FRAMES=0 INDIRECT=records SPLIT=on POINTS="$few" \
  TIME='--fps 12 --segment 4' SKY=.1,.2,.3
same preview SCENE=$S2 FRAMES=0-1 METHOD=preview
# Names with a quote, a blank, a line feed and a byte that is no UTF-8.
odd=$work/$(printf "it's a\nroom \377")
mkdir "$odd" && cp $S1 "$odd/S 1.glb"
same names SCENE="$odd/S 1.glb" FRAMES=0 INDIRECT=records POINTS="$few" LIGHT_UNITS=spec CAMERA=Camera
if [ -x "$bin/../tests/make-vdb" ]; then   # names of volumes hold no line feed
  smoky="$work/it's smoke"
  mkdir "$smoky"
  python3 -c '
import struct, sys
sys.stdout.buffer.write(struct.pack("<4096f", *(float(i % 7) for i in range(4096))))' |
    "$bin/../tests/make-vdb" "$smoky/smoke_0000.vdb" 16 16 16 .06 -.45 .5 -.45 || bad 'no smoke'
  same smoke SCENE=$S1 FRAMES=0 INDIRECT=records POINTS="$few" PIXELS="$pixels" VOLUME="$smoky/smoke_####.vdb" REFINE=5% \
    VOLUME_OPTIONS='--volume-frames 0-0 --sigma-t 2 --albedo .8,.7,.6 --phase-g -.2'
fi
# scene-plan typed by hand, with relative names.
(cd "$odd" && "$bin/scene-plan" 'S 1.glb' -o plan --size 16x9 --photons 2k --indirect paths -q) ||
  bad 'scene-plan with relative names'
python3 -B $run "$odd/plan" --bin "$bin" && [ -f "$odd/plan/frames/0000.exr" ] || bad 'relative names'

# Each file and each argument counts.
out=$work/time-1
cp "$out/plan.json" "$work/whole.json"
digests "$work/time" > "$work/expected"
edited() {   # edited PYTHON: runs the plan from the beginning, after this change of the list `files`
  find "$out" -mindepth 2 -type f ! -path "$out/state/*" -delete
  python3 -c 'import json, sys
plan = json.load(open(sys.argv[1])); files = plan["files"]; exec(sys.argv[3])
json.dump(plan, open(sys.argv[2], "w"))' \
    "$work/whole.json" "$out/plan.json" "$1"
  python3 -B $run "$out" --jobs 2 --bin "$bin" > "$work/said" 2>&1
}
as_expected() { digests "$out" 2> /dev/null | diff "$work/expected" - > "$work/differences"; }
edited '' && as_expected || bad "the whole plan, once more: $(cat "$work/said" "$work/differences")"
edited 'del files[0]' && bad 'a plan without the first file is accepted'
grep -q 'no command makes stands/' "$work/said" || bad "a plan without the first file: $(cat "$work/said")"
edited 'files[0]["inputs"] += ["raw/none.exr"]' && bad 'an input that no command makes is accepted'
for word in --map --previous --rays --channels; do
  edited "e = [e for e in files if '$word' in e['argv']][0]; i = e['argv'].index('$word'); del e['argv'][i:i + 2]" &&
    as_expected && bad "without $word the files are the same"
done
[ $failed = 0 ] && echo ok
exit $failed
