#!/bin/sh
# short_check.sh BUILD SCRATCH -- does `make bench` still run, and does its page name every part?
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$2" && mkdir -p "$2" || exit 1
python3 -B "$here/bench.py" --quick --build "$1" --out "$2/out" --results "$2/RESULTS.md" --docs "$2/docs" || exit 1
for part in sweep path-tracer photon-rate photon-growth nearest threads start reading gather-quality \
    gather-speed-error cornell large gather-rays growth s4-quality s4-speed; do
  grep -q -e "--only $part" "$2/RESULTS.md" || { echo "RESULTS.md has no part $part"; exit 1; }
done
for plot in $(sed -n 's/.*](\(docs[^)]*\)).*/\1/p' "$2/RESULTS.md"); do
  [ -s "$2/$plot" ] || { echo "RESULTS.md shows $plot, which is not there"; exit 1; }
done
! find "$2/docs" -size +200k | grep . || { echo 'a figure is larger than 200 KB'; exit 1; }
