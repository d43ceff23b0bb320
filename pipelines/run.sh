#!/bin/sh
# run.sh GOAL -- asks scene-plan what the frames need, then makes the goal inside OUT with the rules of stages.mk.
#
# Makefile.example runs this script and exports its variables. File names stay in quoted variables from here to the
# commands.
set -f   # words are split at blanks and nothing else
absolute() {   # absolute NAME: makes the variable an absolute path if it names a file
  eval "value=\$$1"
  case $value in '' | /* | none) ;; *) eval "$1=\$PWD/\$value" ;; esac
  export "${1?}"
}
[ -n "$SCENE" ] || SCENE=$TOP/pipelines/scenes/evening.glb
if [ -z "$BIN" ]; then
  if [ -f "$TOP/CMakeLists.txt" ]; then BIN=$TOP/build/release/bin; else BIN=$(command -v scene-plan); BIN=${BIN%/*}; fi
fi
for name in SCENE OUT OTHER BIN ENVIRONMENT VOLUME MEASURED; do absolute $name; done
goal=$1 film='' slurm=''
case $goal in "${OUT#"$PWD/"}"/*) goal=${goal#"${OUT#"$PWD/"}/"} ;; esac
[ -z "$THREADS" ] || export TEMPOLUX_THREADS="$THREADS"
dry=; case "${MAKEFLAGS%% *}" in *n*) [ "${MAKEFLAGS#-}" = "$MAKEFLAGS" ] && dry=yes ;; esac
quiet=; case "${MAKEFLAGS%% *}" in *s*) [ "${MAKEFLAGS#-}" = "$MAKEFLAGS" ] && quiet=yes ;; esac
export PIPELINES="$TOP/pipelines" RULES="$TOP/pipelines/stages.mk"
[ -x "$BIN/scene-plan" ] || [ -n "$dry" ] ||
  { echo "BIN=$BIN: holds no scene-plan; name the folder of the tools, or leave BIN out to build them" >&2; exit 2; }
case $WAIT in *[!0-9]*) echo "WAIT=$WAIT: give whole seconds" >&2; exit 2;; esac
case $NODES, in *[!0-9,]* | *,0* | 0* | *,,*) [ -z "$NODES" ] ||
  { echo "NODES=$NODES: give whole numbers above 0, divided by commas" >&2; exit 2; };;
esac
for name in CORES THREADS; do
  eval "value=\$$name"
  case $value in *[!0-9]* | 0*) echo "$name=$value: give a whole number above 0" >&2; exit 2;; esac
done
case $GROUP in
  '' | frame | segment | stage) ;;
  *) echo "GROUP=$GROUP: is none of frame, segment, stage" >&2; exit 2;;
esac
case $RETRIES in *[!0-9]*) echo "RETRIES=$RETRIES: give a whole number" >&2; exit 2;; esac
case $goal in
  tidy) exec sh "$PIPELINES/tidy.sh" "$OUT";;
  compare) exec sh "$PIPELINES/compare.sh" "$OUT" "$OTHER" "$OUT/compare.html";;
  film) film=yes goal=demo;;
  slurm)
    command -v sbatch > /dev/null ||
      { echo 'make slurm: there is no sbatch; run it where jobs are submitted' >&2; exit 2; }
    slurm=yes goal=demo
    [ -n "$RUN" ] || RUN='srun -Q -n1 -c{threads} --mem={mem} --time={time}'
    export THREADS="${THREADS:-1}"
    [ "$GROUP" = segment ] || GROUP=frame
    export RUN GROUP;;
esac

# The wish as options. The preset decides about empty variables.
set -- "$SCENE" --frames "$FRAMES" --size "$SIZE" --quality "$QUALITY" --channels "$CHANNELS" --camera "$CAMERA" \
  --method "$METHOD" --filter "$FILTER" --indirect "$INDIRECT" --moving "$MOVING" --split "$SPLIT" \
  --strategy "$STRATEGY" --key-distance "$KEY_DISTANCE" --report "$(echo "$REPORT_FRAMES" | tr " " ,)" \
  --reference-samples "$REFERENCE_SAMPLES"
for pair in update:UPDATE refine:REFINE photons:PHOTONS pixel-error:ERROR halve-above:THRESHOLD \
  light-units:LIGHT_UNITS environment:SKY measured:MEASURED ${MEASURED:+aqm:AQM} environment:ENVIRONMENT \
  volume:VOLUME exposure:EXPOSURE f-stop:FSTOP focus:FOCUS sensor-width:SENSOR_WIDTH \
  shutter:SHUTTER shutter-open:SHUTTER_OPEN shot:SHOT; do
  eval "value=\$${pair#*:}"
  [ -z "$value" ] || set -- "$@" "--${pair%%:*}=$value"
done
for pair in points:POINTS records:CACHE pixels:PIXELS smoke:SMOKE; do
  eval "value=\$${pair#*:}"
  [ -z "$value" ] || set -- "$@" --words "${pair%%:*}:$value"
done
# shellcheck disable=SC2086
set -- "$@" $VOLUME_OPTIONS $TIME --recipes "$TOP/pipelines/stages.mk" --recipes "$TOP/pipelines/walkthrough.sh" \
  --recipes "$TOP/pipelines/show.sh"

. "${0%/*}/made.sh"
plan=plan.mk folder=$OUT copies='' planning='' fresh='' ran_jobs=''
ours=tmp.$(uname -n).$$   # ends the names of the files and folders of this make
[ -d "$OUT" ] || fresh=yes
# Makes a folder that all machines see, if RUN is set: other machines see OUT, and not /tmp.
shared_aside() {
  [ -n "$RUN" ] && { [ -z "$dry" ] || [ "$goal" = estimate ]; } && mkdir -p "$OUT/state" || return
  aside=$OUT/state/.make.$ours
  mkdir "$aside"
}
shared_aside 2> /dev/null || aside=$(mktemp -d) || exit 3
# Removes what makes of this machine have left in state that were killed.
sweep() (
  set +f
  for left in "$OUT"/state/.*."${ours%.*}".*; do
    process=${left##*."${ours%.*}".}
    [ -d "/proc/${process%%.*}" ] || rm -rf "$left"
  done
  for left in "$OUT"/state/.*.claim; do
    { read -r of process _ < "$left"; } 2> /dev/null && [ "$of" = "$(uname -n)" ] && [ ! -d "/proc/$process" ] &&
      rm -f "$left"
  done
)
# Removes the files of this make, and what its killed commands have left unfinished. Removes an OUT that this make has
# made, too, if OUT holds no plan and no other file.
clean_up() {
  [ ! -s "$aside/commands" ] && [ -z "$ran_jobs" ] || { sh "$PIPELINES/tidy.sh" "$OUT" > /dev/null; sweep; }
  rm -rf "$aside"
  [ -z "$copies" ] || rm -f "$OUT/$plan" "$OUT/$PLAN_JSON"
  [ -z "$fresh" ] || [ -e "$OUT/plan.mk" ] || {
    [ -z "$planning" ] || rm -f "$OUT/state/.planning"
    rmdir "$OUT/state" "$OUT" 2> /dev/null
  }
}
trap clean_up EXIT
export FAILED="$aside/failed" CLAIMS="$aside/claims"
mkdir "$CLAIMS" || exit 3
makes() {   # runs in a subshell; after an error all that does not need the lost file is made (-k)
  goal=$1; shift
  exec ${MAKE:-make} -k --no-print-directory -f "$RULES" PLAN="$plan" "$@" "$goal"
}
makes_sample() { export PROGRESS TOTAL WEIGHT BEGAN; makes demo passing= -s -C "$aside"; }
spend() {   # sets `spent` to the CPU seconds of all processes that this shell has started and that have ended
  times > "$aside/times"
  spent=$(awk -F '[ms ]+' '{ gsub(",", ".") } NR == 2 { printf "%.3f", 60 * ($1 + $3) + $2 + $4 }' "$aside/times")
}
estimate() {   # makes the first picture at two small sizes; prints options of scene-plan
  wanted=estimate
  made "$aside/small.mk" "$aside/large.mk" "$aside/planned.json" -- $RUN "$BIN/scene-plan" "$@" --estimate "$aside" \
    --stats "$aside/planned.json" || exit
  wanted=
  spend; before=$spent
  # Both samples write their progress to a file that nobody reads, because printing costs time in a run, too.
  for plan in small.mk large.mk; do
    : > "$aside/said"
    PROGRESS=said TOTAL=0 WEIGHT=0 BEGAN=0 PLAN="$plan" ending makes_sample > /dev/null || exit
  done
  spend; awk "BEGIN { print $spent - $before }" > "$aside/made"
  "$BIN/scene-plan" --estimate "$aside" || exit
  # A plan in OUT says from now on what its commands cost.
  [ ! -f "$OUT/state/inputs" ] || { cp "$aside/costs.json" "$OUT/state" && rm "$OUT/state/inputs"; }
}
forecast() {   # the same run on NODES machines of CORES processors; options of scene-plan
  mkdir -p "$aside/whole/state" && cp "$aside/costs.json" "$aside/whole/state" || exit 3
  wanted=forecast
  made "$aside/whole/plan.mk" -- $RUN "$BIN/scene-plan" "$@" -q -o "$aside/whole" || exit
  [ "$GROUP" = segment ] || export GROUP=frame
  (cd "$aside/whole" && PLAN=plan.mk PLAN_JSON=plan.json NODES=${NODES:-1} CORES=${CORES:-$(nproc)} \
    sh "$PIPELINES/jobs.sh" forecast)
}
if [ "$goal" = estimate ]; then
  estimate "$@"
  [ -z "$NODES$CORES" ] || forecast "$@"
  exit
fi
if [ -n "$dry" ]; then   # make -n: the plan is written to another folder, which is removed
  [ -x "$BIN/scene-plan" ] || { echo "$RUN $BIN/scene-plan $* -o $OUT"; exit; }
  echo "$RUN $BIN/scene-plan $* -o $OUT"
  "$BIN/scene-plan" "$@" -o "$aside" -q || exit
  plan=$aside/plan.mk
  [ -d "$OUT" ] || folder=$aside
else
  # Makes in one OUT plan one after the other. Each one holds the lock until it has a copy of its plan. A make without a
  # plan may have removed OUT and the lock: then the lock is taken again.
  for try in 1 2 3; do
    mkdir -p "$OUT/state" 2> /dev/null
    command -v flock > /dev/null && [ -w "$OUT/state" ] || break
    { command exec 7> "$OUT/state/.planning"; } 2> /dev/null && ending flock 7 || continue
    [ "$OUT/state/.planning" -ef /proc/self/fd/7 ] && planning=yes && break
  done
  # scene-plan rewrites only what has changed. Statistics are new after each run: they show that RUN has run it.
  ran=
  if [ -n "$RUN" ] && [ -w "$OUT/state" ]; then
    ran=$OUT/state/planned.json
    set -- "$@" --stats "$ran"
  fi
  wanted=plan.mk
  # shellcheck disable=SC2086
  made ${ran:+"$ran"} -- $RUN "$BIN/scene-plan" "$@" -o "$OUT" || exit
  wanted=
  # A walkthrough reads its plan again and again, and a second make in OUT may write another one meanwhile.
  # A finished OUT may lie on a disk that is read only.
  if [ -w "$OUT/state" ]; then
    plan=state/.plan.mk.$ours copies=yes
    export PLAN="$plan" PLAN_JSON="state/.plan.json.$ours"
    sweep
    cp "$OUT/plan.mk" "$OUT/$plan" && cp "$OUT/plan.json" "$OUT/$PLAN_JSON" || exit
  fi
  exec 7>&-
  planning=
fi
[ "$goal" = plan ] && exit
case $goal in frames/*)
  [ -n "$dry" ] || grep -q "^${goal%.*}[.]exr:" "$OUT/plan.mk" ||
    { echo "$goal: is none of FRAMES=$FRAMES" >&2; exit 2; };;
esac
if [ "$goal" = timeline ] && [ -z "$dry" ]; then
  (cd "$OUT" && sh "$PIPELINES/timeline.sh" timeline.json) && echo "look at $OUT/timeline.json, for instance with ui.perfetto.dev"
  exit
fi
if [ "$goal" = measure ] && [ -z "$dry" ]; then ending sh "$PIPELINES/measure.sh"; exit; fi
if [ -n "$dry" ]; then (makes "$goal" -C "$folder"); exit; fi

# With RUN, commands are joined into jobs first. What they leave, such as the copy of a frame that was removed, is made
# by the rules as below.
slurm() {
  ran_jobs=yes
  (cd "$OUT" && sh "$PIPELINES/jobs.sh" list) > "$aside/jobs" || exit
  [ -s "$aside/jobs" ] || { ran_jobs=; [ -z "$copies" ] || (cd "$OUT" && sh "$PIPELINES/slurm.sh" forget); return 0; }
  (cd "$OUT" && exec sh "$PIPELINES/slurm.sh" submit) & child=$!
  wait "$child" || failed $?
  child=
}
jobs() {
  export JOBS="$aside/jobs" PROGRESS="$aside/finished" UNIT=job
  (cd "$OUT" && sh "$PIPELINES/jobs.sh" list) > "$JOBS" || exit
  [ -s "$JOBS" ] || return 0
  sh "$PIPELINES/jobs.sh" makefile < "$JOBS" > "$aside/jobs.mk"
  : > "$PROGRESS"
  TOTAL=$(wc -l < "$JOBS") BEGAN=$(date +%s) ran_jobs=yes
  export TOTAL BEGAN
  (cd "$OUT" && sh "$PIPELINES/progress.sh" begin)
  ending makes_jobs || failed $?
}
makes_jobs() { exec ${MAKE:-make} -k --no-print-directory -f "$aside/jobs.mk" -C "$OUT" all; }
case $RUN in *'{'*) export NEEDS="$aside/needs"; (cd "$OUT" && sh "$PIPELINES/jobs.sh" needs) > "$NEEDS";; esac
# Every make in OUT holds a lock, so that one that fails can see whether another one still runs.
[ ! -w "$OUT/state" ] || exec 8> "$OUT/state/.makes"
alone() { ! command -v flock > /dev/null || [ ! -w "$OUT/state" ] || flock "$@" 8; }
alone -s
failed() {
  alone -n -x ||
    echo "$OUT: another make runs here and may have removed a file that this one was to read; type this again" >&2
  (cd "$OUT" && sh "$PIPELINES/progress.sh" failed "$goal") >&2
  exit "$1"
}
if [ -n "$slurm" ]; then slurm
elif [ -n "$RUN" ] && [ "$goal" = demo ] && [ "${GROUP:=stage}" != stage ]; then jobs
fi

# The commands that will run are those that make -n prints. progress.sh counts them. If there are none, make need not
# read a long plan once more.
PROGRESS=$aside/progress BEGAN=$(date +%s)
(MAKEFLAGS='' V='' makes "$goal" -C "$folder" -n -s) > "$aside/commands" 2> /dev/null ||
  echo "$goal" >> "$aside/commands"
sed -n 's|.*/progress[.]sh" say \([^ ]*\) .*|\1|p' "$aside/commands" > "$PROGRESS"
TOTAL=$(wc -l < "$PROGRESS") WEIGHT=$(cd "$OUT" && sh "$PIPELINES/progress.sh" weigh < "$PROGRESS")
: > "$PROGRESS"
export TOTAL WEIGHT PROGRESS BEGAN
[ "$TOTAL" = 0 ] || (cd "$OUT" && UNIT='' sh "$PIPELINES/progress.sh" begin)
if [ "$TOTAL" -ge 500 ]; then   # a long run: estimate hours and disk first, by short runs of each stage
  (estimate "$@")
  df -h "$OUT" | awk 'NR == 2 { print "free where OUT is: " $4 }'
fi
if [ -s "$aside/commands" ]; then
  ending makes "$goal" -C "$folder" || failed $?
elif [ -z "$quiet$ran_jobs" ]; then
  echo "make: Nothing to be done for '$goal'; look at $OUT/sheet.png"
fi
# Raw frames that a killed make had filtered and not removed yet.
raw=$(set +f; cd "$OUT" && for file in raw/*.exr; do ! grep -q "^passing :=.* $file" "$plan" || echo "$file"; done)
# shellcheck disable=SC2086
[ -z "$raw" ] || (cd "$OUT" && sh "$PIPELINES/follow.sh" read $raw)
[ ! -s "$aside/commands" ] && [ -z "$ran_jobs" ] || [ "$goal" != demo ] ||
  (cd "$OUT" && sh "$PIPELINES/progress.sh" end) || exit
if [ "$goal" = report ]; then
  echo "look at $OUT/report/index.html"
  # Curves and steadiness need the scripts of the sources.
  own=$TOP/tests/bench/own_scene.py
  [ ! -f "$own" ] || ! command -v python3 > /dev/null || python3 -B "$own" || exit
fi
[ -z "$film" ] || { cd "$OUT" && ending sh "$PIPELINES/film.sh"; }
