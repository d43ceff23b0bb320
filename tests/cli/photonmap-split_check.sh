# photonmap-split: parts that add up to the last bit, pipes, order of blocks, kinds, limits, what it must refuse.
failed=0
bad() { echo "$*"; failed=1; }
refuses() {   # exit 2 and these words in one line; nothing is written
  words=$1; shift
  "$@" >out.txt 2>errors.txt
  code=$?
  [ $code = 2 ] || bad "exit $code, not 2: $*"
  grep -q -- "$words" errors.txt && [ "$(wc -l <errors.txt)" = 1 ] || bad "does not say '$words': $(cat errors.txt)"
  [ -e refused ] && bad "left an output: $*" && rm -f refused
}
room=$HERE/../../pipelines/scenes/S3_indirect_room.glb
photon-trace "$room" --frame 1 --photons 8k -o p.photons -q || bad photons
irradcache-build points "$room" --frame 1 --photons p.photons --point-count 1k -o p.irradpoints -q || bad points
split="photonmap-split -q --energy 2"
$split p.photons --low l.photons --high h.photons --stats s.json || bad 'photons divided'
$split p.irradpoints --low l.irradpoints --high h.irradpoints || bad 'points divided'
tempolux-info --check l.* h.* >out.txt || bad "$(cat out.txt)"
[ "$(tempolux-info --json h.photons | grep -c '"part": "high"')" = 1 ] || bad 'the header does not say: high'

# By the second readers: every photon and point is the sum of its parts, as rational numbers.
cat >sums.py <<'EOF'
import sys
from fractions import Fraction
from read_irradpoints import read_irradpoints
from read_photons import FLUX, NORMAL, RECORD, read_photons
def photons(name):
    found = {}
    for block in read_photons(name).blocks:
        for v in RECORD.iter_unpack(block.records):
            found.setdefault((block.group, v[:FLUX], v[NORMAL:]), []).append([Fraction(x) for x in v[FLUX:NORMAL]])
    return {key: [sum(c) for c in zip(*values)] for key, values in found.items()}
def points(name):
    return {(p.position, p.normal, p.object, p.set, p.radius): [Fraction(x) for e in p.irradiance.values() for x in e]
            for p in read_irradpoints(name).points}
for read, suffix in ((photons, "photons"), (points, "irradpoints")):
    whole, low, high = (read(name + suffix) for name in ("p.", "l.", "h."))
    assert 0 < len(high) < len(whole), suffix
    for key, values in whole.items():
        zero = [0] * len(values)
        assert [a + b for a, b in zip(low.get(key, zero), high.get(key, zero))] == values, key
    assert set(low) | set(high) == set(whole)
assert read_photons("h.photons").emitted == read_photons("p.photons").emitted
# The same photons in blocks of seven, backwards within their groups.
p = read_photons("p.photons")
p.blocks = [type(b)(b.group, b"".join(reversed([b.records[i:i + 32] for i in range(0, len(b.records), 32)]))) for b in p.blocks]
from read_photons import Block, write_photons
p.blocks = [Block(b.group, b.records[i:i + 224]) for b in p.blocks for i in range(0, len(b.records), 224)]
write_photons("backwards.photons", p)
EOF
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$HERE/../formats "${PYTHON:-python3}" sums.py || bad 'parts do not add up'
$split backwards.photons --low bl.photons --high bh.photons || bad backwards
cat >sorted.py <<'EOF'
import sys
from read_photons import read_photons, split
for name in sys.argv[1:]:
    print(sorted((b.group, r) for b in read_photons(name).blocks for r in split(b.records)) ==
          sorted((b.group, r) for b in read_photons("b" + name).blocks for r in split(b.records)))
EOF
[ "$(PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$HERE/../formats "${PYTHON:-python3}" sorted.py l.photons h.photons | uniq)" = True ] ||
  bad 'the order of photons changes the parts'

# Pipes: standard input, a shell's /dev/fd, standard output; nothing is left behind.
photon-trace "$room" --frame 1 --photons 8k -o - -q | $split - --low pl.photons --high ph.photons || bad pipe
tempolux-info --diff l.photons pl.photons >/dev/null && tempolux-info --diff h.photons ph.photons >/dev/null || bad 'a pipe changes the parts'
cat p.irradpoints | $split - --low - --high ph.irradpoints >pl.irradpoints || bad 'pipe of points'
tempolux-info --diff l.irradpoints pl.irradpoints >/dev/null && tempolux-info --diff h.irradpoints ph.irradpoints >/dev/null || bad 'piped points'
mkfifo named
cat p.photons >named & $split named --low nl.photons --high nh.photons; wait
tempolux-info --diff l.photons nl.photons >/dev/null || bad 'a named pipe changes the parts'
find . -name '.*' -type f | grep . && bad 'temporaries are left'

# Limits: nothing below 0, everything below infinity.
photonmap-split -q --energy 0 p.photons --low none.photons --high all.photons || bad 'limit 0'
tempolux-info --diff all.photons p.photons >/dev/null || bad 'limit 0: the high part is not all'
for type in photons irradpoints; do
  photonmap-split -q --energy 1e300 p.$type --low all.$type --high none.$type || bad 'no limit'
  tempolux-info --diff all.$type p.$type >/dev/null || bad 'no limit: the low part is not all'
done

# A part is not taken for the whole; what cannot be divided is refused.
refuses 'low part of the light alone' irradcache-build points "$room" --frame 1 --photons l.photons -o refused
refuses 'high part of the light alone' irradcache-build records "$room" --frame 1 --points h.irradpoints -o refused
refuses 'low part of the light alone' photonmap-split l.photons --low refused --high other
refuses 'high is required' photonmap-split p.photons --low refused
photon-trace "$room" --frame 1 --photons 4k -o p2.photons -q && $split p2.photons --low bl2.photons --high bh2.photons || bad 'another map'
# Pixels without a cache sample the high part themselves: the same light but for noise (36864 samples that scatter by some twice their
# mean: 1 %); of an infinite limit nothing is high, and the frame is that of the whole.
frame="frame-render $room --frame 1 --size 32x18 --spp 64 --pixel-error 0 --channels layers -q"
photonmap-split p.irradpoints --low all.irradpoints --high none.irradpoints --energy 1e9 -q
$frame --points p.irradpoints -o whole.exr || bad 'frame by whole points'
$frame --points l.irradpoints --high h.irradpoints -o parts.exr --stats frame.json || bad 'frame by two parts'
$frame --points all.irradpoints --high none.irradpoints -o none.exr || bad 'frame, nothing bright'
tempolux-info --diff whole.exr none.exr >out.txt || bad "nothing is bright: $(cat out.txt)"
grep -q '"bright_points": [1-9]' frame.json || bad 'frame-render samples no bright points'
aqm-compare parts.exr whole.exr --layer indirect --json c.json -q >/dev/null
"${PYTHON:-python3}" -c 'import json, sys; b = json.load(open("c.json"))["total"]["bias"]; sys.exit(not -0.04 < b < 0.04)' || bad "other light: $(grep bias c.json)"
refuses 'the low part' $frame --points l.irradpoints -o refused
refuses 'name the low part' $frame --high h.irradpoints -o refused
# The two parts of .photons are taken together: points and pixels are those of the whole, bit by bit. Records sample what is bright: the same
# light but for noise (as above, 4 %).
build="irradcache-build $room --frame 1 --point-count 1k -q"
irradcache-build points "$room" --frame 1 --photons l.photons --high h.photons --point-count 1k -o joined.irradpoints -q || bad 'points of two parts'
tempolux-info --diff p.irradpoints joined.irradpoints >out.txt || bad "points of two parts: $(cat out.txt)"
$frame --photons p.photons -o whole.exr || bad 'frame by whole photons'
$frame --photons l.photons --high h.photons -o parts.exr || bad 'frame by photons in two parts'
tempolux-info --diff whole.exr parts.exr >out.txt || bad "frame by photons in two parts: $(cat out.txt)"
$build --photons p.photons --size 32x18 -o whole.irradcache || bad 'records of whole photons'
$build --photons l.photons --high h.photons --size 32x18 -o parts.irradcache --stats records.json || bad 'records of photons in two parts'
grep -q '"bright_points": [1-9]' records.json || bad 'irradcache-build samples no bright points'
for c in whole parts; do $frame --irradcache $c.irradcache -o $c.exr || bad "frame by records, $c"; done
aqm-compare parts.exr whole.exr --layer indirect --json c.json -q >/dev/null
"${PYTHON:-python3}" -c 'import json, sys; b = json.load(open("c.json"))["total"]["bias"]; sys.exit(not -0.04 < b < 0.04)' || bad "other light: $(grep bias c.json)"
refuses 'give the whole, or' $frame --photons l.photons -o refused
refuses 'is the high part' $frame --photons h.photons --high h.photons -o refused
refuses 'not those of' $build --photons l.photons --high bh2.photons -o refused
refuses 'leave out --update' irradcache-build points "$room" --frame 1 --map static --photons l.photons --high h.photons -o refused
refuses 'not a part of light' $frame --points p.irradpoints --high h.irradpoints -o refused

refuses 'neither auto nor a number above 0' photonmap-split p.photons --low refused --high other --cell -1
refuses 'neither photons nor irradiance points' photonmap-split "$room" --low refused --high other
refuses 'two outputs' photonmap-split p.photons --low refused --high refused
refuses 'p.photons' photonmap-split p.photons --low refused --high p.photons
head -c 5000 p.photons >cut.photons
refuses 'incomplete' photonmap-split cut.photons --low refused --high other
cat cut.photons | refuses 'incomplete' photonmap-split - --low refused --high other
[ -e other ] && bad 'left a second output'
exit $failed
