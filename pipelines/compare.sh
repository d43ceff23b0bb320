#!/bin/sh
# compare.sh A B PAGE -- makes a page that compares two runs: the frames that both have, side by side, as a film.
# A, B: folders OUT of make; PAGE: the HTML file to write.
#
# The page contains its pictures and loads no other file. Both runs are shown at one exposure, the one that suits A's
# first frame. The environment has BIN, the folder of the tools, and RUN.
. "${0%/*}/made.sh"
a=$1 b=$2 page=$3
[ -d "$a/frames" ] || { echo "compare.sh: $a: has no frames; run make with OUT=$a first" >&2; exit 2; }
[ -d "$b/frames" ] || { echo "compare.sh: $b: has no frames; OTHER=FOLDER names the OUT of another run" >&2; exit 2; }
work=$a/state/.compare.tmp.$(uname -n).$$   # RUN may run a command on another machine, which sees OUT
mkdir -p "$work" || exit 3
trap 'rm -rf "$work"' EXIT
common=
for file in "$a"/frames/*.exr; do
  name=${file##*/}
  [ -f "$b/frames/$name" ] && common="$common ${name%.exr}"
done
[ -n "$common" ] || { echo "compare.sh: $a and $b have no frame in common" >&2; exit 2; }
first=${common# } first=${first%% *}
wanted=$page part=$work/facts
answer 1 -- $RUN "$BIN/tempolux-info" "$a/frames/$first.exr" --json || exit
exposure=$(echo "$answered" | sed -n 's/.*"auto_exposure_stops": *\([^,]*\),*$/\1/p')
text() { printf %s "$1" | sed 's/&/\&amp;/g; s/</\&lt;/g'; }
picture() {   # picture RUN FOLDER FRAME
  made "$work/p.png" -- $RUN "$BIN/tempolux-info" --png "$work/p.png" --exposure "$exposure" "$2/frames/$3.exr" ||
    exit 3
  printf '<img class=%s alt="" src="data:image/png;base64,' "$1"
  base64 -w 0 "$work/p.png"
  echo '">'
}
{
  sed "/<!-- frames -->/q" "$PIPELINES/compare.html"
  echo "<p id=names>A: $(text "$a")<br>B: $(text "$b")</p>"
  for frame in $common; do
    echo "<section id=f$frame data-frame=$frame>"
    picture a "$a" "$frame"
    picture b "$b" "$frame"
    echo '</section>'
  done
  sed "1,/<!-- frames -->/d" "$PIPELINES/compare.html"
} > "$work/page.html" || exit 3
mv -f "$work/page.html" "$page" &&
  echo "$page: $(echo "$common" | wc -w) frames of two runs"
