# The same bytes for any number of threads, from every tool.
. "$HERE/each_tool.sh"
failed=0
compared() {
  name=$1; shift
  for threads in ${THREADS:-1 2 3 7}; do
    mkdir -p "$name/$threads"
    (cd "$name/$threads" && "$@" -q --threads "$threads" --stats ../stats.json) || { echo "$name --threads $threads: exit $?"; failed=1; }
    if diff -r -x inputs "$name/1" "$name/$threads"; then :; else echo "$name: other bytes with $threads threads than with 1"; failed=1; fi
  done
  grep -q "\"threads\": $threads" "$name/stats.json" || { echo "$name: did not use $threads threads"; failed=1; }
  echo "$name: $(find "$name/1" -type f | wc -l) files compared"
  [ "$(find "$name/1" -type f | wc -l)" -gt 0 ] || failed=1
}
each_tool compared
exit $failed
