#!/bin/sh
# show.sh MARKER INPUT... -- makes what a user looks at. MARKER is a file shown/WHAT-KEY, which says what is shown now. Run inside OUT by stages.mk.
#
#     shown/0012-KEY PICTURE                frames/0012.exr, a copy
#     shown/0012-KEY.png PICTURE EXPOSURE   frames/0012.png
#     shown/exposure-KEY PICTURE            the marker holds the exposure that suits the picture. One for all frames: brightness does not jump
#     shown/sheet-KEY EXPOSURE              sheet.png, all frames of plan.mk; a walkthrough's keys have a border. Prints the account of the frames
#     shown/walk-KEY INTERVAL...            walk.log, where keys were placed and why
#
# The environment has BIN, RUN, PIPELINES and PLAN.
. "${0%/*}/ending.sh"
marker=$1; shift
what=${marker#shown/}
what=${what%-*}
part=
trap 'rm -f "$part"' EXIT
info() { ending $RUN "$BIN/tempolux-info" "$@"; }
part_of() { part=${1%/*}/.${1##*/}.tmp.$(uname -n).$$; }   # a name that make tidy knows

# The part becomes a file of frames/. Two makes that show other pictures of a frame go one after the other: the marker is that of what lies there.
publish() {   # publish FILE OLD_MARKER...
  exec 9> shown/.lock
  ! command -v flock > /dev/null || flock 9
  file=$1; shift
  rm -f "$@"
  mv -f "$part" "$file" && touch "$marker"
}

case $marker in
  shown/exposure-*)
    part_of "$marker"
    info "$1" --json | sed -n 's/^ *"auto_exposure_stops": *\([^,]*\),*$/\1/p' | grep . > "$part" && mv -f "$part" "$marker";;
  shown/sheet-*)
    frames=$(sed -n 's/^frames := *//p' "$PLAN") marks=
    ! grep -q '^log :=' "$PLAN" || marks=$(sh "$PIPELINES/walkthrough.sh" marks)
    info --sheet sheet.png --columns 8 --tile 160 --exposure "$(cat "$1")" $marks $frames && info --account $frames || exit
    rm -f shown/sheet-*
    touch "$marker";;
  shown/walk-*)
    sh "$PIPELINES/walkthrough.sh" log "$@" > walk.log || exit
    rm -f shown/walk-*
    touch "$marker";;
  *.png)
    part_of "frames/$what.png"
    info --png "$part" --exposure "$(cat "$2")" "$1" && publish "frames/$what.png" "shown/$what"-*.png;;
  *)
    part_of "frames/$what.exr"
    cp --reflink=auto "$1" "$part" && publish "frames/$what.exr" "shown/$what"-??????????;;
esac
