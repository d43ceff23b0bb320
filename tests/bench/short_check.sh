#!/bin/sh
# short_check.sh BUILD SCRATCH -- does `make bench` still run, does its page have every part, and does the README say what
# docs/results says?
here=$(cd "$(dirname "$0")" && pwd)
parts=$(cd "$here" && python3 -B -c 'from bench import usual; print(*usual())') || exit 1
rm -rf "$2" && mkdir -p "$2" || exit 1
python3 -B "$here/bench.py" --tiny --build "$1" --out "$2/out" --results "$2/RESULTS.md" --docs "$2/docs" >"$2/bench.txt" || { cat "$2/bench.txt"; exit 1; }
for part in $parts; do
  [ -s "$2/docs/results/$part.md" ] && grep -q "results/$part.md" "$2/RESULTS.md" || grep -A1 "== $part\$" "$2/bench.txt" | grep -q 'left out:' ||
    { echo "docs/results or RESULTS.md has no part $part"; exit 1; }
done
# A part that the output folder does not know stays as the page has it; one without a file is not listed.
page_again() { python3 -B "$here/bench.py" --tiny --build "$1" --out "$2/out" --results "$2/RESULTS.md" --docs "$2/docs" --page > "$2/page.txt"; }
in_full() { cat "$2"/docs/results/*.md "$2/RESULTS.md"; }
in_full "$@" > "$2/before.md" && rm "$2/out/start.json" && page_again "$@" && in_full "$@" | cmp - "$2/before.md" ||
  { echo 'the page loses parts that are not measured again'; exit 1; }
rm "$2/docs/results/start.md" && page_again "$@" && ! grep -q 'results/start.md' "$2/RESULTS.md" ||
  { echo 'a part that is not measured is listed'; exit 1; }
cd "$here" && python3 -B - <<'END'
import pathlib, sys
import results_page
top = pathlib.Path("../..")
said = (top / "README.md").read_text()
if said != results_page.readme(said, top / "docs" / "results"):
    sys.exit("README.md: the demo's cost differs from docs/results; bench.py --page writes it")
END
