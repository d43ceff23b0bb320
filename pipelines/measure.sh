#!/bin/sh
# measure.sh -- measures how much of the noise a viewer sees, before a long run: `make measure`. run.sh runs it after
# scene-plan; it has make's variables.
#
# In each segment the frame of FRAMES that is closest to the middle is rendered twice with independent random numbers.
# AQM estimates the share of the pixels in which a viewer sees the noise of one rendering (aqm-compare --either), and
# steady.py how much of the noise changes from frame to frame.
# With METHOD=preview it chooses the number of photons: a frame of n photons is compared with one of 2 n. The difference
# is noise, and blur that more photons remove. n starts at 3125 and is doubled until the share is at most AQM, or until
# two doublings have not reduced it. OUT/measured.json has all results; scene-plan --measured chooses by them.
least=3125 most=1000000
runs=$OUT/measure
table=$OUT/measured.json
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
. "${0%/*}/made.sh"

render() {   # render SEED FRAME PHOTONS
  FRAMES=$2 PHOTONS=$3 MEASURE_SEED=$1 OUT=$runs/$1 MEASURED='' \
    ending sh "$PIPELINES/run.sh" "$(printf 'frames/%04d.exr' "$2")" > "$work/log" 2>&1 ||
    { tail -3 "$work/log" >&2; exit 3; }
}

compare() {   # compare FRAME [--either]: sets `percent` of the pixels in which a viewer sees a difference
  name=$(printf %04d "$1").exr
  shift
  compared=$runs/compared.json
  made "$compared" -- $RUN "$BIN/aqm-compare" "$runs/1/frames/$name" "$runs/2/frames/$name" "$@" --metric aqm \
    --json "$compared" -q || exit 3
  percent=$(sed -n 's/^ *"percent": *\([0-9.e+-]*\),*$/\1/p' "$compared" | head -1)   # of the whole picture
}

tell() {   # tell FRAME PHOTONS PERCENT: prints a result and adds it to the list
  if [ -n "$2" ]; then what=errors; else what=noise; fi
  echo "frame $1${2:+, $2 photons a frame}: a viewer sees $what in $(printf %.1f "$3") % of the pixels" >&2
  tried="$tried${tried:+, }{\"photons\": ${2:-0}, \"aqm\": $(awk "BEGIN { print $3 / 100 }")}"
}

# Where the sources lie: how much of the noise changes from this frame to the next one of the shot, in boxes of 1, 5 and
# 15 pixels (tests/bench/steady.py).
steady() {   # steady FRAME
  script=$TOP/tests/bench/steady.py
  [ -f "$script" ] && command -v python3 > /dev/null && render 1 $(($1 + 1)) '' && render 2 $(($1 + 1)) '' || return 0
  python3 -B "$script" "$runs/1/frames" "$runs/2/frames" "$1-$(($1 + 1))" | sed "s/^/frame $1, codes: /" >&2
}

goes_on() {   # goes_on PERCENT: true if it is above AQM and one of the last two doublings has reduced it
  if awk "BEGIN { exit !($1 < $best) }"; then best=$1 worse=0; else worse=$((worse + 1)); fi
  [ $worse -lt 2 ] && [ "$n" -le $most ] && awk "BEGIN { exit !($1 > ${AQM%\%}) }"
}

segment() {   # segment FIRST LAST: adds its line to the table
  frame=$(sed -n 's/^frames := //p' "$OUT/plan.mk" | tr ' ' '\n' | sed 's|^frames/0*\([0-9]\)|\1|; s|[.]exr$||' |
    awk -v a="$1" -v b="$2" '$1 >= a && $1 <= b { d = $1 - int((a + b) / 2); d = d < 0 ? -d : d
                                                  if (best == "" || d < least) { best = $1; least = d } } END { print best }')
  [ -n "$frame" ] || return 0   # the segment only holds the frame that gives the pixels that stay
  tried=
  if [ "$METHOD" = preview ] && [ -z "$PHOTONS" ]; then
    n=$least one=1 two=2 best=101 worse=0
    render $one "$frame" "$n"
    while :; do
      render $two "$frame" $((2 * n))
      compare "$frame"
      tell "$frame" "$n" "$percent"
      n=$((2 * n)) one=$two two=$((3 - two))
      goes_on "$percent" || break
    done
  else
    render 1 "$frame" "$PHOTONS" && render 2 "$frame" "$PHOTONS"
    compare "$frame" --either
    tell "$frame" '' "$percent"
    steady "$frame"
  fi
  picture=$(sed -n "s/^ *\"$(printf %04d "$frame")\": \"\([^\"]*\)\",*\$/\1/p" "$runs/1/plan.json")
  list="$list${list:+,
}  {\"first\": $1, \"frame\": $frame, \"picture\": \"$picture\", \"tried\": [$tried]}"
}

case $AQM in
  '') case $QUALITY in draft) AQM=20;; *) AQM=5;; esac;;
  *[!0-9.%]*) echo "AQM=$AQM: a share of the pixels, such as 5%" >&2; exit 2;;
esac
list=
sed -n '/^ "segments"/,$ s/^   "\(first\|last\)": \([0-9]*\),$/\2/p' "$OUT/plan.json" |
  paste -d ' ' - - > "$work/segments"
while read -r first last; do
  segment "$first" "$last" < /dev/null
done < "$work/segments"
printf '{"format": "tempolux measured", "version": "1.0", "segments": [\n%s\n]}\n' "$list" > "$table.$$" &&
  mv -f "$table.$$" "$table" && rm -rf "$runs"
echo "$table: what was measured"
[ "$METHOD" != preview ] || echo "MEASURED=$table lets make take the photons that it asks for"
