#!/bin/sh
# kill_nine.sh ROUNDS COMMAND... -- kills COMMAND (run in a folder of its own, into which it writes)
# with signal 9 at ROUNDS random moments of its run time. After each kill every file under its final name
# must be what an undisturbed run writes, or what stood there before; the next run must leave no temporary.
rounds=$1; shift
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/whole" "$scratch/part"
span=1000000000
for try in 1 2 3; do                         # the shortest of three: a moment after the end kills nothing
  begin=$(date +%s%N)
  (cd "$scratch/whole" && "$@" >/dev/null 2>&1) || { echo "the undisturbed run fails: $*"; exit 1; }
  took=$(( ($(date +%s%N) - begin) / 1000 ))
  [ $took -lt $span ] && span=$took
done
cd "$scratch/part" || exit 1
wrong=0 killed=0 left=0
moments=$(awk -v n="$rounds" -v span="$span" 'BEGIN {
  srand(7); for (i = 0; i < n; ++i) printf "%.6f\n", rand() * span * 1.05e-6 }')
finals() { find . -type f ! -name '.*.tmp.*'; }
round=0
for moment in $moments; do
  round=$((round + 1))
  finals | xargs -r rm                       # temporaries stay: the next run has to clear them away
  if [ $((round % 2)) = 0 ]; then            # every other time older files stand there
    for file in $(cd ../whole && finals); do mkdir -p "$(dirname "$file")" && echo old >"$file"; done
  fi
  "$@" >/dev/null 2>&1 &
  process=$!
  sleep "$moment"
  kill -9 $process 2>/dev/null && killed=$((killed + 1))
  wait $process 2>/dev/null
  for file in $(finals); do
    cmp -s "$file" "../whole/$file" && continue
    [ $((round % 2)) = 0 ] && [ "$(cat "$file")" = old ] && continue
    echo "killed after $moment s: $file is neither whole nor the old one"; wrong=$((wrong + 1))
  done
  left=$((left + $(find . -name '.*.tmp.*' | wc -l)))
done
"$@" >/dev/null 2>&1 || { echo "the run after the kills fails"; wrong=$((wrong + 1)); }
[ -z "$(find . -name '.*.tmp.*')" ] || { echo "temporaries stay: $(ls -A)"; wrong=$((wrong + 1)); }
echo "$(basename "$1"): $killed of $rounds runs of $((span / 1000)) ms killed," \
     "temporaries seen $left, wrong files $wrong"
[ $wrong = 0 ]
