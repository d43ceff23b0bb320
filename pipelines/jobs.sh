#!/bin/sh
# jobs.sh -- joins the commands of a plan into jobs for a queue (farm.md). run.sh runs it inside OUT.
#
#     jobs.sh list         prints a line for each job that makes something that is missing:
#                          NAME MEGABYTES SECONDS JOBS,BEFORE FILES OPTIONAL_FILES, divided by tabs
#     jobs.sh needs        prints a line for each folder of files: FOLDER MEGABYTES SECONDS of one command
#     jobs.sh makefile     reads a list and prints rules of make for it
#     jobs.sh forecast     prints how long all jobs take on NODES nodes of CORES processors, THREADS for each job
#
# Files that the same pictures need are made by one job. So the files of one picture, from the first that no other
# picture needs to its frame, are a job; light that several pictures share is another one; no two jobs make the same
# file, and no job waits for one that waits for it. With GROUP=segment all pictures of a segment count as one. The last
# job makes the sheet, and those previews whose exposure was not known before the frames existed.
#
# A job that was killed or lost gets twice as many MEGABYTES and SECONDS (made.sh). The environment has PLAN and GROUP.
: "${PLAN:=plan.mk}"

# What a job asks a queue for. Memory: half as much again as the largest command needs, the accuracy of the estimate,
# and 64 MB for the shell and make. Time: twice the CPU seconds, as if the job had one processor, and a minute to start.
margins='
  function megabytes(bytes) { return int(1.5 * bytes / 1e6 + 65) }
  function limit(cpu_seconds) { return int(2 * cpu_seconds + 61) }'

needs() { costs | awk "$margins"'{ print $1, megabytes($2), limit($3) }'; }

# Prints FOLDER BYTES CPU_SECONDS: what commands have cost in this OUT, or the plan's estimate before the first has run.
costs() {
  json=${PLAN_JSON:-plan.json}
  { sed -n 's|^ *{"file": "\([a-z_]*\)/.*"cpu_s": \([^,]*\), "memory": \([0-9]*\)}.*|plan \1 \3 \2|p' "$json" | sort -u
    sed -n 's|^\([a-z_]*/[^.: ]*\)[^:]*: words :=.*|\1.json|p' "$PLAN"
  } | awk '
    function value(line) { sub(/.*: */, "", line); return line + 0 }
    $1 == "plan" { memory[$2] = $3; cpu[$2] = $4; next }
    {
      folder = $0; sub("/.*", "", folder); whole = 1
      while ((getline line < $0) > 0) {
        if (whole && line ~ /"cpu_s":/) { if (value(line) > spent[folder]) spent[folder] = value(line); whole = 0 }
        if (line ~ /"peak_memory_bytes":/ && value(line) > peak[folder]) peak[folder] = value(line)
      }
      close($0)
    }
    END {
      for (folder in memory) print folder, peak[folder] ? peak[folder] : memory[folder],
        spent[folder] ? spent[folder] : cpu[folder]
    }'
}

list() {
  segments=$(sed -n '/^ "segments"/,$ s/^   "\(first\|last\)": \([0-9]*\),$/\2/p' "${PLAN_JSON:-plan.json}" |
    paste -sd ' ')
  { costs; echo; cat "$PLAN"; } | awk -v group="${GROUP:-frame}" -v segments="$segments" -v measured="$MEASURED_ONLY" \
    -v rest="${REST:-0}" -v threads="${THREADS:-1}" \
    -v pixels=$(($(echo "${SIZE:-640x360}" | tr x '*'))) "$margins"'
    function there(file,   line) {
      if (!(file in known)) { known[file] = (getline line < file) >= 0; close(file) }
      return known[file]
    }
    function visit(file, picture,   i, n, list) {   # this picture needs the file, and what it is made from
      if ((file, picture) in visited || there(file)) return
      visited[file, picture]
      if (!(file in needed_by)) order[++files] = file
      needed_by[file] = needed_by[file] " " picture
      n = split(inputs[file], list, " ")
      for (i = 1; i <= n; ++i) visit(list[i], picture)
    }
    function number(file) { sub(/^[^\/]*\//, "", file); sub(/[^0-9].*/, "", file); return file }
    function unit(picture,   i, n, list) {   # a picture, or its segment
      if (group != "segment") return picture
      n = split(segments, list, " ")
      for (i = 1; i < n; i += 2)
        if (number(picture) + 0 >= list[i] && number(picture) + 0 <= list[i + 1]) return list[i]
      return picture
    }
    function folder_of(file) { sub("/.*", "", file); return file }

    !NF { costs = 1; next }
    !costs { bytes[$1] = $2; cpu[$1] = $3; next }
    $2 == ":=" || $2 == "words" { next }
    {   # TARGET FURTHER_TARGETS: | INPUTS
      at = index($0, ": |")
      if (!at || $0 ~ /^\t/) next
      target = $1; sub(/:$/, "", target)
      from = substr($0, at + 3); gsub(/\$\([a-z]*\)/, "", from)
      inputs[target] = from
      n = split(substr($0, 1, at - 1), beside, " ")
      for (i = 2; i <= n; ++i) { inputs[beside[i]] = target; second[beside[i]] }
      if (target ~ /^frames\/.*[.]exr$/) { split(from, of, " "); frames[++shown] = of[1] " " of[2] }
      if (target ~ /^frames\/.*[.]png$/) { split(from, of, " "); previews[of[2]] = previews[of[2]] " " of[1] }
      if (target ~ /^shown\/exposure-/) { split(from, of, " "); exposed = of[1]; exposure = target }
      if (target ~ /^shown\/sheet-/) sheet = target
    }
    END {
      for (i = 1; i <= shown; ++i) { split(frames[i], of, " "); visit(of[1], unit(of[2])); pictures[of[1]] = of[2] }
      # Files by the pictures that need them.
      for (i = 1; i <= files; ++i) {
        file = order[i]; key = needed_by[file]
        if (!(key in name)) {
          is_light = split(key, of, " ") > 1
          keys[++jobs] = key
          name[key] = (is_light ? "light" : group) "-" (number(file) == "" ? "0" : number(file)) "-" jobs
        }
        job[file] = name[key]
        folder = folder_of(file)
        if (folder == "shown") continue
        computes[key]
        if (!(file in second)) seconds[key] += measured ? cpu[folder] / threads + rest : cpu[folder]
        if (bytes[folder] > most[key]) most[key] = bytes[folder]
      }
      # What other jobs read, and what they wait for.
      for (i = 1; i <= files; ++i) {
        file = order[i]; n = split(inputs[file], list, " ")
        for (k = 1; k <= n; ++k) {
          input = list[k]
          if (!(input in job) || job[input] == job[file]) continue
          read[input]
          if ((job[file], job[input]) in waits) continue
          waits[job[file], job[input]]
          before[job[file]] = before[job[file]] " " job[input]
        }
      }
      for (i = 1; i <= files; ++i) {
        file = order[i]; key = needed_by[file]
        if (file in read || folder_of(file) == "shown") makes[key] = makes[key] " " file
        if (!(file in pictures)) continue
        picture = pictures[file]
        if (picture == exposed && !there(exposure) && !given[exposure]++) also[key] = also[key] " " exposure
        also[key] = also[key] previews[picture]
        previews[picture] = ""
      }
      for (j = 1; j <= jobs; ++j) {
        key = keys[j]
        if (!(key in computes)) continue
        print_job(name[key], most[key], seconds[key], before[name[key]], makes[key], also[key])
        all = all " " name[key]
        if (most[key] > largest) largest = most[key]
      }
      looks = shown * 0.75e-6 * pixels
      if (files || !there(sheet)) print_job("last", largest, measured ? looks / threads : looks, all, " demo", "")
    }
    function print_job(name, bytes, seconds, jobs, makes, also) {
      sub(/^ /, "", jobs); sub(/^ /, "", makes); sub(/^ /, "", also)
      if (measured) printf "%s\t%d\t%.3f\t%s\t%s\n", name, bytes / 1e6 + 1, seconds, jobs, makes
      else printf "%s\t%d\t%d\t%s\t%s\t%s\n", name, megabytes(bytes), limit(seconds), jobs, makes, also
    }'
}

# Prints a number of state/costs.json: `plan`, CPU seconds of scene-plan, or `rest`, those of make, shells and previews
# for each command.
cost() { sed -n "s/.*\"$1\":\([^,}]*\).*/\1/p" state/costs.json; }

# First scene-plan runs. Then a job starts as soon as a place is free and what it reads is there, in the order of the
# list, as in a queue. A command takes its CPU seconds divided by its threads. Make and shells have one thread. The last
# job reads each frame three times, once for the digest, the sheet and the account each, and needs .75 us a pixel for
# all three (RGBA, Z, N, id; measured at 1280x720).
forecast() {
  all=$(MEASURED_ONLY=yes REST=$(cost rest) list) PLANNING=$(cost plan)
  for nodes in $(echo "$NODES" | tr , ' '); do echo "$all" | forecast_on "$nodes"; done
}
forecast_on() {
  awk -F '\t' -v nodes="$1" -v cores="$CORES" -v threads="${THREADS:-1}" -v planning="$PLANNING" '
    {
      name[++jobs] = $1; number[$1] = jobs; before[jobs] = $4
      memory[jobs] = $2; takes[jobs] = $3; sum += $3
    }
    END {
      for (j = 1; j <= jobs; ++j) {
        waits[j] = split(before[j], list, " ")
        for (i = 1; i <= waits[j]; ++i) after[number[list[i]]] = after[number[list[i]]] " " j
        if (memory[j] > largest) largest = memory[j]
      }
      places = nodes * int(cores / threads)
      sum += planning / threads
      now = planning / threads
      while (1) {
        for (j = 1; j <= jobs && running < places; ++j)
          if (!(j in ends) && waits[j] == 0) { ends[j] = now + takes[j]; at[++running] = j }
        if (!running) break
        now = ends[at[1]]
        for (k = 2; k <= running; ++k) if (ends[at[k]] < now) now = ends[at[k]]
        going_on = 0
        for (k = 1; k <= running; ++k) {
          j = at[k]
          if (ends[j] > now) { at[++going_on] = j; continue }
          n = split(after[j], list, " ")
          for (i = 1; i <= n; ++i) --waits[list[i]]
        }
        running = going_on
      }
      chain = ""; end = 0
      for (j = 1; j <= jobs; ++j) if (longest(j) > path[end]) end = j
      for (j = end; j; j = through[j]) chain = name[j] (chain ? ", " : "") chain
      busy = now > 0 ? 100 * sum * threads / (now * nodes * cores) : 100
      printf "%d jobs on %d x %d processors, %d for each job: %.1f s, %.0f %% of the processors busy\n", jobs, nodes,
        cores, threads, now, busy
      printf "not less than %.1f s on any number: the plan, %.1f s, then the longest chain of jobs: %s\n",
        planning / threads + path[end], planning / threads, chain
      printf "memory of a job: up to %d MB; of a node: up to %d MB\n", largest, largest * int(cores / threads)
    }
    # Sets path[j]: the least number of seconds from the start of all jobs to the end of this one.
    function longest(j,   i, n, list, earlier) {
      if (j in path) return path[j]
      path[j] = 0
      n = split(before[j], list, " ")
      for (i = 1; i <= n; ++i) {
        earlier = longest(number[list[i]])
        if (earlier > path[j]) { path[j] = earlier; through[j] = number[list[i]] }
      }
      return path[j] += takes[j]
    }'
}

makefile() {
  awk -F '\t' '{ print $1 ": " $4; all = all " " $1 }
    END { print "all:" all "\n" all ":\n\t@exec sh \"$$PIPELINES/job.sh\" run $@\n.PHONY: all" all "\n.SUFFIXES:" }'
}

case $1 in
  list | needs | makefile | forecast) $1;;
  *) echo "jobs.sh: '$1' is none of list, needs, makefile, forecast" >&2; exit 2;;
esac
