#!/bin/sh
# short_check.sh BUILD SCRATCH -- does `make evidence` still run at tiny sizes, go on after kill -9, and name the rows that
# a change makes stale, and no other? Does the README say what docs/results says?
here=$(cd "$(dirname "$0")" && pwd)
build=$1 work=$2 failed=0
rm -rf "$work" && mkdir -p "$work" || exit 1
bad() { echo "FAILED: $*"; failed=1; }
evidence() {
  python3 -B "$here/evidence.py" --tiny --build "$build" --out "$work/out" --results "$work/RESULTS.md" --docs "$work/docs" --parts "$1" \
    > "$work/said" || { cat "$work/said"; exit 1; }
}
parts='photon-rate nearest threads start reading path-tracer'
evidence "$parts"
for part in $parts; do
  [ -s "$work/docs/results/$part.md" ] && grep -q "results/$part.md" "$work/RESULTS.md" || grep -A1 "== $part:" "$work/said" | grep -q 'left out:' ||
    bad "docs/results or RESULTS.md has no part $part"
done
grep -q 'not measured yet: .PARTS=stress.' "$work/RESULTS.md" || bad 'a part that was never measured is not on the page'

# A digest and a number of instructions that were other ones: the row is named and marked; the others are not.
changed() { sed -i "$2" "$work/docs/results/$1.json"; }
counts() { command -v valgrind > /dev/null; }
cp -r "$work/docs" "$work/before"
changed photon-rate 's/"p.photons": "[0-9a-f]*"/"p.photons": "0"/'
counts && changed start 's/"photon-trace": \([0-9]\)/"photon-trace": 1\1/'
evidence canaries
grep -q '^stale: photon-rate: photons: p.photons differ$' "$work/said" || bad 'other data: the row is not named'
! counts || grep -q '^stale: start: help: photon-trace takes' "$work/said" || bad 'other instructions: the row is not named'
grep '^stale: ' "$work/said" | grep -v ' photon-rate: \| start: ' | grep . && bad 'other rows are named'
grep 'photon-rate.md' "$work/RESULTS.md" | grep -q 'stale since' || bad 'the page does not mark the row'
rm -r "$work/docs" && mv "$work/before" "$work/docs"
evidence canaries
grep '^stale: ' "$work/said" && bad 'a change that was taken back still counts'

# A part that is killed in its second step does not repeat the first.
for round in 1 2; do
  python3 -B - "$here" "$work" $round 2> /dev/null << 'END'
import os, signal, sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from measure import Steps
folder, step = Path(sys.argv[2]), Steps(Path(sys.argv[2]) / "steps.json", "programs")
def first():
    (folder / "runs").open("a").write("x")
    return [1, 2]
assert step("first", first) == [1, 2]
step("second", lambda: os.kill(os.getpid(), signal.SIGKILL) if sys.argv[3] == "1" else 3)
assert Steps(folder / "steps.json", "others").kept["found"] == {}, "steps of other programs are kept"
END
done
[ "$(cat "$work/runs")" = x ] || bad 'a finished step is run again after kill -9'

cd "$here" && python3 -B - << 'END' || failed=1
import json, pathlib, sys
import results_page
top = pathlib.Path("../..")
said, row = (top / "README.md").read_text(), json.loads((top / "docs/results/demo.json").read_text())
if said != results_page.readme(said, row):
    sys.exit("README.md: the demo's cost differs from docs/results; PARTS=page writes it")
END
exit $failed
