# Static and dynamic maps: together the global map, photon by photon, as a second reader sees them; what is refused.
failed=0
bad() { echo "$*"; failed=1; }
refuses() {
  words=$1; shift
  "$@" >out.txt 2>errors.txt
  code=$?
  [ $code = 2 ] || bad "exit $code, not 2: $*"
  grep -q -- "$words" errors.txt && [ "$(wc -l <errors.txt)" = 1 ] || bad "does not say '$words': $(cat errors.txt)"
  [ -e refused ] && bad "left an output: $*" && rm -f refused
}
cat >sums.py <<'EOF'
import sys
from collections import Counter
from fractions import Fraction
from read_photons import FLUX, NORMAL, RECORD, read_photons
def load(name):
    photons, flux = Counter(), [Fraction(0)] * 3
    for block in read_photons(name).blocks:
        for v in RECORD.iter_unpack(block.records):
            f = v[FLUX:NORMAL]
            photons[block.group, v[:FLUX], tuple(map(abs, f)), v[NORMAL:]] += -1 if min(f) < 0 else 1
            flux = [a + Fraction(b) for a, b in zip(flux, f)]
    return photons, flux
(whole, flux), (fixed, flux_s), (changed, flux_d) = map(load, sys.argv[1:4])
fixed.update(changed)
assert {k: n for k, n in fixed.items() if n} == dict(whole), "photons"
assert [a + b for a, b in zip(flux_s, flux_d)] == flux, "flux"
print(len(changed))
EOF
sum() { PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$HERE/../formats "${PYTHON:-python3}" sums.py "$@"; }
trace() { photon-trace -q "$@"; }
scene=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
edit() { "${PYTHON:-python3}" -B "$HERE/../pipelines/edit_gltf.py" "$@"; }

# A box that moves, all kinds of light; a mirror in the room; a lamp that moves beside one that stands.
edit "$scene" mirror.glb mirror && edit "$scene" lamp.glb lamp && edit "$scene" other.glb lamp 4 || bad edit
for name in box mirror lamp; do
  case $name in box) file=$scene;; *) file=$name.glb;; esac
  trace "$file" --photons 6k --map static -o $name.s.photons --paths $name.paths || bad "$name static"
  trace "$file" --frame 4 --map dynamic --static $name.paths -o $name.d.photons || bad "$name dynamic"
  trace "$file" --frame 4 --photons 6k -o $name.g.photons || bad "$name global"
  [ "$(sum $name.g.photons $name.s.photons $name.d.photons)" -gt 0 ] || bad "$name: static + dynamic is not global"
done

# Photons of the sky aimed at the box: the same mixture for all maps, and another one is refused.
printf 'tempolux view 1.0\n0.3 0.3 0.3 0.5 1\n' >near.view
printf 'tempolux view 1.0\n0.3 0.3 0.3 0.25 1\n' >nearer.view
sky='--environment 1,1,1'
trace "$scene" $sky --photons 6k --importance near.view --map static -o sky.s.photons --paths sky.paths 2>/dev/null || bad 'sky static'
trace "$scene" $sky --frame 4 --importance near.view --map dynamic --static sky.paths -o sky.d.photons || bad 'sky dynamic'
trace "$scene" $sky --frame 4 --photons 6k --importance near.view -o sky.g.photons 2>/dev/null || bad 'sky global'
[ "$(sum sky.g.photons sky.s.photons sky.d.photons)" -gt 0 ] || bad 'sky: static + dynamic is not global'
refuses 'what --importance aims at' trace "$scene" $sky --frame 4 --map dynamic --static sky.paths -o refused
refuses 'what --importance aims at' trace "$scene" $sky --frame 4 --importance nearer.view --map dynamic --static sky.paths -o refused

tempolux-info --check box.* >out.txt || bad "$(cat out.txt)"
tempolux-info box.paths | grep -q touched_paths || bad 'info of .paths'

# The static map is that of any frame of the segment. Nothing moves: it is the global map, and no path is touched.
trace "$scene" --frame 9 --photons 6k --map static -o again.photons --paths again.paths
tempolux-info --diff again.photons box.s.photons >/dev/null && tempolux-info --diff again.paths box.paths >/dev/null || bad 'static map of another frame'
edit "$scene" still.glb still
trace still.glb --photons 6k --map static -o still.s.photons --paths still.paths
trace still.glb --photons 6k -o still.g.photons
trace still.glb --map dynamic --static still.paths -o still.d.photons
tempolux-info --json still.s.photons still.g.photons still.d.photons still.paths >still.json
"${PYTHON:-python3}" - <<'EOF' || bad 'nothing moves'
import json
s, g, d, p = json.load(open("still.json"))
assert s["stored_flux_W"] == g["stored_flux_W"] and s["photons"] == g["photons"], (s, g)
assert d["photons"] == 0 and p["touched_paths"] == 0
EOF

# Points: direct light to the bit as made afresh, indirect light in the mean; the same for any number of threads.
points() { irradcache-build points "$scene" -q --frame 4 --point-count 2k "$@"; }
points --photons box.g.photons -o fresh.irradpoints || bad 'points'
points --map static --photons box.s.photons -o stands.irradpoints || bad 'points of what stands'
for threads in 1 2 3 7; do
  points --update stands.irradpoints --photons box.s.photons --dynamic box.d.photons -o updated.$threads.irradpoints --threads $threads || bad update
done
for threads in 2 3 7; do cmp updated.1.irradpoints updated.$threads.irradpoints || bad "updated points differ with $threads threads"; done
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$HERE/../formats "${PYTHON:-python3}" - <<'EOF' || bad 'updated points'
from read_irradpoints import read_irradpoints
fresh, updated = read_irradpoints("fresh.irradpoints"), read_irradpoints("updated.1.irradpoints")
assert [p.position for p in fresh.points] == [p.position for p in updated.points]
assert [p.irradiance["direct"] for p in fresh.points] == [p.irradiance["direct"] for p in updated.points]
a, b = (sum(p.irradiance["indirect"][1] for p in file.points) for file in (fresh, updated))
assert abs(a - b) < 0.02 * a, (a, b)      # 6000 paths: the estimates' own noise in the mean of 2000 points
sets = [p.set for p in updated.points]
assert sets == sorted(sets) and 0 < sum(sets) < len(sets), "points of what stands come first"
EOF
refuses 'give the options they were made with' irradcache-build points "$scene" --frame 4 --point-count 1k --update stands.irradpoints --photons box.s.photons --dynamic box.d.photons -o refused
refuses 'go together' points --update stands.irradpoints --photons box.s.photons -o refused
refuses 'give a static one' points --update stands.irradpoints --photons box.g.photons --dynamic box.d.photons -o refused
refuses 'give a global one' points --photons box.d.photons -o refused

# Records: those of what stands once, then a frame's; the frame is that of records all gathered for it, within their noise.
size='--size 64x36 --rays 64'
irradcache-build records "$scene" -q --map static --points stands.irradpoints $size -o stands.irradcache || bad 'records of what stands'
for threads in 1 2 3 7; do
  irradcache-build records "$scene" -q --frame 4 --update stands.irradcache --points updated.1.irradpoints --dynamic box.d.photons $size \
    -o updated.$threads.irradcache --threads $threads || bad 'records updated'
done
for threads in 2 3 7; do cmp updated.1.irradcache updated.$threads.irradcache || bad "updated records differ with $threads threads"; done
irradcache-build records "$scene" -q --frame 4 --points fresh.irradpoints $size -o fresh.irradcache || bad 'fresh records'
for name in updated.1 fresh; do
  frame-render "$scene" -q --frame 4 --size 64x36 --spp 2 --pixel-error 0 --irradcache $name.irradcache --points fresh.irradpoints --channels layers -o $name.exr || bad "frame of $name"
done
aqm-compare updated.1.exr fresh.exr --layer indirect --json compared.json -q >/dev/null
"${PYTHON:-python3}" - <<'EOF' || bad 'localised gathering is not gathering'
import json
c = json.load(open("compared.json"))
total = c["total"]
assert abs(total["bias"]) < 0.05, total       # 6000 paths and 64 rays a record
EOF
# Where what moves matters, as channels: shares in [0, 1], and only from such a cache. Influences lie from .09 to .46
# here, so with thresholds of .15 and .375 some pixels have none and some have all of what movers change.
frame-render "$scene" -q --frame 4 --size 64x36 --spp 1 --irradcache updated.1.irradcache --points fresh.irradpoints --influence 0.15 \
  --channels RGBA,influence -o influence.exr || bad 'influence'
tempolux-info influence.exr | grep -qE 'channel blend .* min 0 +max 1 ' || bad "blend: $(tempolux-info influence.exr | grep blend)"
refuses 'only a cache of localised gathering' frame-render "$scene" --frame 4 --size 64x36 --spp 1 --irradcache fresh.irradcache --points fresh.irradpoints --channels RGBA,influence -o refused
refuses 'what movers change is nothing alone' frame-render "$scene" --frame 4 --dynamic box.d.photons -o refused

refuses 'what moves differ at frame 4' trace other.glb --frame 4 --map dynamic --static lamp.paths -o refused
trace other.glb --frame 3 --map dynamic --static lamp.paths -o fine.photons || bad 'a frame whose movers are the same'
refuses 'frame 30 lies in 24 to 47' trace "$scene" --frame 30 --map dynamic --static box.paths -o refused
refuses 'made for another state' trace mirror.glb --map dynamic --static box.paths -o refused
refuses 'needs --static' trace "$scene" --map dynamic -o refused
refuses 'takes it from the static map' trace "$scene" --map dynamic --static box.paths --photons 10 -o refused
refuses 'only with --map dynamic' trace "$scene" --static box.paths -o refused
refuses 'only with --map static' trace "$scene" --paths p.paths -o refused
refuses 'is a part of the scene' irradcache-build points "$scene" --photons box.s.photons -o refused
exit $failed
