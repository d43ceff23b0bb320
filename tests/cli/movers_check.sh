# Movers that teleport, grow, are born or gone and a lamp that is off, at one frame: static + dynamic = global before, at and after it, and
# no trail of it after.
failed=0
bad() { echo "$*"; failed=1; }
scene=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
cat >sums.py <<'EOF'
import sys
from collections import Counter
from read_photons import FLUX, NORMAL, RECORD, read_photons
def load(name):
    photons = Counter()
    for block in read_photons(name).blocks:
        for v in RECORD.iter_unpack(block.records):
            f = v[FLUX:NORMAL]
            photons[block.group, v[:FLUX], tuple(map(abs, f)), v[NORMAL:]] += -1 if min(f) < 0 else 1
    return photons
whole, fixed, changed = map(load, sys.argv[1:4])
count = len(changed)
fixed.update(changed)
assert {k: n for k, n in fixed.items() if n} == dict(whole)
print(count)
EOF
cat >trail.py <<'EOF'
from read_irradcache import read_irradcache
before, after = (read_irradcache(f"{f}.irradcache").records for f in (3, 5))
stands = lambda records: [r for r in records if r.set == 0]
assert [r.update for r in stands(before)] == [r.update for r in stands(after)], "a trail in the light"
pairs = list(zip(stands(before), stands(after)))
assert all(a.influence <= b.influence for a, b in pairs) and any(a.influence < b.influence for a, b in pairs), "no frame before looked at"
EOF
python() { PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$HERE/../formats "${PYTHON:-python3}" "$@"; }
photons() { tempolux-info --digest "$1" | cut -d' ' -f1; }
for event in teleports grows born gone lamp-off; do
  "${PYTHON:-python3}" -B "$HERE/../pipelines/edit_gltf.py" "$scene" $event.glb event $event || bad edit
  photon-trace $event.glb -q --photons 4k --map static -o s.photons --paths s.paths || bad "$event: static"
  photon-trace $event.glb -q --frames 3-5 --map dynamic --static s.paths -o d.#.photons || bad "$event: dynamic"
  photon-trace $event.glb -q --frames 3-5 --photons 4k -o g.#.photons || bad "$event: global"
  for f in 3 4 5; do python sums.py g.$f.photons s.photons d.$f.photons >count.$f || bad "$event: static + dynamic is not global at frame $f"; done
  case $event in
  born) [ "$(cat count.3)" = 0 ] && [ "$(cat count.4)" -gt 0 ] || bad "$event: dynamic photons before" ;;
  gone) [ "$(cat count.3)" -gt 0 ] && [ "$(cat count.5)" = 0 ] || bad "$event: dynamic photons after" ;;
  *) [ "$(photons d.3.photons)" = "$(photons d.5.photons)" ] || bad "$event: the frame after is not as the frame before"
     [ "$(photons d.3.photons)" != "$(photons d.4.photons)" ] || bad "$event: nothing happened" ;;
  esac
  [ $event = teleports ] || continue
  irradcache-build points $event.glb -q --map static --photons s.photons --point-count 1k -o s.irradpoints || bad 'points of what stands'
  irradcache-build records $event.glb -q --map static --points s.irradpoints --rays 32 --size 32x18 -o s.irradcache || bad 'records of what stands'
  for f in 3 5; do
    irradcache-build points $event.glb -q --frame $f --update s.irradpoints --photons s.photons --dynamic d.$f.photons --point-count 1k -o p.irradpoints || bad 'points'
    irradcache-build records $event.glb -q --frame $f --update s.irradcache --points p.irradpoints --rays 32 --size 32x18 --dynamic d.$f.photons \
      $([ $f = 5 ] && echo --dynamic d.4.photons) -o $f.irradcache || bad 'records'
  done
  python trail.py || bad "$event: frame 5"
done
exit $failed
