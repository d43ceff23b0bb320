#!/bin/sh
# walkthrough.sh -- the parts of METHOD=walkthrough that are more than rules (walkthrough.md). stages.mk runs it inside
# OUT.
#
#     walkthrough.sh interval TARGET KEY_A KEY_B MIDDLE KEY_MIDDLE THRESHOLD LEFT RIGHT
#     walkthrough.sh frame TARGET INTERVAL FRAME CHANNELS OPTION...
#     walkthrough.sh log INTERVAL...          prints the decisions, in the order of frames
#     walkthrough.sh marks                    prints the key frames in walk.log, as an option for the sheet
#
# An interval lies between two key pictures. LEFT and RIGHT are its halves, or "-" if a half holds no frame. TARGET
# holds "warp", or "split" if the picture of the middle frame became a key; a frame reads there which keys it is warped
# from. OPTIONs are the options of the frame's light. CHANNELS are the channels that the filter writes; "-": the frame
# is not filtered. The environment has BIN, RUN, SHARED, CAMERA and MAKE_FILES, the command that makes files of the
# plan.
set -e
. "${0%/*}/made.sh"
. "${0%/*}/claim.sh"
command=$1; shift

frame_of() { name=${1##*/}; echo "${name%%-*}"; }       # keys/0012-3fa94c21d0.exr -> 0012
number() { n=${1#"${1%%[!0]*}"}; echo "${n:-0}"; }      # 0012 -> 12
count_of() { sed -n "s/^ *\"$1\": *\([0-9.e+-]*\),*\$/\1/p" "$2" | head -n 1; }
percent() { awk "BEGIN { printf \"%.1f%%\", 100 * $1 / $2 }"; }
# makes FILE... -- TOOL OPTION...: runs a tool on the scene with the camera of the frames. A message names the target.
# SHARED: options in quotes, names in variables.
makes() {
  files=
  while [ "$1" != -- ]; do files="$files $1"; shift; done
  name=$2; shift 2
  eval "set -- \"\$@\" $SHARED"
  # shellcheck disable=SC2086
  made $files -- $RUN "$BIN/$name" "$@" --camera "$CAMERA" ${FSTOP:+--f-stop "$FSTOP"}
}

sum_of() { name=$1; shift; total=0; for file; do total=$((total + $(count_of "$name" "$file"))); done; echo "$total"; }

# Warps both keys to frame $1 in folder $2. Exits with 1 if a viewer sees the error of either warped picture in more
# than the share $threshold of the pixels that are not masked. Appends the share in percent to $seen.
differ() {
  makes "$2/w_1.exr" "$2/w_2.exr" "$2/why.exr" "$2/flow.exr" "$2/$1.warp.stats.json" -- ibr-warp "$a" "$b" \
    --scene "$SCENE" --frame "$1" -o "$2/w.exr" --mask "$2/why.exr" --flow "$2/flow.exr" --separate --compression none \
    --stats "$2/$1.warp.stats.json" || exit
  [ "$(count_of traced "$2/$1.warp.stats.json")" -lt "$(count_of pixels "$2/$1.warp.stats.json")" ] || return 0
  answer=0 may_differ=yes
  made "$2/compare.json" -- $RUN "$BIN/aqm-compare" "$2/w_1.exr" "$2/w_2.exr" --either --flow "$2/flow.exr" \
    --except "$2/why.exr" --fail-above "$threshold" --quiet --json "$2/compare.json" \
    --stats "$2/$1.compare.stats.json" || answer=$?
  may_differ=
  [ $answer -le 1 ] || exit $answer
  seen="$seen $(count_of percent "$2/compare.json")"
  return $answer
}

# Decides whether frames warped to one, two and three quarters of the interval are as good as rendered ones, and how
# many of their pixels are masked.
decide() {
  a=$1 b=$2 middle=$3 threshold=$4 try=$5 seen= verdict=warp causes= distant=0
  first=$(number "$(frame_of "$a")") last=$(number "$(frame_of "$b")") before=$first
  set --
  for f in $(((3 * first + last) / 4)) "$(number "$middle")" $(((first + 3 * last) / 4)); do
    [ "$f" -gt "$before" ] || continue   # short intervals have fewer frames
    before=$f
    differ "$f" "$try" || verdict=split
    set -- "$@" "$try/$f.warp.stats.json"
  done
  pixels=$(sum_of pixels "$@") traced=$(sum_of traced "$@")
  for cause in specular occlusion slow deforming changed_light border edge undersampled; do
    n=$(sum_of "traced_$cause" "$@")
    [ "$n" = 0 ] || causes="$causes $cause $(percent "$n" "$pixels")"
    case $cause in occlusion | changed_light | border | undersampled) distant=$((distant + n));; esac
  done
  # The area that no key sees grows with the distance of the keys: halving the interval saves half of this area in
  # every frame and costs a key.
  [ $((distant * (last - first))) -gt $((2 * pixels)) ] && verdict=split
  seen=$(printf '%s\n' $seen | sort -g | tail -n 1)
  traced="$(percent "$traced" "$pixels"):$causes"
  echo "$(frame_of "$a") $(frame_of "$b")  middle $middle  seen ${seen:-none}${seen:+%}  traced $traced  $verdict"
}

# Statistics of an interval: sums over its commands, "phases" by name (formats/stats/stats.md).
sum_of_stats() {
  awk '
    function value() { sub(/^[^:]*: */, ""); sub(/,$/, ""); return $0 }
    /^  "host":/ { host = value() }
    /^  "threads":/ { threads = value() }
    /^  "cpu_s":/ { cpu += value() }
    /^  "wall_s":/ { wall += value() }
    /^  "peak_memory_bytes":/ { memory = value(); if (memory + 0 > most + 0) most = memory }
    /^      "name":/ { name = value(); if (!(name in spent)) order[++names] = name }
    /^      "cpu_s":/ { spent[name] += value() }
    /^      "wall_s":/ { passed[name] += value() }
    /^      "parallel":/ { parallel[name] = value() }
    END {
      print "{\n  \"schema\": \"tempolux.stats\",\n  \"version\": \"1.1\",\n  \"tool\": \"ibr-warp\","
      printf "  \"host\": %s,\n  \"threads\": %d,\n", host, threads
      printf "  \"cpu_s\": %.6f,\n  \"wall_s\": %.6f,\n  \"peak_memory_bytes\": %s,\n  \"phases\": [", cpu, wall, most
      for (i = 1; i <= names; ++i) {
        name = order[i]
        printf "%s\n    {\n      \"name\": %s,\n      \"cpu_s\": %.6f,\n      \"wall_s\": %.6f,\n" \
          "      \"parallel\": %s\n    }", (i > 1 ? "," : ""), name, spent[name], passed[name], parallel[name]
      }
      print "\n  ],\n  \"counts\": {},\n  \"results\": {}\n}"
    }' "$@"
}

interval() {
  target=$1 a=$2 b=$3 middle=$4 middle_key=$5 threshold=$6 left=$7 right=$8
  wanted=$target
  try=$target.try.$$
  mkdir -p "$try"
  trap 'rm -rf "$try"; let_go' EXIT
  decide "$a" "$b" "$middle" "$threshold" "$try" > "$try/line"
  sum_of_stats "$try"/*.stats.json > "$try/stats" && mv "$try/stats" "${target%.done}.json"
  line=$(cat "$try/line")
  echo "$line" >&2
  case $line in
    *split) halves=
            for half in "$left" "$right"; do [ "$half" = - ] || halves="$halves $half"; done
            eval "ending $MAKE_FILES $middle_key $halves"
            echo "split $middle $middle_key $left $right" > "$try/done" ;;
    *)      echo "warp $a $b" > "$try/done" ;;
  esac
  echo "$line" >> "$try/done"
  mv "$try/done" "$target"
}

frame() {
  target=$1 interval=$2 frame=$3 channels=$4; shift 4
  wanted=$target
  while read -r verdict x y left right < "$interval"; [ "$verdict" = split ]; do
    if [ "$frame" = "$x" ]; then cp "$y" "$target.part.$$" && mv "$target.part.$$" "$target"; return; fi
    if [ "$(number "$frame")" -lt "$(number "$x")" ]; then interval=$left; else interval=$right; fi
  done
  part=${target%.exr}.part.$$
  trap 'rm -f "$part".*; let_go' EXIT
  n=$(number "$frame")
  # A completed frame that is still to be filtered has a key in its name: it is used again if it is there.
  completed=$target
  [ "$channels" = - ] || { completed=${target%.exr}.raw.exr; set -- "$@" --compression none; }
  if [ ! -f "$completed" ]; then
    instead=$target
    makes "$part.warp.exr" "$part.mask.exr" -- ibr-warp "$x" "$y" --scene "$SCENE" --frame "$n" -o "$part.warp.exr" \
      --mask "$part.mask.exr" --compression none --stats "${target%.exr}.warp.json"
    makes "$completed" -- frame-render "$SCENE" --frame "$n" "$@" --base "$part.warp.exr" --mask "$part.mask.exr" \
      -o "$completed" --stats "${target%.exr}.json"
    instead=
  fi
  [ "$channels" != - ] || return 0
  made "$target" -- $RUN "$BIN/st-filter" "$completed" --channels "$channels" -o "$target"
  rm -f "$completed"
}

# Prints the decisions, for an interval before its halves.
log() {
  for interval; do
    read -r verdict x y left right < "$interval"
    sed -n 2p "$interval"
    [ "$verdict" = split ] || continue
    for half in "$left" "$right"; do [ "$half" = - ] || log "$half"; done
  done
}

# walk.log has a line for an interval that was halved and for its halves. Keys are the ends of intervals that were not
# halved and the middles of those that were.
marks() {
  keys=$(awk '!/split$/ { print "frames/" $1 ".exr"; print "frames/" $2 ".exr" }
    /split$/ { print "frames/" $4 ".exr" }' walk.log | sort -u |
    while read -r name; do ! grep -q "^$name:" "${PLAN:-plan.mk}" || echo "$name"; done | paste -sd,)
  [ -z "$keys" ] || echo "--mark $keys"
}

case $command in
  interval | frame)
    trap let_go EXIT
    hold "$1" -- || exit 0
    $command "$@"
    finished "$1";;
  log | marks) $command "$@";;
  *) echo "walkthrough.sh: '$command' is none of interval, frame, log, marks" >&2; exit 2;;
esac
