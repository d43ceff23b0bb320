# scene-plan --estimate says what a run costs and leaves nothing behind, not when it is interrupted either.
failed=0
bad() { echo "$*"; failed=1; }
scene="$HERE/../../pipelines/scenes/S1_cornell.glb"
export TMPDIR="$PWD/temporary"
mkdir temporary
scene-plan "$scene" --estimate --size 48x27 --threads 1 > said || bad "exits $?"
grep -q frame-render said || bad "says: $(cat said)"
[ -z "$(ls -A temporary)" ] || bad "left $(ls -A temporary)"
# Points with so many shadow rays take far longer than this test waits.
for pair in INT:2 TERM:15; do
  signal=${pair%:*}
  env --default-signal=INT scene-plan "$scene" --estimate --point-words '--light-samples 4096 --point-count 1M' & process=$!
  for round in $(seq 100); do
    [ -n "$(find temporary -name '.p.irradpoints.tmp.*')" ] && break
    sleep 0.1
  done
  [ -n "$(find temporary -name '.p.irradpoints.tmp.*')" ] || bad "$signal: no short run within 10 s: $(find temporary)"
  kill -$signal $process
  wait $process 2> /dev/null
  code=$?
  [ $code = $((128 + ${pair#*:})) ] || bad "$signal: exit $code"
  [ -z "$(ls -A temporary)" ] || bad "$signal: left $(find temporary)"
done
exit $failed
