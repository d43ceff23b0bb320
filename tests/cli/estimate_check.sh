# make estimate says what a run costs and leaves nothing behind, not when it is interrupted either.
failed=0
bad() { echo "$*"; failed=1; }
export TMPDIR="$PWD/temporary"
mkdir temporary
estimate() { exec setsid env --default-signal=INT make -f "$HERE/../../Makefile.example" BIN="$(dirname "$(command -v scene-plan)")" SCENE="$HERE/../../pipelines/scenes/S1_cornell.glb" SIZE=96x54 INDIRECT=records OUT=out "$@" estimate; }
unset MAKEFLAGS MFLAGS MAKELEVEL
(estimate) > said || bad "exits $?"
for stage in scene-plan 'make, previews' photon-trace irradcache-build frame-render st-filter; do grep -q "^$stage" said || bad "says nothing of $stage: $(cat said)"; done
awk '/^make, previews/ { rest = $(NF - 5) } END { exit !(rest > 0.005) }' said || bad "shells cost nothing: $(cat said)"   # a process takes 1 ms, a command has ten
grep -q '^about [0-9]* s on' said || bad "says: $(cat said)"
[ -z "$(ls -A temporary)" ] && [ ! -e out ] || bad "left $(ls -A temporary) $(ls -A out)"
# Points with so many shadow rays take far longer than this test waits.
for signal in INT TERM; do
  estimate POINTS='--light-samples 4096 --point-count 1M' > /dev/null 2>&1 & process=$!
  for round in $(seq 100); do
    [ -n "$(find temporary -name '*.irradpoints.tmp.*')" ] && break
    sleep 0.1
  done
  [ -n "$(find temporary -name '*.irradpoints.tmp.*')" ] || bad "$signal: no sample within 10 s: $(find temporary)"
  kill -s $signal -- -$process
  wait $process 2> /dev/null
  for round in $(seq 50); do [ -z "$(ls -A temporary)" ] && break; sleep 0.1; done
  [ -z "$(ls -A temporary)" ] || bad "$signal: left $(find temporary)"
done
exit $failed
