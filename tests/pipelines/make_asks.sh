#!/bin/sh
# What Makefile.example does when only asked, or asked for what cannot be: sh tests/pipelines/make_asks.sh BIN
# Run at the top of the tree; BIN is the folder with the tools.
bin=$1 top=$PWD
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
failed=0
bad() { echo "FAILED: $*"; cat "$work/said"; failed=1; }
make_() { make --no-print-directory -f "$top/Makefile.example" "$@" > "$work/said" 2>&1; }
says() { grep -q -e "$1" "$work/said"; }
demo() { goal=$1; shift; make_ "$goal" BIN="$bin" OUT="$work/out" FRAMES=0,30 SIZE=32x18 PHOTONS=2k PATHS=2 \
  POINTS='--point-count 1k' CACHE='--rays 20 --error-bound 1' PIXELS='--spp 1' "$@"; }

# Before anything is built: -n lists what comes first, and leaves no trace.
for goal in all demo report; do
  (mkdir -p "$work/fresh" && cd "$work/fresh" && make_ -n $goal) || bad "-n $goal in a fresh tree: make failed"
  says 'cmake --preset release' && says 'bin/scene-plan .* -o out/plan' || bad "-n $goal in a fresh tree: no build, or no plan"
  [ -z "$(ls -A "$work/fresh")" ] || bad "-n $goal left $(ls -A "$work/fresh")"
done

# Asking changes nothing: afterwards nothing has to be done.
demo demo || bad 'demo'
demo -n demo SIZE=48x27 || bad '-n with another size'
says 'irradcache-build records' && says 'frame-render' && ! says 'photon-trace' || bad '-n with another size: other stages than those'
demo estimate SIZE=48x27 FRAMES=0-3 && says 'frame-render' || bad 'estimate with another size'
demo tidy SIZE=48x27 || bad 'tidy'
demo demo && says 'Nothing to be done' || bad 'after questions something runs'

# Refused before anything runs, by the name of what is wrong.
refuses() { what=$1; shift; demo "$@" && bad "$*: not refused"; says "$what" || bad "$*: not said why"; }
refuses "no goal 'dmeo'; .*help. lists them" dmeo
demo help && says 'QUALITY=draft' && says 'Further goals: estimate' || bad 'help'
refuses 'QUALITY=drft' demo QUALITY=drft
refuses 'FRAME=3: nothing reads FRAME; ' demo FRAME=3
refuses 'scene=my.glb: nothing reads scene; ' demo scene=my.glb
demo -n demo TEMPOLUX_THREADS=1 DESTDIR=/x CXX=g++ plan_rays=40 || bad 'variables that are read'
refuses 'VOLUME=' demo VOLUME='my smoke.vdb'
refuses 'SIZE=32:' demo SIZE=32
refuses 'SCENE=.my scene.glb' demo SCENE='my scene.glb'
refuses 'OUT=.*/o 4' demo OUT="$work/o 4"
[ -e "$work/o" ] && bad 'a name with a blank made a folder'
refuses '1-is-not-in-FRAMES' report REPORT_FRAMES='0 1'
demo report REPORT_FRAMES=30 && [ -s "$work/out/error/0030.json" ] || bad 'REPORT_FRAMES=30'

# clean takes what make made, and nothing else.
(mkdir "$work/tree" && cd "$work/tree" && mkdir build && touch "$work/out/frames/mine.exr" && demo clean) || bad 'clean'
[ "$(find "$work/out" -type f)" = "$work/out/frames/mine.exr" ] || bad "clean left, or took: $(find "$work/out" -type f)"
[ $failed = 0 ] && echo ok
exit $failed
