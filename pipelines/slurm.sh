#!/bin/sh
# slurm.sh -- submits the jobs of a plan (jobs.sh) to Slurm and watches them: `make slurm` (docs/farm.md).
#
#     slurm.sh submit        run inside OUT by run.sh: ends when all jobs have ended; with 2 if files are missing then
#     slurm.sh forget        the same, if no file is missing: removes what a killed make has left of this plan
#     slurm.sh task ARRAY    on a node: runs the job in line $SLURM_ARRAY_TASK_ID of the file ARRAY
#
# Jobs that wait for the same jobs are one array. Slurm itself runs on if the machine of make dies: the list of what was
# submitted is in state/slurm-KEY, and the same command finds it there, waits for the jobs that are still in the queue
# and submits what is missing. Ctrl-C cancels all of them. KEY is a hash of the plan, so other wishes have a folder of
# their own; two makes with equal wishes run one after the other.
. "${0%/*}/made.sh"

# patiently COMMAND...: again while Slurm's controller does not answer, for ten minutes.
patiently() {
  tried=0
  until "$@"; do
    tried=$((tried + 1))
    [ $tried -lt 120 ] || return 1
    [ $tried -gt 1 ] || echo "make slurm: $1 has failed; it is tried again for ten minutes" >&2
    ending sleep 5
  done
}

tasks_alive() {   # prints the tasks of this plan that are in the queue: TASK STATE REASON
  [ -s "$work/tasks" ] || return 0
  patiently squeue -h -r -u "$(id -un)" -o '%i %t %r' > "$work/queue" || exit 3
  awk '
    { array = $1; sub(/_.*/, "", array) }
    FILENAME ~ /tasks$/ { ours[array]; next }
    array in ours' "$work/tasks" "$work/queue"
}

# Divides into arrays the jobs of the list that no task in the queue makes. Jobs of an array wait for the same jobs, and
# each of these has a task or is in an earlier array. For each array: writes a file NAMES.N with a line NAME, tab, FILES
# for each job, and prints a line: N JOBS MEGABYTES SECONDS AFTER. AFTER holds a shell variable in the place of each
# number that Slurm has not given yet: ":12_3:${array_1}_7:${array_2}". Writes to the file `given` the name and the task
# of each job that has a task.
arrays() {   # arrays NAMES
  awk -F '\t' -v names="$1" -v alive="$work/alive" -v tasks="$work/tasks" -v given="$work/given" '
    BEGIN {
      while ((getline line < alive) > 0) { split(line, word, " "); lives[word[1]] }
      while ((getline line < tasks) > 0) {
        n = split(line, word, " ")
        if (word[1] in lives) for (i = 2; i <= n; ++i) makes[word[i]] = word[1]
      }
      printf "" > given
    }
    {
      split($5, file, " ")
      if (file[1] in makes) { task[$1] = makes[file[1]]; print $1, task[$1] > given; next }
      name[++jobs] = $1; megabytes[jobs] = $2; seconds[jobs] = $3; before[jobs] = $4; files[jobs] = $5
    }
    # The tasks of the jobs that job j waits for; "": one of them has no task yet.
    function tasks_before(j,   i, n, list, one, all) {
      n = split(before[j], list, " ")
      all = ":"
      for (i = 1; i <= n; ++i) {
        if (!(list[i] in task)) return ""
        one = task[list[i]]
        if (n > 20) sub(/_[0-9]*$/, "", one)   # whole arrays: a short list
        if (index(all, ":" one ":") == 0) all = all one ":"
      }
      return all
    }
    # The next array begins with the first job that can be in one.
    function next_array(   j, first, after, many, memory, time, member) {
      for (j = 1; j <= jobs && many < 1000; ++j) {   # MaxArraySize of Slurm is 1001
        if (name[j] in task || (first && before[j] != before[first])) continue
        if (!first) { if ((after = tasks_before(j)) == "") continue; first = j; ++array }
        member[++many] = j
        if (megabytes[j] > memory) memory = megabytes[j]
        if (seconds[j] > time) time = seconds[j]
        print name[j] "\t" files[j] > (names "." array)
      }
      for (j = 1; j <= many; ++j) task[name[member[j]]] = "${array_" array "}_" j
      if (many) { close(names "." array); sub(/:$/, "", after); print array, many, memory, time, after }
      return many
    }
    END { while (next_array()) ; }' "$JOBS"
}

# Submits what is missing and is not in the queue.
submit() {
  JOBS=$work/jobs.$round.$$ names=$work/array.$round.$$
  sh "$PIPELINES/jobs.sh" list > "$JOBS"
  tasks_alive > "$work/alive" || return
  arrays "$names" > "$work/arrays" || return
  while read -r number jobs memory time after; do
    eval "after=$after"   # numbers of arrays that were submitted
    time=$(((time << round) / 60 + 1))
    patiently squeue -h -t S > "$work/queue" || return   # the controller answers
    read -r name _ < "$names.$number"
    id=$(JOBS=$JOBS sbatch --parsable -J "tempolux-$name" -a "1-$jobs" ${after:+"--dependency=afterok$after"} \
      --kill-on-invalid-dep=yes --requeue -n1 -c"${THREADS:-1}" --mem="$((memory << round))" --time="$time" \
      --open-mode=append -o "$work/said.%A_%a" --wrap "exec sh \"\$PIPELINES/slurm.sh\" task $names.$number" \
      < /dev/null) || return
    id=${id%%;*}
    eval "array_$number=$id"
    awk -F '\t' -v id="$id" -v given="$work/given" '
      { print id "_" NR, $2; print $1, id "_" NR >> given }' "$names.$number" >> "$work/tasks"
  done < "$work/arrays"
}

# Prints "ended NAME" for each job that is not in the queue any more, whose files are there, and that PROGRESS does not
# name yet. Prints "why N jobs wait: REASON" if jobs wait and none runs.
look() {
  awk -v alive="$work/alive" -v tasks="$work/tasks" -v progress="$PROGRESS" -v sheet="$1" '
    function there(file,   line, found) { found = (getline line < file) >= 0; close(file); return found }
    BEGIN {
      while ((getline < alive) > 0) {
        lives[$1]
        if ($2 == "R" || $2 == "CG") runs = 1
        if ($2 == "PD" && $3 !~ /None|Dependency/) { waiting++; sub(/^[^ ]* [^ ]* */, ""); why = $0 }
      }
      while ((getline name < progress) > 0) said[name]
      while ((getline < tasks) > 0) { task = $1; sub(/^[^ ]* */, ""); files[task] = $0 }
      if (waiting && !runs) print "why " waiting " jobs wait: " why
    }
    $2 in lives || $1 in said { next }
    {
      n = split(files[$2], list, " ")
      for (i = 1; i <= n; ++i) if (!there(list[i] == "demo" ? sheet : list[i])) next
      print "ended " $1
    }' "$work/given"
}

# Prints a line for each job whose files are there, and why jobs wait.
watch() {
  told='' sheet=$(sed -n 's|^sheet.png: . \([^ ]*\) .*|\1|p' "$PLAN")
  while :; do
    tasks_alive > "$work/alive" || exit 3
    # Slurm holds a job that a node could not start until somebody releases it: it is submitted again instead.
    sed -n 's/ PD launch.failed.requeued.held$//p' "$work/alive" | xargs -r scancel 2> /dev/null
    look "$sheet" > "$work/seen"
    why=
    while read -r what words; do
      case $what in ended) sh "$PIPELINES/progress.sh" job "$words";; why) why=$words;; esac
    done < "$work/seen"
    [ -s "$work/alive" ] || return 0
    [ -z "$why" ] || [ "$why" = "$told" ] || echo "$why"
    told=$why
    ending sleep 1
  done
}

cancel_all() { sed 's/_.*//' "$work/tasks" | sort -u | xargs -r scancel 2> /dev/null; }
cancel() { cancel_all; stop; }

named() { work=state/slurm-$( (echo "$GROUP"; cat "$PLAN") | cksum | tr ' ' -); }

# Removes the folder of this plan, when all files are there. Cancels what is still in the queue: a controller that was
# killed may put an ended job into the queue again.
done_with() {
  [ ! -f "$work/tasks" ] || cancel_all
  rm -rf "$work"
}

# Removes the folder of this plan if a make of this plan was killed. Its jobs have made all files since.
forget() {
  named
  [ -d "$work" ] || exit 0
  exec 6> "state/.${work#state/}"
  ! command -v flock > /dev/null || flock -n 6 || exit 0
  done_with
}

submit_all() {
  named
  exec 6> "state/.${work#state/}"
  ! command -v flock > /dev/null || flock -n 6 ||
    { echo 'another make watches these jobs; this one waits for it'; flock 6; }
  mkdir -p "$work" || exit 3
  cp "$PLAN" "$work/plan.mk" && cp "$PLAN_JSON" "$work/plan.json" || exit 3
  export OUR_ENVIRONMENT="$ENVIRONMENT"   # sbatch sets ENVIRONMENT=BATCH in a job
  export PLAN="$work/plan.mk" PLAN_JSON="$work/plan.json" JOBS PROGRESS RETRIES WAIT BEGAN
  BEGAN=$(date +%s) round=0 UNIT=job
  export UNIT
  PROGRESS=$work/finished.$$
  trap cancel INT TERM
  while :; do
    : > "$PROGRESS"
    submit || { cancel_all; exit 3; }
    [ -s "$JOBS" ] || break
    [ $round -gt 0 ] || TOTAL=$(wc -l < "$JOBS") sh "$PIPELINES/progress.sh" begin
    watch
    sh "$PIPELINES/jobs.sh" list > "$work/missing"
    [ -s "$work/missing" ] || break
    if [ $round -ge "${RETRIES:-2}" ] || cat "$work"/failed.* 2> /dev/null | grep -q 'ended with [23]$'; then
      cat "$work"/failed.* 2> /dev/null | sort -u >> "$FAILED"
      rm -f "$work"/failed.*
      exit 2
    fi
    round=$((round + 1))
    awk -v round="$round of ${RETRIES:-2}" '
      { split($0, field, "\t"); split(field[5], file, " ") }
      file[1] != "demo" { print file[1] ": not made; its job is submitted again (" round ")" }' "$work/missing" >&2
    rm -f "$work"/failed.*
  done
  done_with
}

case $1 in
  submit) submit_all;;
  forget) forget;;
  task)
    export ENVIRONMENT="$OUR_ENVIRONMENT" RUN=env PROGRESS='' CLAIMS='' NEEDS=''
    export FAILED="${2%/*}/failed.${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
    unset MAKEFLAGS MFLAGS MAKELEVEL
    [ -z "$THREADS" ] && TEMPOLUX_THREADS=$SLURM_CPUS_PER_TASK && export TEMPOLUX_THREADS
    exec sh "$PIPELINES/job.sh" run "$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$2" | cut -f 1)";;
  *) echo "slurm.sh: '$1' is none of submit, forget, task" >&2; exit 2;;
esac
