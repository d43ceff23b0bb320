# A helper that data has taken over: it dies where it opens a file or a socket, the tool says one line and exits 2. The helpers of
# copied tools are child-probe here, which does on purpose what hostile data would.
. "$HERE/expect.sh"
grep -q 'TEMPOLUX_GUARD:BOOL=ON' "$BUILD/CMakeCache.txt" && grep -q 'TEMPOLUX_SANITIZE:STRING=$' "$BUILD/CMakeCache.txt" ||
  { echo 'built without the guard, or with sanitizers, which need more than it allows'; exit 77; }
mkdir -p bin modules && cp "$BUILD/bin/frame-render" bin/ && cp "$BUILD/modules/tempolux-images.so" modules/
for helper in tempolux-vdb tempolux-oiio tempolux-decode; do cp "$BUILD/tests/child-probe" modules/$helper; done
scene=$HERE/../data/units/U5_furnace_closed.gltf
packed=$(find "$HERE/../data/packed/scenes" -name '*raco*.gl*' | head -1)
printf ' BDV\0\0\0\0' > smoke.vdb
jpeg=$HERE/../fuzz/corpus/pictures/baseline.jpg
tiny="--size 8x8 --spp 1 --integrator path -q -o made.exr"
export CHILD_PROBE CHILD_PROBE_CANARY="$PWD/canary"
tries() {  # MODE CODE WORDS: each tool that starts a helper
  CHILD_PROBE=$1
  expect 2 "$2" bin/frame-render "$scene" --volume smoke.vdb $tiny
  expect 2 "$2" bin/frame-render "$scene" --environment "$jpeg" $tiny
  [ -z "$packed" ] || expect 2 "$2" bin/frame-render "$packed" $tiny
}
tries guarded-create 'ended by its guard'
[ -e canary ] && bad 'a guarded helper made a file'
tries guarded-open 'ended by its guard'
tries guarded-socket 'ended by its guard'
tries free-create 'tempolux-'        # what it prints is no answer; but the canary shows that the guard, and nothing else, stopped it
[ -e canary ] || bad 'the canary is never made: this test shows nothing'
exit $failed
