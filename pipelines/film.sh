#!/bin/sh
# film.sh -- makes OUT/film.mp4 from the previews of the frames, all at one exposure. run.sh runs it inside OUT, after
# the frames.
command -v ffmpeg > /dev/null ||
  { echo 'make film: there is no ffmpeg; install it (Debian: apt-get install ffmpeg) and type this again' >&2; exit 2; }
. "${0%/*}/made.sh"
work=$PWD/state/.film.tmp.$(uname -n).$$   # RUN may run ffmpeg on another machine, which sees OUT
mkdir -p "$work" || exit 3
trap 'rm -rf "$work"' EXIT
n=0
for name in $(sed -n 's/^previews := //p' "$PLAN"); do   # in the order asked for
  ln -s "$PWD/$name" "$work/$(printf %06d $n).png" || exit 3
  n=$((n + 1))
done
fps=$(sed -n 's/^ *"fps": *\([0-9.e+]*\),*$/\1/p' "$PLAN_JSON")
# H.264 needs even sizes: an odd picture gets a black row or column.
wanted=film.mp4
made "$work/film.mp4" -- \
  $RUN ffmpeg -nostdin -v error -y -framerate "${fps:-24}" -i "$work/%06d.png" -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' \
  -pix_fmt yuv420p "$work/film.mp4" || exit
mv -f "$work/film.mp4" film.mp4 && echo "$OUT/film.mp4: $n frames, $fps a second"
