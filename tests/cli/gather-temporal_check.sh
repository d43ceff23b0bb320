# gather-temporal: a range and single frames, threads, little memory, a divided light, what stands, a run that is killed and goes on, what it must refuse.
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
moving=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
still=$HERE/../../pipelines/scenes/S1_cornell.glb
for f in 0 1 2 3 4; do
  photon-trace "$moving" --frame $f --photons 20k -o p.photons -q &&
  irradcache-build points "$moving" --frame $f --photons p.photons --point-count 1k -o p.000$f.irradpoints -q || bad "points of frame $f"
done
temporal() { gather-temporal final "$moving" -q --size 48x27 --rays 80 "$@"; }
range() { folder=$1; shift; mkdir -p "$folder"; temporal --frames 0-4 --points p.####.irradpoints -o "$folder/s.####.radsamples" --cache "$folder/c.####.irradcache" "$@"; }

# A range, each frame alone, and any number of threads: the same files.
range range --stats range.json || bad 'a range'
mkdir alone
for f in 0 1 2 3 4; do
  previous=
  [ $f -gt 0 ] && previous="--previous alone/s.000$((f - 1)).radsamples"
  temporal --frame $f --points p.000$f.irradpoints $previous -o alone/s.000$f.radsamples --cache alone/c.000$f.irradcache || bad "frame $f alone"
done
diff -r range alone || bad 'frames alone differ from a range'
for threads in 1 2 3 7; do
  range threads$threads --threads $threads || bad "$threads threads"
  diff -r range threads$threads || bad "$threads threads: other files"
done
tempolux-info --check range/* >/dev/null || bad 'not valid'
frame-render "$moving" --frame 4 --size 48x27 --spp 1 --irradcache range/c.0004.irradcache --points p.0004.irradpoints -o f.exr -q || bad 'a frame from its cache'
"${PYTHON:-python3}" - <<'END' || bad 'counts of a range'
import json
r = json.load(open("range.json"))["results"]
assert r["retraced_share.1"] < 0.4 and r["mean_age.4"] > 2 and r["update_rays.0"] == 0 < r["update_rays.1"], r
assert r["records.4"] < 1.3 * r["records.0"], r
END

# With one frame left out the next follows from the one before that; an earlier file is replaced by the one that follows from it.
temporal --frame 2 --points p.0002.irradpoints --previous range/s.0000.radsamples -o over.radsamples --cache over.irradcache || bad 'from two frames before'
cp range/s.0001.radsamples chain.radsamples
temporal --frame 2 --points p.0002.irradpoints --previous chain.radsamples -o chain.radsamples --cache chain.irradcache || bad 'in place'
cmp chain.radsamples range/s.0002.radsamples || bad 'in place: another file'

# Where nothing moves no ray is sent, and all frames have one digest.
photon-trace "$still" --photons 20k -o p.photons -q && irradcache-build points "$still" --photons p.photons --point-count 1k -o still.irradpoints -q || bad still
for f in 0 1 2; do cp still.irradpoints still.$f.irradpoints; done
mkdir still
gather-temporal final "$still" -q --size 48x27 --rays 80 --frames 0-2 --points still.#.irradpoints -o still/s.#.radsamples --cache still/c.#.irradcache \
  --stats still.json || bad 'what stands'
[ "$(tempolux-info --digest still/s.* | cut -d' ' -f1 | sort -u | wc -l)" = 1 ] || bad 'what stands: other samples'
[ "$(tempolux-info --digest still/c.* | cut -d' ' -f1 | sort -u | wc -l)" = 1 ] || bad 'what stands: other records'
"${PYTHON:-python3}" -c 'import json
r = json.load(open("still.json"))["results"]
assert all(r[name] == 0 for f in "12" for name in (f"update_rays.{f}", f"birth_rays.{f}"))' || bad 'what stands: rays'

# Frames in which nothing changed are overlays of the one before: 200 of 1160 bytes a record (80 cells) and the points, the same digest, and as --previous as good.
small() { [ $(($(wc -c <"$1") * 4)) -lt "$(wc -c <"$2")" ]; }
small still/s.1.radsamples still/s.0.radsamples && small still/s.2.radsamples still/s.0.radsamples || bad "what stands: no overlays: $(ls -l still)"
for f in 0 1; do
  gather-temporal final "$still" -q --size 48x27 --rays 80 --frame 2 --points still.2.irradpoints --previous still/s.$f.radsamples -o from$f.radsamples \
    --cache from.irradcache --depfile from$f.d || bad "from frame $f"
done
cmp from0.radsamples from1.radsamples || bad 'another file from an overlay than from its base'
grep -q still/s.0.radsamples from1.d || bad "depfile without the base: $(cat from1.d)"
# The box comes to rest in frame 47: what follows is laid over that.
for f in 45 46 47 48 49; do
  photon-trace "$moving" --frame $f --segment 60 --photons 20k -o p.photons -q &&
  irradcache-build points "$moving" --frame $f --segment 60 --photons p.photons --point-count 1k -o p.00$f.irradpoints -q || bad "points of frame $f"
done
rest() { mkdir -p "$1"; temporal --frames 45-49 --segment 60 --points p.####.irradpoints -o "$1/s.####.radsamples" --cache "$1/c.####.irradcache" ${2:-}; }
rest rest || bad 'comes to rest'
small rest/s.0048.radsamples rest/s.0047.radsamples && small rest/s.0049.radsamples rest/s.0047.radsamples || bad "at rest: no overlays: $(ls -l rest)"
small rest/s.0046.radsamples rest/s.0045.radsamples && bad "an overlay of what moves: $(ls -l rest)"
cp -r rest again
rm again/s.0047.radsamples
refuses 's.0047.radsamples: cannot open' gather-temporal final "$moving" -q --frame 49 --segment 60 --points p.0049.irradpoints --size 48x27 --rays 80 \
  --previous again/s.0048.radsamples -o refused --cache refused.c

# --high: samples hold the low part, explicit samples of bright points come on top in each frame. S2 has no bright spot: a limit so low that a third of the points have a
# high part. Records with and without are the same but for noise: 250 records of about 100 rays, 100 explicit samples.
for f in 0 1 2 3 4; do photonmap-split p.000$f.irradpoints --energy 1 --low low.000$f.irradpoints --high high.000$f.irradpoints -q || bad "split of frame $f"; done
divided() { folder=$1; shift; mkdir -p "$folder"; temporal --frames 0-4 --points low.####.irradpoints --high high.####.irradpoints -o "$folder/s.####.radsamples" --cache "$folder/c.####.irradcache" "$@"; }
divided divided --stats divided.json || bad '--high'
tempolux-info --check divided/* >/dev/null || bad '--high: not valid'
for threads in 1 2 3 7; do
  divided divided$threads --threads $threads && diff -r divided divided$threads || bad "--high: other files with $threads threads"
done
temporal --frame 3 --points low.0003.irradpoints --high high.0003.irradpoints --previous divided/s.0002.radsamples -o alone.radsamples --cache alone.irradcache || bad '--high: a frame alone'
cmp alone.radsamples divided/s.0003.radsamples || bad '--high: a frame alone differs from a range'
for kind in range divided; do
  frame-render "$moving" --frame 4 --size 48x27 --spp 4 --pixel-error 0 --irradcache $kind/c.0004.irradcache --points p.0004.irradpoints --channels RGBA,layers -o $kind.exr -q ||
    bad "a frame from $kind"
done
aqm-compare divided.exr range.exr --layer indirect --json high.json -q >/dev/null
"${PYTHON:-python3}" - <<'END' || bad '--high: other light'
import json
bias = json.load(open("high.json"))["total"]["bias"]
r = json.load(open("divided.json"))["results"]
assert -0.03 < bias < 0.03, bias
assert r["shadow_rays.0"] > 50 * r["records.0"] and r["shadow_rays.4"] > 50 * r["records.4"] and r["retraced_share.4"] < 0.9, r
END
# Nothing high: the bytes of whole points, but for what the files came from.
photonmap-split p.0000.irradpoints --energy 1e9 --low low.irradpoints --high high.irradpoints -q
temporal --frame 0 --points low.irradpoints --high high.irradpoints -o none.radsamples --cache none.irradcache || bad 'nothing high'
[ "$(tempolux-info --digest none.irradcache | cut -d' ' -f1)" = "$(tempolux-info --digest range/c.0000.irradcache | cut -d' ' -f1)" ] || bad 'nothing high: other records'

# Refused: with what to do.
points='--points p.0001.irradpoints'
refuses 'not a way to gather' gather-temporal often "$moving" $points -o refused --cache refused.c
refuses 'not a way to gather' gather-temporal "$moving" $points -o refused --cache refused.c
refuses 'several frames need a pattern' temporal --frames 0-1 --points p.####.irradpoints -o refused --cache refused.c
refuses 'of one frame' temporal --frames 0-1 --points p.####.irradpoints --previous a -o s.####.radsamples --cache c.####.irradcache
refuses 'name them upwards' temporal --frames 1-0 --points p.####.irradpoints -o s.####.radsamples --cache c.####.irradcache
refuses 'moving_geometry' temporal --frame 0 $points -o refused --cache refused.c
refuses 'not a .radsamples file' temporal --frame 1 $points --previous range/c.0000.irradcache -o refused --cache refused.c
irradcache-build points "$moving" --frame 1 --photons p.photons --allow-stale --point-count 900 -o fewer.irradpoints -q 2>/dev/null
refuses 'its points lay elsewhere' temporal --frame 1 --points fewer.irradpoints --allow-stale --previous range/s.0000.radsamples -o refused --cache refused.c
# In a range, too: other points, fewer or more, in the middle of a segment. What was made before stays.
irradcache-build points "$moving" --frame 1 --photons p.photons --allow-stale --point-count 2k -o more.irradpoints -q
for other in fewer more; do
  mkdir $other.range; cp p.0000.irradpoints $other.range/p.0000.irradpoints; cp $other.irradpoints $other.range/p.0001.irradpoints
  refuses 'lie elsewhere than those of frame 0 before it' temporal --frames 0-1 --allow-stale --points $other.range/p.####.irradpoints \
    -o $other.range/s.####.radsamples --cache $other.range/c.####.irradcache
  [ -e $other.range/s.0000.radsamples ] && [ ! -e $other.range/s.0001.radsamples ] || bad "$other points: $(ls $other.range)"
done
refuses 'in another segment' temporal --frame 1 $points --segment 12 --previous range/s.0000.radsamples -o refused --cache refused.c
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$HERE/../formats "${PYTHON:-python3}" - <<'END' || bad 'files of no scene'
from read_radsamples import encode_radsamples, read_radsamples
f = read_radsamples("range/s.0000.radsamples")
for name, change in {"surface": {"surface": 999}, "triangle": {"triangle": 12345678}, "set": {"set": 1 - f.records[0].set}}.items():
    g = read_radsamples("range/s.0000.radsamples")
    g.records[0] = g.records[0]._replace(**change)
    open(f"forged-{name}.radsamples", "wb").write(encode_radsamples(g))
f.point_light.append((1, 1, 1))
open("forged-points.radsamples", "wb").write(encode_radsamples(f))
END
for forged in surface triangle set; do
  refuses 'which the scene does not have' temporal --frame 1 $points --previous forged-$forged.radsamples -o refused --cache refused.c
done
refuses 'it has the light of' temporal --frame 1 $points --previous forged-points.radsamples -o refused --cache refused.c
refuses 'hold all of the light' temporal --frame 1 --points low.0001.irradpoints --high high.0001.irradpoints --previous range/s.0000.radsamples -o refused --cache refused.c
refuses 'hold the low part of the light alone' temporal --frame 1 $points --previous divided/s.0000.radsamples -o refused --cache refused.c
refuses 'give the whole' temporal --frame 1 --points low.0001.irradpoints -o refused --cache refused.c
refuses 'several frames need a pattern' temporal --frames 0-1 --points low.####.irradpoints --high high.0000.irradpoints -o s.####.radsamples --cache c.####.irradcache
exit $failed
