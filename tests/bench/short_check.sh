#!/bin/sh
# short_check.sh BUILD SCRATCH -- does `make bench` still run, does its page name every part, and does the README say what
# docs/results says?
here=$(cd "$(dirname "$0")" && pwd)
parts=$(cd "$here" && python3 -B -c 'from required import FIGURES; print("sweep", *FIGURES)') || exit 1
rm -rf "$2" && mkdir -p "$2" || exit 1
python3 -B "$here/bench.py" --tiny --build "$1" --out "$2/out" --results "$2/RESULTS.md" --docs "$2/docs" || exit 1
for part in $parts; do
  [ -s "$2/docs/results/$(echo "$part" | sed s/sweep/curves/).md" ] || grep -q -e "No current figure:.*\<$part\>" "$2/RESULTS.md" ||
    { echo "docs/results has no part $part"; exit 1; }
done
for plot in $(sed -n 's/.*](\(docs[^)]*\)).*/\1/p' "$2/RESULTS.md"); do
  [ -s "$2/$plot" ] || { echo "RESULTS.md shows $plot, which is not there"; exit 1; }
done
! find "$2/docs" -size +200k | grep . || { echo 'a figure is larger than 200 KB'; exit 1; }
# A part that the output folder does not know stays as the page has it; where there is no file of it, it is said not to be measured.
page_again() { python3 -B "$here/bench.py" --tiny --build "$1" --out "$2/out" --results "$2/RESULTS.md" --docs "$2/docs" --page > "$2/page.txt"; }
in_full() { cat "$2"/docs/results/*.md; sed -n '/^## Error against/,$p' "$2/RESULTS.md"; }
in_full "$@" > "$2/before.md" && rm "$2/out/start.json" "$2/out/sweep.json" && page_again "$@" && in_full "$@" | cmp - "$2/before.md" ||
  { echo 'the page loses parts that are not measured again'; exit 1; }
rm "$2/docs/results/start.md" && page_again "$@" && grep -q 'No current figure:.*start' "$2/RESULTS.md" ||
  { echo 'a part that is not measured is not said to be'; exit 1; }
cd "$here" && python3 -B - <<'END'
import pathlib, sys
import results_page
top = pathlib.Path("../..")
said = (top / "README.md").read_text()
if said != results_page.readme(said, top / "docs" / "results"):
    sys.exit("README.md: the demo's cost differs from docs/results; bench.py --page writes it")
END
