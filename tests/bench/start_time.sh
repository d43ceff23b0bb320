#!/bin/sh
# start_time.sh BUILD -- what it costs to start each tool: `--help`, median and least of 41 runs, as JSON.
# Asked for: below 20 ms.
separator='{'
for path in "$1"/bin/*; do
  [ -x "$path" ] || continue
  times=$(for round in $(seq 41); do
    begin=$(date +%s%N); "$path" --help >/dev/null; echo $(( ($(date +%s%N) - begin) / 1000 ))
  done | sort -n)
  printf '%s\n  "%s": {"median_us": %s, "least_us": %s}' "$separator" "$(basename "$path")" \
    "$(echo "$times" | sed -n 21p)" "$(echo "$times" | head -1)"
  separator=','
done
printf '\n}\n'
