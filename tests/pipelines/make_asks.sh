#!/bin/sh
# Makefile.example with make -n and with invalid requests: sh tests/pipelines/make_asks.sh BIN
# Run at the top of the tree; BIN is the folder with the tools.
export REPORT_CPU=1   # CPU seconds of the reference of own_scene.py
bin=$1 top=$PWD
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
failed=0
bad() { echo "FAILED: $*"; cat "$work/said"; failed=1; }
make_() { make --no-print-directory -f "$top/Makefile.example" "$@" > "$work/said" 2>&1; }
says() { grep -q -e "$1" "$work/said"; }
demo() { goal=$1; shift; make_ "$goal" BIN="$bin" OUT="$work/out" FRAMES=0,30 SIZE=32x18 PHOTONS=2k \
  REFERENCE_SAMPLES=2 INDIRECT=records POINTS='--point-count 1k' CACHE='--rays 20 --error-bound 1' \
  PIXELS='--spp 1' "$@"; }

# Before anything is built: -n lists the first commands and leaves no file.
for goal in all demo report; do
  (mkdir -p "$work/fresh" && cd "$work/fresh" && make_ -n $goal) || bad "-n $goal in a fresh tree: make failed"
  says 'cmake --preset release' && says 'bin/scene-plan .* -o .*/out' ||
    bad "-n $goal in a fresh tree: no build, or no plan"
  [ -z "$(ls -A "$work/fresh")" ] || bad "-n $goal left $(ls -A "$work/fresh")"
done

# A question changes nothing: afterwards nothing has to be made.
demo demo || bad 'demo'
demo -n demo SIZE=48x27 || bad '-n with another size'
says 'irradcache-build records' && says 'frame-render' && ! says '/photon-trace' ||
  bad '-n with another size: other stages than those'
demo estimate SIZE=48x27 FRAMES=0-3 && says 'frame-render' || bad 'estimate with another size'
demo tidy SIZE=48x27 || bad 'tidy'
demo demo && says 'Nothing to be done' || bad 'after questions something runs'

# Invalid requests are refused before anything runs; the message names the error.
refuses() { what=$1; shift; demo "$@" && bad "$*: not refused"; says "$what" || bad "$*: not said why"; }
refuses 'WAIT=.5: give whole seconds' demo WAIT=.5
refuses "no goal 'dmeo'; .*help. lists them" dmeo
demo help && says 'QUALITY=draft' && says 'Further goals: .*estimate' || bad 'help'
refuses 'drft' demo QUALITY=drft
refuses 'FRAME=3: nothing reads FRAME; ' demo FRAME=3
refuses 'scene=my.glb: nothing reads scene; ' demo scene=my.glb
demo -n demo TEMPOLUX_THREADS=1 DESTDIR=/x CXX=g++ || bad 'variables that are read'
refuses 'my smoke.vdb' demo VOLUME='my smoke.vdb'
refuses '.32. is not WIDTHxHEIGHT\|--size' demo SIZE=32
refuses 'my scene.glb' demo SCENE='my scene.glb'
demo demo OUT="$work/o 4" && [ -s "$work/o 4/frames/0030.exr" ] || bad 'OUT with a blank'
refuses 'frame 1 is none of --frames' report REPORT_FRAMES='0 1'
refuses 'frames/0009.exr: is none of FRAMES=0,30' frames/0009.exr
demo frames/0030.png || bad 'one picture'
refuses 'BIN=/nowhere: holds no scene-plan; ' demo BIN=/nowhere
# A make that fails reports whether another make runs in the same OUT.
refuses 'nonsense' demo PIXELS='--spp nonsense' FRAMES=0
says 'another make runs here' && bad 'no other make runs, and it is blamed'
(flock -s 8 && exec sleep 60) 8> "$work/out/state/.makes" & holder=$!
until ! flock -n -x "$work/out/state/.makes" true; do sleep .1; done
refuses 'another make runs here and may have removed a file' demo PIXELS='--spp nonsense' FRAMES=0
kill $holder

# Two makes begin at once in a new OUT. The plan of the first one takes a second longer, and the second one waits.
# Seen to fail: without a lock in a new OUT the first one makes the plan of the second one.
mkdir "$work/slow" && ln -s "$bin"/* "$work/slow" && rm "$work/slow/scene-plan" || exit 3
cat > "$work/slow/scene-plan" << END
"$bin/scene-plan" "\$@" && case "\$*" in *'--size 32x18'*) sleep 1;; esac
END
chmod +x "$work/slow/scene-plan"
size() { make --no-print-directory -f Makefile.example BIN="$work/slow" OUT="$work/two" FRAMES=0 INDIRECT=paths \
  PIXELS='--spp 1 --pixel-error 0' SIZE="$1" 2>&1; }
size 32x18 > "$work/first" & first=$!
sleep .5
size 16x9 > "$work/said" && says 'frame of 16x9: .* look at' || bad 'two makes in a new OUT: the second one'
wait $first && grep -q 'frame of 32x18: .* look at' "$work/first" ||
  { cat "$work/first"; bad 'two makes in a new OUT: the first one'; }
# What is refused leaves no OUT. An estimate by RUN reads and writes nothing in /tmp, which other machines do not see.
refuses 'drft' demo QUALITY=drft OUT="$work/none" RUN=env
[ ! -e "$work/none" ] || bad 'a refused make leaves OUT'
mkdir "$work/hidden"
echo 'case "$PWD $*" in *"$TMPDIR"/*) exit 1;; esac; exec "$@"' > "$work/run"
TMPDIR=$work/hidden demo estimate OUT="$work/none" RUN="sh $work/run" && says 'frame-render' && [ ! -e "$work/none" ] ||
  bad 'an estimate by RUN'
demo report REPORT_FRAMES=30 && ls "$work"/out/error/0030-*.json > /dev/null || bad 'REPORT_FRAMES=30'

# clean removes the files that make made, and nothing else.
(mkdir -p "$work/tree/build" && cp -r Makefile.example pipelines "$work/tree" &&
  touch "$work/tree/build/mine" "$work/out/frames/mine.exr" &&
  top=$work/tree && demo clean) || bad 'clean'
[ -e "$work/tree/build/mine" ] || bad 'clean removed a folder that is not ours'
[ "$(find "$work/out" -type f)" = "$work/out/frames/mine.exr" ] ||
  bad "clean left, or took: $(find "$work/out" -type f)"
[ $failed = 0 ] && echo ok
exit $failed
