# irradcache-build: both steps and one run, extending, several frames, what it must refuse.
failed=0
bad() { echo "$*"; failed=1; }
same() { tempolux-info --diff "$1" "$2" >diff.txt; }   # equal data, whatever the history
refuses() {   # exit 2 and these words in one line; nothing is written
  words=$1; shift
  "$@" >out.txt 2>errors.txt
  code=$?
  [ $code = 2 ] || bad "exit $code, not 2: $*"
  grep -q -- "$words" errors.txt || bad "does not say '$words': $(cat errors.txt)"
  [ -e refused ] && bad "left an output: $*" && rm -f refused
}
scenes=$HERE/../../pipelines/scenes
still=$scenes/S1_cornell.glb moving=$scenes/S2_cornell_moving.glb round=$scenes/S3_indirect_room.glb
small="--size 48x27 --rays 64"
photon-trace "$still" --photons 20k -o p.photons -q || bad 'photons'

# The two steps and both in one give the same records; so do all numbers of threads.
irradcache-build points "$still" --photons p.photons --point-count 1k -o p.irradpoints -q || bad 'points'
irradcache-build records "$still" --points p.irradpoints $small -o two.irradcache -q --stats two.json || bad 'records'
irradcache-build "$still" --photons p.photons --point-count 1k $small -o one.irradcache --keep-points kept.irradpoints -q || bad 'both'
same two.irradcache one.irradcache || bad 'two steps differ from one'
same p.irradpoints kept.irradpoints || bad 'kept points differ'

for threads in 1 2 3 7; do
  irradcache-build "$still" --photons p.photons --point-count 1k $small -o "one.irradcache.$threads" --threads $threads -q
  irradcache-build points "$still" --photons p.photons --point-count 1k -o "p.irradpoints.$threads" --threads $threads -q
done
for threads in 2 3 7; do
  cmp one.irradcache.1 "one.irradcache.$threads" || bad "records differ with $threads threads"
  cmp p.irradpoints.1 "p.irradpoints.$threads" || bad "points differ with $threads threads"
done
tempolux-info --check one.irradcache p.irradpoints >/dev/null || bad 'not valid'
irradcache-build records "$still" --points - $small -o - -q <p.irradpoints >piped.irradcache || bad 'pipes'
same piped.irradcache two.irradcache || bad 'a pipe changes the records'

# Records count within 20 degrees whatever the error bound, and the file says it.
says() { tempolux-info --json "$1" | grep -q "\"least_cosine\": $2" || bad "$1 does not say least_cosine $2"; }
irradcache-build records "$still" --points p.irradpoints $small --error-bound 0.5 -o coarse.irradcache -q || bad 'coarse'
says two.irradcache '0.9[34]'
says coarse.irradcache '0.9[34]'

# A frame from the cache, and the same one however the cache came to be.
for cache in one two; do
  frame-render "$still" --size 48x27 --spp 2 --pixel-error 0 --irradcache $cache.irradcache --channels layers -o $cache.exr -q || bad "frame from $cache"
done
tempolux-info --diff one.exr two.exr >/dev/null || bad 'frames of equal caches differ'

# frame-render interpolates in the angle the file says: in one of 2.6 degrees a ball and a head look different.
photon-trace "$round" --frame 1 --photons 20k -o round.photons -q
irradcache-build "$round" --frame 1 --photons round.photons --point-count 1k $small -o round.irradcache -q || bad 'round'
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$HERE/../formats "${PYTHON:-python3}" - <<'END' || bad 'narrower'
from read_irradcache import read_irradcache, write_irradcache
cache = read_irradcache("round.irradcache")
cache.header["least-cosine"] = "0.999"
write_irradcache("narrow.irradcache", cache)
END
for cache in round narrow; do
  frame-render "$round" --frame 1 --size 48x27 --spp 2 --pixel-error 0 --irradcache $cache.irradcache --photons round.photons -o $cache.exr -q
done
pixels=$(tempolux-info --diff round.exr narrow.exr | sed -n 's/^ *channel R *pixels \([0-9]*\).*/\1/p')
[ "${pixels:-0}" -gt 50 ] || bad "another angle changes ${pixels:-0} pixels"

# Frames that are lit alike are one cache; frames that are not are refused.
irradcache-build "$still" --photons p.photons --point-count 1k $small --frames 0-2 -o frames.irradcache -q || bad '--frames'
irradcache-build "$still" --photons p.photons --point-count 1k $small --frame 0 -o frame.irradcache -q || bad 'one frame'
same frames.irradcache frame.irradcache || bad "the same camera needs other records at later frames: $(cat diff.txt)"
photon-trace "$moving" --frame 3 --photons 20k -o moving.photons -q
# A file of a range is that of its frame alone, also where each frame has a seed of its own.
photon-trace "$moving" --frame 4 --photons 4k -o range.4.photons -q && photon-trace "$moving" --frame 3 --photons 4k -o range.3.photons -q || bad photons
irradcache-build points "$moving" --frames 3-4 --seed-mode frame --photons range.#.photons --point-count 500 -o range.#.irradpoints -q || bad 'points of a range'
irradcache-build points "$moving" --frame 4 --seed-mode frame --photons range.4.photons --point-count 500 -o alone.irradpoints -q || bad 'points of a frame'
same range.4.irradpoints alone.irradpoints || bad "points of a range have the first frame's seed: $(cat diff.txt)"
refuses 'one cache cannot hold for both' irradcache-build "$moving" --photons moving.photons --point-count 500 $small --frames 3-5 -o refused

# Points in two parts: bright ones are sampled explicitly. Of an infinite limit nothing is high: the records of the whole. The same for any threads.
photonmap-split p.irradpoints --low low.irradpoints --high high.irradpoints --energy 1 -q || bad 'points divided'
photonmap-split p.irradpoints --low all.irradpoints --high none.irradpoints --energy 1e9 -q || bad 'points divided, nothing bright'
irradcache-build records "$still" --points p.irradpoints $small -o whole.irradcache -q || bad 'records of whole points'
irradcache-build records "$still" --points all.irradpoints --high none.irradpoints $small -o none.irradcache -q || bad 'records, nothing bright'
tempolux-info --diff whole.irradcache none.irradcache >/dev/null || bad 'nothing is bright, and records differ'
for threads in 1 2 3 7; do
  irradcache-build records "$still" --points low.irradpoints --high high.irradpoints $small --threads $threads -o split$threads.irradcache --stats split.json -q || bad "--high, $threads threads"
  cmp -s split1.irradcache split$threads.irradcache || bad "--high: other records by $threads threads"
done
grep -q '"bright_points": [1-9]' split.json || bad 'no bright points counted'
tempolux-info --diff whole.irradcache split1.irradcache >/dev/null && bad '--high changes nothing'
refuses 'the low part' irradcache-build records "$still" --points low.irradpoints $small -o refused
refuses 'not a part of light' irradcache-build records "$still" --points p.irradpoints --high high.irradpoints $small -o refused
refuses 'is the low part' irradcache-build records "$still" --points low.irradpoints --high low.irradpoints $small -o refused
refuses 'not a part of light' irradcache-build "$still" --photons p.photons --high high.irradpoints $small -o refused
refuses 'not a part of light' irradcache-build points "$still" --photons p.photons --high high.irradpoints -o refused
irradcache-build points "$still" --photons p.photons --point-count 700 -o other.irradpoints -q
photonmap-split other.irradpoints --low otherlow.irradpoints --high foreign.irradpoints --energy 1 -q
refuses 'not those of' irradcache-build records "$still" --points low.irradpoints --high foreign.irradpoints $small -o refused

# Wrong steps and inputs.
refuses 'is not a step' irradcache-build recrods "$still" --points p.irradpoints -o refused
refuses 'name the photon map with --photons' irradcache-build points "$still" -o refused
refuses 'name the points with --points' irradcache-build records "$still" -o refused
refuses 'either the photon map' irradcache-build "$still" -o refused
refuses 'either the photon map' irradcache-build "$still" --photons p.photons --points p.irradpoints -o refused
refuses 'several frames need a pattern' irradcache-build points "$still" --photons p.photons --frames 0-1 -o refused
refuses 'p.photons' irradcache-build "$moving" --frame 3 --photons p.photons $small -o refused
refuses 'moving.photons' irradcache-build "$moving" --frame 10 --photons moving.photons $small -o refused
refuses 'p.irradpoints' irradcache-build records "$moving" --frame 3 --points p.irradpoints $small -o refused
refuses 'p.photons' irradcache-build records "$still" --points p.photons $small -o refused
irradcache-build "$moving" --frame 10 --photons moving.photons --point-count 500 $small --allow-stale -o stale.irradcache -q || bad '--allow-stale'
exit $failed
