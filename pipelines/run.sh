#!/bin/sh
# run.sh GOAL -- asks scene-plan what the frames need, then makes the goal inside OUT with the rules of stages.mk.
#
# Makefile.example runs this script and exports its variables. File names stay in quoted variables from here to the
# commands.
set -f   # words are split at blanks and nothing else
absolute() {   # absolute NAME: the variable, if it names a file, by its whole path
  eval "value=\$$1"
  case $value in '' | /* | none) ;; *) eval "$1=\$PWD/\$value" ;; esac
  export "${1?}"
}
[ -n "$SCENE" ] || SCENE=$TOP/pipelines/scenes/evening.glb
if [ -z "$BIN" ]; then
  if [ -f "$TOP/CMakeLists.txt" ]; then BIN=$TOP/build/release/bin; else BIN=$(command -v scene-plan); BIN=${BIN%/*}; fi
fi
for name in SCENE OUT OTHER BIN ENVIRONMENT VOLUME MEASURED; do absolute $name; done
goal=$1 film=
case $goal in "${OUT#"$PWD/"}"/*) goal=${goal#"${OUT#"$PWD/"}/"} ;; esac
dry=; case "${MAKEFLAGS%% *}" in *n*) [ "${MAKEFLAGS#-}" = "$MAKEFLAGS" ] && dry=yes ;; esac
export PIPELINES="$TOP/pipelines"
case $goal in
  tidy) exec "$BIN/scene-plan" --tidy "$OUT";;
  compare) exec sh "$PIPELINES/compare.sh" "$OUT" "$OTHER" "$OUT/compare.html";;
  film) film=yes goal=demo;;
esac

# The wish as options. The preset decides about empty variables.
set -- "$SCENE" --frames "$FRAMES" --size "$SIZE" --quality "$QUALITY" --channels "$CHANNELS" --camera "$CAMERA" \
  --method "$METHOD" --filter "$FILTER" --indirect "$INDIRECT" --moving "$MOVING" --split "$SPLIT" --strategy "$STRATEGY" \
  --key-distance "$KEY_DISTANCE" --report "$(echo "$REPORT_FRAMES" | tr " " ,)" --reference-samples "$REFERENCE_SAMPLES"
for pair in update:UPDATE refine:REFINE photons:PHOTONS rays:RAYS pixel-error:ERROR halve-above:THRESHOLD light-units:LIGHT_UNITS \
  environment-color:SKY measured:MEASURED ${MEASURED:+aqm:AQM} environment:ENVIRONMENT volume:VOLUME point-words:POINTS record-words:CACHE pixel-words:PIXELS \
  smoke-words:SMOKE texture-words:TEXTURES; do
  eval "value=\$${pair#*:}"
  [ -z "$value" ] || set -- "$@" "--${pair%%:*}=$value"
done
case $SURFACES in gather) ;; textures) set -- "$@" --textures ;; *) echo "SURFACES=$SURFACES: gather or textures" >&2; exit 2 ;; esac
# shellcheck disable=SC2086
set -- "$@" $VOLUME_OPTIONS $TIME --recipes "$TOP/pipelines/stages.mk" --recipes "$TOP/pipelines/walkthrough.sh" \
  --recipes "$TOP/pipelines/show.sh"

export PIPELINES="$TOP/pipelines" RULES="$TOP/pipelines/stages.mk"
. "${0%/*}/ending.sh"
plan=plan.mk folder=$OUT
aside=$(mktemp -d) || exit 3
trap 'rm -rf "$aside"' EXIT
makes() { goal=$1; shift; exec ${MAKE:-make} --no-print-directory -f "$RULES" PLAN="$plan" "$@" "$goal"; }   # in a process of its own
estimate() {   # options of scene-plan: the first picture, small, at two sizes
  ending $RUN "$BIN/scene-plan" "$@" --samples "$aside" || exit
  for plan in small.mk large.mk; do PROGRESS='' ending makes demo -s -C "$aside" > /dev/null || exit; done
  "$BIN/scene-plan" --estimate "$aside"
}
if [ "$goal" = estimate ]; then estimate "$@"; exit; fi
if [ -n "$dry" ]; then   # make -n: plan aside, leave no trace
  [ -x "$BIN/scene-plan" ] || { echo "$RUN $BIN/scene-plan $* -o $OUT"; exit; }
  echo "$RUN $BIN/scene-plan $* -o $OUT"
  "$BIN/scene-plan" "$@" -o "$aside" -q || exit
  plan=$aside/plan.mk
  [ -d "$OUT" ] || folder=$aside
else
  # shellcheck disable=SC2086
  ending $RUN "$BIN/scene-plan" "$@" -o "$OUT" || exit
  plan=state/.plan.mk.tmp.$(uname -n).$$   # a walkthrough reads its plan again and again; a second make in OUT writes another one meanwhile
  trap 'rm -rf "$aside" "$OUT/$plan"' EXIT
  cp "$OUT/plan.mk" "$OUT/$plan" || exit
fi
[ "$goal" = plan ] && exit
if [ "$goal" = measure ] && [ -z "$dry" ]; then ending sh "$PIPELINES/measure.sh"; exit; fi
if [ -n "$dry" ]; then (makes "$goal" -C "$folder"); exit; fi

# The commands that will run are those that make -n prints. progress.sh counts them.
PROGRESS=$aside/progress BEGAN=$(date +%s)
MAKEFLAGS='' V='' makes "$goal" -C "$folder" -n 2> /dev/null | sed -n 's|.*/progress[.]sh" say \([^ ]*\) .*|\1|p' > "$PROGRESS"
TOTAL=$(wc -l < "$PROGRESS") WEIGHT=$(sh "$PIPELINES/progress.sh" weigh < "$PROGRESS")
: > "$PROGRESS"
export TOTAL WEIGHT PROGRESS BEGAN
[ "$TOTAL" = 0 ] || (cd "$OUT" && sh "$PIPELINES/progress.sh" begin)
if [ "$TOTAL" -ge 500 ]; then   # hours and disk are worth short runs of each stage
  (estimate "$@")
  df -h "$OUT" | awk 'NR == 2 { print "free where OUT is: " $4 }'
fi
ending makes "$goal" -C "$folder" || exit
[ "$TOTAL" = 0 ] || [ "$goal" != demo ] || (cd "$OUT" && sh "$PIPELINES/progress.sh" end)
[ "$TOTAL$goal$film" != 0demo ] || echo "nothing has changed; look at $OUT/sheet.png"
[ "$goal" != report ] || echo "look at $OUT/report/index.html"
[ -z "$film" ] || { cd "$OUT" && ending sh "$PIPELINES/film.sh"; }
