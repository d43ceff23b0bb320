#!/bin/sh
# show.sh MARKER INPUT... -- makes the files that a user looks at. MARKER is a file shown/WHAT-KEY; it holds a digest of
# what is shown now. stages.mk runs this script inside OUT.
#
#     shown/0012-KEY PICTURE                frames/0012.exr, a copy
#     shown/0012-KEY.png PICTURE EXPOSURE   frames/0012.png
#     shown/exposure-KEY PICTURE            the marker holds the exposure that the plan names, or the one that suits
#                                           the picture; all frames share it, so that the brightness does not jump
#     shown/sheet-KEY EXPOSURE              sheet.png, all frames of plan.mk; a walkthrough's keys have a border
#     shown/walk-KEY INTERVAL...            walk.log, where keys were placed and why
#     shown/report-KEY OPTION...            report/index.html; the options are those of error-report
#
# The environment has BIN, RUN, SCENE, PIPELINES and PLAN.
. "${0%/*}/made.sh"
marker=$1; shift
what=${marker#shown/}
what=${what%-*}
part=
trap 'rm -f "$part"' EXIT
# drawn OPTION...: tempolux-info makes the file $part. A message names the file that is shown.
drawn() { wanted=$file; made "$part" -- $RUN "$BIN/tempolux-info" "$@"; }
part_of() {   # a name that make tidy knows
  case $1 in */*) part=${1%/*}/.${1##*/}.tmp.$(uname -n).$$;; *) part=.$1.tmp.$(uname -n).$$;; esac
}

# The text of a marker: digests of the shown frames, and $1. A command may have made the same picture again: then the
# text is equal and nothing is shown anew.
shows() {
  said=$1 wanted=$file; shift
  part_of "$marker"
  answer $# -- $RUN "$BIN/tempolux-info" --digest "$@" || exit
  part=
  now="$(sed -n 's/^viewer := *//p' "$PLAN") $said $(echo "$answered" | cut -d' ' -f1 | cksum)"
}
is_shown() { [ -f "$file" ] && [ "$now" = "$(cat "$@" 2> /dev/null)" ]; }   # is_shown OLD_MARKER...

# Two makes that show different pictures of a frame run one after the other: the marker always fits the shown file. It
# is written only where the file was drawn, or is the right one already (is_shown).
lock() { exec 9> shown/.lock; ! command -v flock > /dev/null || flock 9; }
publish() {   # publish OLD_MARKER...
  rm -f "$@"
  [ -z "$part" ] || mv -f "$part" "$file" || exit 3
  echo "$now" > "$marker"
}

now=
case $marker in
  shown/exposure-*)
    part_of "$marker"
    stops=$(sed -n 's/^stops := *//p' "$PLAN")
    if [ -z "$stops" ]; then
      wanted=$marker
      answer 1 -- $RUN "$BIN/tempolux-info" "$1" --json || exit
      stops=$(echo "$answered" | sed -n 's/^ *"auto_exposure_stops": *\([^,]*\),*$/\1/p')
      [ -n "$stops" ] || { not_made "$marker" tempolux-info 'has printed no exposure'; exit 3; }
    fi
    echo "$stops" > "$part" && mv -f "$part" "$marker";;
  shown/sheet-*)
    file=sheet.png frames=$(sed -n 's/^frames := *//p' "$PLAN") marks=
    ! grep -q '^log :=' "$PLAN" || marks=$(sh "$PIPELINES/walkthrough.sh" marks)
    shows "$(cat "$1") $marks $frames" $frames
    if ! is_shown shown/sheet-*; then
      part_of $file
      drawn --sheet "$part" --columns 8 --tile 160 --exposure "$(cat "$1")" $marks $frames || exit
    fi
    publish shown/sheet-*;;
  shown/walk-*)
    file=walk.log
    part_of $file
    sh "$PIPELINES/walkthrough.sh" log "$@" > "$part" || exit
    publish shown/walk-*;;
  shown/report-*)
    made report/index.html -- $RUN "$BIN/error-report" -o report --title "$(basename -- "$SCENE"): error against time" \
      "$@" || exit
    publish shown/report-*;;
  *.png)
    file=frames/$what.png
    shows "$(cat "$2")" "$1"
    lock
    if ! is_shown "shown/$what"-*.png; then
      exec 9>&-
      part_of "$file"
      drawn --png "$part" --exposure "$(cat "$2")" "$1" || exit
      lock
    fi
    publish "shown/$what"-*.png;;
  *)
    file=frames/$what.exr
    part_of "$file"
    cp --reflink=auto "$1" "$part" || exit
    lock
    publish "shown/$what"-??????????;;
esac
