#!/bin/sh
# FILTER=3 on the Cornell box whose block moves: sh tests/pipelines/filter.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. Each frame is filtered from the pictures around it,
# asked for or not, and from fewer at the animation's ends. A raw picture is removed when all frames whose windows hold
# it are filtered; if some of them are not asked for, it stays. A second run makes nothing. Another order gives the same
# frames. A filtered picture that was deleted is made again from its raw pictures alone.
bin=$1 failed=0
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
run() {
  make V=1 -f Makefile.example --no-print-directory demo BIN="$bin" SIZE=48x27 PHOTONS=5k POINTS='--point-count 1k' CACHE='--rays 20 --error-bound 1' \
    FILTER=3 FRAMES=0,1,2,3,6 "$@" > "$work/log" 2>&1
}
# A wrapper that keeps the raw pictures, which make removes.
cat > "$work/keep.sh" << 'END'
case $1 in */frame-render) ;; *) exec "$@";; esac
"$@" || exit
for word; do case $word in raw/*.exr) mkdir -p ../raw && cp "$word" ../raw;; esac; done
END
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr | sed "s|$1/||"; }
run OUT="$work/a" RUN="sh $work/keep.sh" || { cat "$work/log"; exit 1; }
digests "$work/a" > "$work/expected"
[ "$(wc -l < "$work/expected")" = 5 ] || bad "5 frames, not $(wc -l < "$work/expected")"
"$bin/tempolux-info" --json "$work/a/frames/0002.exr" | grep -q '"direct.R"' && bad 'channels that were not asked for'
window() { # window FRAME POSITION PICTURE...: the raw pictures from which a frame is filtered
  frame=$1 position=$2; shift 2
  "$bin/st-filter" $(ls $(printf "$work/raw/%s-*.exr " "$@")) --position "$position" --channels RGBA,Z,N,id -o "$work/one.exr" -q || bad "st-filter of $frame"
  "$bin/tempolux-info" --diff "$work/one.exr" "$work/a/frames/$frame.exr" > /dev/null || bad "frame $frame is not that of $*"
}
window 0000 1 0000 0001
window 0002 2 0001 0002 0003
window 0003 2 0002 0003 0004
window 0006 2 0005 0006 0007
run OUT="$work/a"; grep -q 'Nothing to be done' "$work/log" || bad "a second run: $(head -3 "$work/log")"
left() { ls "$work/a/raw" | sed -n 's/-.*exr$//p' | tr -d '\n'; }
[ "$(left)" = 00030004000500060007 ] || bad "raw pictures of the frames $(left) are left, not of 3 to 7"
rm "$work/a/filtered/0001-"*.exr; run OUT="$work/a"
[ "$(grep -c '/st-filter ' "$work/log") $(grep -c '/frame-render ' "$work/log")" = '1 3' ] ||
  bad "one filtered picture was deleted, made were $(grep -c '/st-filter ' "$work/log") from $(grep -c '/frame-render ' "$work/log") raw ones"
[ "$(left)" = 00030004000500060007 ] || bad "then raw pictures of the frames $(left) are left, not of 3 to 7"
digests "$work/a" | diff "$work/expected" - || bad 'made again: other frames'
run OUT="$work/b" -j1 || { cat "$work/log"; exit 1; }
digests "$work/b" | diff "$work/expected" - || bad 'one job: other frames'
run OUT="$work/c" FILTER=4 && bad 'FILTER=4 is taken'
grep -q -e '--filter' "$work/log" || bad "FILTER=4: $(cat "$work/log")"
run OUT="$work/c" METHOD=walkthrough && bad 'FILTER with METHOD=walkthrough is taken'
[ $failed = 0 ] && echo ok
exit $failed
