#!/bin/sh
# timeline.sh FILE -- who ran what when, from the statistics of the plan's files: writes a trace that profilers of
# browsers read (ui.perfetto.dev, chrome://tracing, profiler.firefox.com). run.sh runs it inside OUT.
#
# A command has ended when its statistics were written, by the clock of the disk, which all machines share; it began
# wall_s seconds earlier. A row of the trace is a place on a machine: the first that was free.
# Format: "Trace Event Format" of Chrome, complete events (X), times in microseconds.
: "${PLAN:=plan.mk}"
part=.timeline.json.tmp.$(uname -n).$$
trap 'rm -f "$part"' EXIT
sed -n 's|^\([a-z_]*/[^.: ]*\)[^:]*: words :=.*|\1|p' "$PLAN" |
  while read -r stem; do
    for file in "$stem.json" "$stem.warp.json"; do [ ! -e "$file" ] || stat -c '%.6Y %n' "$file"; done
  done |
  awk '
    function value(line) { sub(/^[^:]*: *"?/, "", line); sub(/"?,?$/, "", line); return line }
    {
      file = $2; host = ""; wall = -1; cpu = memory = threads = 0
      while ((getline line < file) > 0 && line !~ /"phases"/) {
        if (line ~ /^  "tool":/) tool = value(line)
        if (line ~ /^  "host":/) host = value(line)
        if (line ~ /^  "wall_s":/) wall = value(line)
        if (line ~ /^  "cpu_s":/) cpu = value(line)
        if (line ~ /^  "threads":/) threads = value(line)
        if (line ~ /^  "peak_memory_bytes":/) memory = value(line)
      }
      close(file)
      if (wall < 0) next
      printf "%.6f\t%.6f\t%s\t%s\t%s\t%s\t%d\t%d\n", $1 - wall, wall, host, tool, file, cpu, threads, memory / 1e6
    }' | sort -n | awk -F '\t' '
    BEGIN { printf "{\"traceEvents\": [" }
    {
      if (!(NR > 1)) began = $1
      if (!($3 in number)) {
        number[$3] = ++hosts
        printf "%s\n{\"ph\": \"M\", \"name\": \"process_name\", \"pid\": %d, \"args\": {\"name\": \"%s\"}}", comma, hosts, $3
        comma = ","
      }
      for (place = 1; ends[$3, place] > $1; ++place);
      ends[$3, place] = $1 + $2
      folder = $5; sub("/.*", "", folder)
      printf ",\n{\"ph\": \"X\", \"name\": \"%s\", \"cat\": \"%s\", \"pid\": %d, \"tid\": %d, \"ts\": %.0f, \"dur\": %.0f, " \
        "\"args\": {\"tool\": \"%s\", \"file\": \"%s\", \"cpu_s\": %s, \"threads\": %d, \"memory_MB\": %d}}", folder,
        folder, number[$3], place, 1e6 * ($1 - began), 1e6 * $2, $4, $5, $6, $7, $8
      cpu += $6; if ($1 + $2 > last) last = $1 + $2; ++commands
    }
    END {
      print "\n]}"
      printf "%d commands on %d machines, %.1f s from the first to the last, %.1f CPU s\n", commands, hosts,
        commands ? last - began : 0, cpu > "/dev/stderr"
    }' > "$part" && mv "$part" "$1"
