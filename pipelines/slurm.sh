#!/bin/sh
# slurm.sh -- submits the jobs of a plan (jobs.sh) to Slurm and watches them: `make slurm` (docs/farm.md).
#
#     slurm.sh submit        run inside OUT by run.sh: ends when all jobs have ended; with 2 if files are missing then
#     slurm.sh task ARRAY    on a node: runs the job in line $SLURM_ARRAY_TASK_ID of ARRAY
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
  ids=$(sed 's/_.*//' "$work/tasks" 2> /dev/null | sort -un | paste -sd,)
  [ -n "$ids" ] || return 0
  patiently squeue -h -r -u "$(id -un)" -o '%i %t %r' > "$work/queue" || exit 3
  awk -v ids="$ids" '
    BEGIN { n = split(ids, list, ","); for (i = 1; i <= n; ++i) ours[list[i]] }
    { id = $1; sub(/_.*/, "", id); if (id in ours) print }' "$work/queue"
}

# The next array: jobs without a task whose predecessors all have one. Prints its names, after a line with the
# predecessors' tasks, megabytes and seconds.
next_array() {
  awk -F '\t' -v given="$work/given" '
    BEGIN { while ((getline line < given) > 0) { split(line, of, " "); task[of[1]] = of[2] } }
    { name[++jobs] = $1; megabytes[$1] = $2; seconds[$1] = $3; before[$1] = $4; listed[$1] }
    END {
      for (j = 1; j <= jobs; ++j) {
        if (name[j] in task) continue
        ready = 1; tasks = ""
        n = split(before[name[j]], list, " ")
        for (i = 1; i <= n; ++i) {
          if (!(list[i] in task)) { ready = 0; break }
          one = task[list[i]]
          if (n > 20) sub(/_.*/, "", one)   # whole arrays: a short list
          if (index(tasks ":", ":" one ":") == 0) tasks = tasks ":" one
        }
        if (!ready || (chosen && before[name[j]] != waits_for)) continue
        if (!chosen) { waits_for = before[name[j]]; after = tasks }
        if (++chosen > 1000) break   # of Slurm: MaxArraySize is 1001
        if (megabytes[name[j]] > memory) memory = megabytes[name[j]]
        if (seconds[name[j]] > time) time = seconds[name[j]]
        names = names name[j] "\n"
      }
      if (chosen) printf "%s %d %d\n%s", after ? after : "-", memory, time, names
    }' "$JOBS"
}

# Submits what is missing and is not in the queue.
submit() {
  JOBS=$work/jobs.$round.$$
  sh "$PIPELINES/jobs.sh" list > "$JOBS"
  # A job whose files a task in the queue makes has that task.
  tasks_alive > "$work/alive.all" || return
  cut -d' ' -f1 "$work/alive.all" > "$work/alive"
  awk -F '\t' -v alive="$work/alive" -v tasks="$work/tasks" '
    BEGIN {
      while ((getline one < alive) > 0) lives[one]
      while ((getline line < tasks) > 0) {
        n = split(line, word, " ")
        if (word[1] in lives) for (i = 2; i <= n; ++i) makes[word[i]] = word[1]
      }
    }
    { split($5, file, " "); if (file[1] in makes) print $1, makes[file[1]] }' "$JOBS" > "$work/given"
  array=0
  while next_array > "$work/next" && [ -s "$work/next" ]; do
    array=$((array + 1))
    names=$work/array.$round.$$.$array
    sed 1d "$work/next" > "$names"
    read -r after memory time < "$work/next"
    [ "$after" = - ] && after= || after=--dependency=afterok$after
    time=$(((time << round) / 60 + 1))
    patiently squeue -h -t S > "$work/queue" || return   # the controller answers
    id=$(JOBS=$JOBS sbatch --parsable -J "tempolux-$(head -n 1 "$names")" -a "1-$(wc -l < "$names")" $after \
      --kill-on-invalid-dep=yes --requeue -n1 -c"${THREADS:-1}" --mem="$((memory << round))" --time="$time" \
      --open-mode=append -o "$work/said.%A_%a" --wrap "exec sh \"\$PIPELINES/slurm.sh\" task $names") || return
    id=${id%%;*}
    awk -F '\t' -v names="$names" -v id="$id" '
      BEGIN { while ((getline name < names) > 0) task[name] = id "_" ++n }
      $1 in task { print task[$1], $5 }' "$JOBS" >> "$work/tasks"
    awk -v id="$id" '{ print $1, id "_" NR }' "$names" >> "$work/given"
  done
}

# Prints a line for each job whose files are there, and why jobs wait.
watch() {
  told='' sheet=$(sed -n 's|^sheet.png: . \([^ ]*\) .*|\1|p' "$PLAN")
  while :; do
    tasks_alive > "$work/alive" || exit 3
    while read -r name task; do
      [ -n "$task" ] && ! grep -q "^$task " "$work/alive" && ! grep -qx "$name" "$PROGRESS" || continue
      made=yes
      for file in $(awk -v task="$task" '$1 == task { $1 = ""; print }' "$work/tasks"); do
        [ "$file" != demo ] || file=$sheet
        [ -e "$file" ] || made=
      done
      [ -z "$made" ] || sh "$PIPELINES/progress.sh" job "$name"
    done < "$work/given"
    [ -s "$work/alive" ] || return 0
    why=$(awk '$2 == "R" || $2 == "CG" { runs = 1 }
      $2 == "PD" && $3 !~ /None|Dependency/ { n++; $1 = $2 = ""; why = $0 }
      END { if (n && !runs) { sub(/^ */, "", why); print n " jobs wait: " why } }' "$work/alive")
    [ -z "$why" ] || [ "$why" = "$told" ] || echo "$why"
    told=$why
    ending sleep 1
  done
}

cancel_all() { sed 's/_.*//' "$work/tasks" | sort -u | xargs -r scancel 2> /dev/null; }
cancel() { cancel_all; stop; }

submit_all() {
  work=state/slurm-$( (echo "$GROUP"; cat "$PLAN") | cksum | tr ' ' -)
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
    cut -f 5 "$work/missing" | sed 's/ .*//; /^demo$/d' |
      sed "s/\$/: not made; its job is submitted again ($round of ${RETRIES:-2})/" >&2
    rm -f "$work"/failed.*
  done
  rm -rf "$work"
}

case $1 in
  submit) submit_all;;
  task)
    export ENVIRONMENT="$OUR_ENVIRONMENT" RUN=env PROGRESS='' CLAIMS='' NEEDS=''
    export FAILED="${2%/*}/failed.${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
    unset MAKEFLAGS MFLAGS MAKELEVEL
    [ -z "$THREADS" ] && TEMPOLUX_THREADS=$SLURM_CPUS_PER_TASK && export TEMPOLUX_THREADS
    exec sh "$PIPELINES/job.sh" run "$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$2")";;
  *) echo "slurm.sh: '$1' is none of submit, task" >&2; exit 2;;
esac
