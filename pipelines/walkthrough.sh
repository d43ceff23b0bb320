#!/bin/sh
# walkthrough.sh -- what METHOD=walkthrough does beyond rules: where key frames are, what lies between them, one interval.
#
#     walkthrough.sh intervals N FRAME...     every N-th frame and the last one as A+B A+B ...
#     walkthrough.sh between A B FRAME...     the frames of the list that lie between two
#     walkthrough.sh interval A B FRAME...    decide one interval and make its frames; FRAMEs: those between
#     walkthrough.sh frame F                  make one frame again, from the keys it was warped from
#     walkthrough.sh keys                     by OUT/walk.log the frames that are keys, as OUT/frames/F.exr,...
#
# interval and frame are run by walkthrough.mk, which says in the environment: OUT, the folder; WARP, RENDER, COMPARE, MAKE_INTERVALS, the
# commands; LIT_F, the options of light of each frame F; THRESHOLD. They may be killed at any moment and run again: a file is there whole or
# not at all, and an interval counts as done by walk/A+B.done alone, which make touches last.
set -e
command=$1; shift

number() { n=${1#"${1%%[!0]*}"}; echo "${n:-0}"; }   # 0012 -> 12: leading zeros mean octal to the shell

intervals() {
  step=$1 first= count=0; shift
  for frame; do
    if [ -z "$first" ]; then first=$frame; continue; fi
    count=$((count + 1)) last=$frame
    [ $count -lt "$step" ] && continue
    echo "$first+$frame"
    first=$frame count=0
  done
  [ $count = 0 ] || echo "$first+$last"
}

between() {
  from=$1 to=$2 inside=; shift 2
  for frame; do
    [ "$frame" = "$to" ] && return
    [ -n "$inside" ] && echo "$frame"
    [ "$frame" = "$from" ] && inside=yes
  done
}

joined() { echo "$*" | tr ' ' ','; }
key() { echo "$OUT/keys/$1.exr"; }
count_of() { sed -n "s/^ *\"$1\": *\([0-9.e+-]*\),*\$/\1/p" "$2" | head -n 1; }

# A file of the pipeline as a copy that is whole or not there.
copy() { cp "$1" "$2.part.$$" && mv "$2.part.$$" "$2"; }

# Frames between two keys: warped, then what the masks name is traced. Frames that have the same light in one call.
make_frames() {
  a=$1 b=$2; shift 2
  [ $# -gt 0 ] || return 0
  $WARP "$(key "$a")" "$(key "$b")" --frames "$(joined "$@")" -o "$OUT/walk/####.exr" --mask "$OUT/walk/####.mask.exr" ${FLOW:+--flow "$FLOW"} \
    --compression none --stats "$OUT/walk/$1.warp.json"
  while [ $# -gt 0 ]; do
    eval "light=\$LIT_$1"
    together= first=$1
    while [ $# -gt 0 ]; do
      eval "other=\$LIT_$1"
      [ "$other" = "$light" ] || break
      together="$together $1"; shift
    done
    # shellcheck disable=SC2086
    $RENDER $light --frames "$(joined $together)" --base "$OUT/walk/####.exr" --mask "$OUT/walk/####.mask.exr" -o "$OUT/frames/####.exr" \
      --stats "$OUT/walk/$first.json"
    for frame in $together; do echo "$a $b" > "$OUT/walk/$frame.keys"; done
  done
}

# Both keys warped to the middle: how much do they differ where neither is masked, and how much is masked?
decide() {
  a=$1 b=$2 middle=$3 frames=$4 try=$OUT/walk/$a+$b
  mkdir -p "$try"
  $WARP "$(key "$a")" "$(key "$b")" --frame "$middle" -o "$try/w.exr" --mask "$try/why.exr" --separate --compression none --stats "$try/warp.json"
  pixels=$(count_of pixels "$try/warp.json") traced=$(count_of traced "$try/warp.json")
  distant=0 causes=
  for cause in specular occlusion slow deforming changed_light border edge undersampled; do
    n=$(count_of "traced_$cause" "$try/warp.json")
    [ "$n" = 0 ] || causes="$causes $cause $(percent "$n" "$pixels")"
    case $cause in occlusion | changed_light | border | undersampled) distant=$((distant + n));; esac
  done
  difference=none verdict=warp
  if [ "$traced" -lt "$pixels" ]; then
    code=0
    $COMPARE "$try/w_1.exr" "$try/w_2.exr" --except "$try/why.exr" --fail-by relmse --fail-above "$THRESHOLD" --quiet --json "$try/compare.json" || code=$?
    case $code in 0) ;; 1) verdict=split;; *) exit $code;; esac
    difference=$(count_of relmse "$try/compare.json")
  fi
  # What no key sees grows with their distance: halving it saves half of that in every frame, and costs a key.
  [ $((distant * (frames + 1))) -gt $((2 * pixels)) ] && verdict=split
  rm -rf "$try"
  echo "$a $b  middle $middle  difference $difference  traced $(percent "$traced" "$pixels"):$causes  $verdict"
}
percent() { awk "BEGIN { printf \"%.1f%%\", 100 * $1 / $2 }"; }

interval() {
  a=$1 b=$2; shift 2
  mkdir -p "$OUT/walk" "$OUT/frames"
  for end in "$a" "$b"; do [ "$OUT/frames/$end.exr" -nt "$(key "$end")" ] || copy "$(key "$end")" "$OUT/frames/$end.exr"; done
  if [ $# = 0 ]; then echo "$a $b  neighbours" > "$OUT/walk/$a+$b.log"; return; fi
  middle=$(echo "$*" | cut -d' ' -f$((($# + 1) / 2)))
  line=$(decide "$a" "$b" "$middle" $#)
  echo "$line" >&2
  case $line in
    *split) $MAKE_INTERVALS "$OUT/walk/$a+$middle.done" "$OUT/walk/$middle+$b.done"
            { echo "$line"; cat "$OUT/walk/$a+$middle.log" "$OUT/walk/$middle+$b.log"; } > "$OUT/walk/$a+$b.part" ;;
    *) make_frames "$a" "$b" "$@"
       echo "$line" > "$OUT/walk/$a+$b.part" ;;
  esac
  mv "$OUT/walk/$a+$b.part" "$OUT/walk/$a+$b.log"
}

frame() {
  if [ -f "$OUT/walk/$1.keys" ]; then
    read -r a b < "$OUT/walk/$1.keys"
    make_frames "$a" "$b" "$1"
  else
    copy "$(key "$1")" "$OUT/frames/$1.exr"
  fi
}

# An interval that was halved has a line and its halves have theirs: ends of those that were not.
keys() { awk -v out="$OUT" '!/split$/ { print out "/frames/" $1 ".exr"; print out "/frames/" $2 ".exr" }' "$OUT/walk.log" | sort -u | paste -sd,; }

case $command in
  intervals | between | interval | frame | keys) $command "$@";;
  *) echo "walkthrough.sh: '$command' is none of intervals, between, interval, frame, keys" >&2; exit 2;;
esac
