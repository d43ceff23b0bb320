# Photons of sun and sky are aimed where the cameras look: a view file where it helps and none elsewhere, the same bytes for any
# number of threads, what is no view file refused, too few photons said.
. "$HERE/expect.sh"
scenes=$HERE/../../pipelines/scenes
python3 -B - "$HERE/../support" <<'EOF' || bad 'scenes'
import sys
sys.path.insert(0, sys.argv[1])
from open_scenes import hut
hut(5, True).save("small.glb")
hut(500, True).save("wide.glb")
lit = hut(500, False)
lit.quad((-0.5, 2.5, -0.5), (0.5, 2.5, -0.5), (0.5, 2.5, 0.5), (-0.5, 2.5, 0.5), lit.material(0.0, 15, one_sided=True))
lit.save("lit.glb")
EOF
plan() { scene=$1; shift; scene-plan "$scene" --frames 0 -q "$@" || bad "plan of $scene"; }
plan wide.glb --camera inside -o wide
plan wide.glb --camera outside -o outside
plan small.glb --camera inside -o small
plan "$scenes/S2_cornell_moving.glb" -o lamps

plan lit.glb --camera inside -o lit

# Wide ground: spheres, also under a lamp. Small ground: openings alone. Lamps alone in a room: no file.
for scene in wide outside lit; do eval "$scene=\$(ls $scene/state/0000-*.view)"; done
[ "$(wc -l <"$lit")" -gt 8 ] || bad 'lit: few spheres'
[ "$(head -1 "$wide")" = 'tempolux view 1.0' ] || bad 'wide: first line'
[ "$(wc -l <"$wide")" -gt 8 ] || bad 'wide: few spheres'
[ "$(wc -l <"$wide")" -le 33 ] || bad 'wide: many spheres'
cmp -s "$wide" "$outside" && bad 'two cameras look to the same places'
ls lamps/state/*.view 2> /dev/null && bad 'lamps: a view file where none helps'
grep -q '[.]view' lamps/plan.mk && bad 'lamps: plan.mk names a view file'
small=$(ls small/state/0000-*.view)
[ "$(head -1 "$small")" = 'tempolux view 1.2' ] || bad 'small: first line'
grep -q '^opening ' "$small" || bad 'small: no opening'
grep -q '^[0-9-]' "$small" && bad 'small: spheres around what is seen'
# The same photons for any number of threads.
for threads in 1 3; do
  photon-trace small.glb --frame 0 --photons 30k --kinds indirect -q --importance "$small" --threads $threads -o small$threads.photons
done
cmp small1.photons small3.photons || bad 'small: other bytes with other threads'
grep -q -- "--importance ${wide#wide/}" wide/plan.mk || bad 'plan.mk does not name the view file'
echo 'tempolux view 1.0' > empty.view
# A plan made again leaves the file untouched.
touch -d '2001-01-01' "$wide"
plan wide.glb --camera inside -o wide
[ -n "$(find "$wide" ! -newermt 2001-01-02)" ] || bad 'written again with the same content'

# By hand it is the same: without a file the tool looks through the camera itself.
photon-trace wide.glb --camera inside --frame 0 --photons 3k --kinds indirect -q -o hand.photons
photon-trace wide.glb --camera inside --frame 0 --photons 3k --kinds indirect -q --importance "$wide" -o make.photons
tempolux-info --diff hand.photons make.photons > out.txt || bad "by hand photons differ from those of the plan: $(cat out.txt)"

# Far more photons in the hut, and the same for any number of threads.
trace() { photon-trace wide.glb --frame 0 --photons 30k --kinds indirect -q "$@" || bad "photon-trace $*"; }
trace --importance none -o uniform.photons --stats uniform.json
for threads in 1 2 7; do trace --importance "$wide" --threads $threads -o $threads.photons --stats $threads.json; done
cmp 1.photons 2.photons && cmp 1.photons 7.photons || bad 'other bytes with other threads'
tempolux-info --check 1.photons >out.txt || bad "$(cat out.txt)"
seen=$(sed -n 's/.*"photons_seen": *\([0-9]*\).*/\1/p' 1.json)
[ "${seen:-0}" -gt 1600 ] || bad "only $seen photons seen"
grep -q photons_seen uniform.json && bad 'counted without spheres'
# A view without spheres changes nothing but the history.
photon-trace small.glb --frame 0 --photons 10k -q --importance none -o none.photons
photon-trace small.glb --frame 0 --photons 10k -q --importance empty.view -o empty.photons
cat >same.py <<'EOF'
from read_photons import read_photons
a, b = read_photons("none.photons"), read_photons("empty.photons")
assert [x.records for x in a.blocks] == [x.records for x in b.blocks]
EOF
PYTHONPATH=$HERE/../formats python3 -B same.py || bad 'a view without spheres changes photons'

# Points lie where the camera looks, closer together; the same bytes for any number of threads; a view without spheres changes nothing.
points() { irradcache-build points "$@" -q || bad "irradcache-build points $*"; }
points wide.glb --frame 0 --photons 1.photons --point-count 2k --importance none -o everywhere.irradpoints
for threads in 1 2 7; do
  points wide.glb --frame 0 --photons 1.photons --point-count 2k --importance "$wide" --threads $threads -o $threads.irradpoints
done
cmp 1.irradpoints 2.irradpoints && cmp 1.irradpoints 7.irradpoints || bad 'points: other bytes with other threads'
spacing() { tempolux-info "$1" --json | sed -n 's/.*"spacing_m": *\([0-9.e+-]*\).*/\1/p'; }
awk -v a="$(spacing everywhere.irradpoints)" -v b="$(spacing 1.irradpoints)" 'BEGIN { exit !(b > 0 && 30 * b < a) }' ||
  bad 'points are not closer where the camera looks'
points small.glb --frame 0 --photons none.photons --point-count 2k --importance none -o none.irradpoints
points small.glb --frame 0 --photons none.photons --point-count 2k --importance empty.view -o empty.irradpoints
tempolux-info --diff none.irradpoints empty.irradpoints >out.txt || bad "a view without spheres changes points: $(cat out.txt)"
expect 2 'does not read it' irradcache-build records wide.glb --frame 0 --points 1.irradpoints --importance "$wide" -o refused

# What is refused, and what is said.
aim() { photon-trace wide.glb --frame 0 --photons 1k -o made.photons --importance "$@"; }
expect 2 'absent: cannot read' aim absent
expect 2 'line 1: not a view file' aim wide.glb
{ head -5 "$wide"; echo 0 0 0 1; } >short
expect 2 'five numbers wanted' aim short
printf 'tempolux view 1.0\n0 0 0 -1 1\n' >negative
expect 2 'line 2: radius and weight must be above 0' aim negative
expect 0 'photons lie where the cameras look' aim "$wide"
exit $failed
