#!/bin/sh
# A user's own stage in the middle of the chain: sh tests/pipelines/drop_kind.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. pipelines/examples/drop_kind.py removes the photons of
# one kind. The result must equal the map that photon-trace writes without this kind.
bin=$1 scene=pipelines/scenes/S2_cornell_moving.glb example=pipelines/examples/drop_kind.py
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
failed=0
bad() { echo "FAILED: $*"; failed=1; }
digest() { "$bin/tempolux-info" --digest "$1" | cut -d' ' -f1; }
# flux KEY FILE: the total with this name, three numbers.
flux() { "$bin/tempolux-info" --json "$2" | tr -d ' \n' | sed "s/.*\"$1\":\[\([^]]*\)\].*/\1/"; }
trace() { "$bin/photon-trace" $scene --frame 3 --photons 20k "$@" -q || exit 1; }

trace --kinds direct,indirect -o - > "$work/both.photons"
trace --kinds indirect -o "$work/indirect.photons"
python3 $example direct < "$work/both.photons" > "$work/dropped.photons" || bad 'the example failed'
"$bin/tempolux-info" --check "$work/dropped.photons" > /dev/null || bad 'what the example writes is not valid'
[ "$(digest "$work/dropped.photons")" = "$(digest "$work/indirect.photons")" ] || bad 'other photons than --kinds indirect records'
for total in stored_flux_W emitted_flux_W escaped_flux_W absorbed_flux_W; do
  [ "$(flux $total "$work/dropped.photons")" = "$(flux $total "$work/indirect.photons")" ] || bad "$total differs"
done
"$bin/tempolux-info" "$work/dropped.photons" | grep -q '^  drop_kind.py direct$' || bad 'its line is missing in the history'

# Every reader accepts the file without a message, and gives the same result as for the tool's file.
for map in dropped indirect; do
  for command in "irradcache-build points $scene --point-count 1k -o $work/$map.irradpoints" \
      "irradcache-build $scene --point-count 1k --rays 20 --size 32x18 -o $work/$map.irradcache" \
      "frame-render $scene --size 32x18 --spp 1 -o $work/$map.exr"; do
    "$bin"/$command --frame 3 --photons "$work/$map.photons" 2> "$work/stderr" || bad "$command: exit $?"
    [ -s "$work/stderr" ] && bad "$command: $(cat "$work/stderr")"
  done
done
for type in irradpoints irradcache exr; do
  [ "$(digest "$work/dropped.$type")" = "$(digest "$work/indirect.$type")" ] || bad ".$type differs"
done

# A photon map without the hashes of its scene: one warning, the same result.
python3 - "$work/dropped.photons" "$work/stranger.photons" <<'END' || bad 'identity could not be removed'
import sys
sys.path.insert(0, "tests/formats")
sys.dont_write_bytecode = True
from read_photons import HASHES, read_photons, write_photons
photons = read_photons(sys.argv[1])
for key in ("frames", *HASHES):
    photons.header.pop(key, None)
write_photons(sys.argv[2], photons)
END
"$bin/irradcache-build" points $scene --frame 3 --photons "$work/stranger.photons" --point-count 1k -o "$work/stranger.irradpoints" \
  2> "$work/stderr" || bad "without identity: exit $?"
[ "$(wc -l < "$work/stderr")" = 1 ] && grep -q 'does not say which scene' "$work/stderr" || bad "without identity: $(cat "$work/stderr")"
[ "$(digest "$work/stranger.irradpoints")" = "$(digest "$work/indirect.irradpoints")" ] || bad 'without identity: other points'

# The script keeps the columns of the remaining photons, accepts an empty map and refuses an overlay.
for file in tests/formats/photons/accept/*.photons; do
  for kind in direct caustic indirect volume; do
    if grep -q '^base: ' "$file"; then
      python3 $example $kind < "$file" > "$work/any.photons" 2> "$work/stderr" && bad "$file: an overlay, not refused"
    elif python3 $example $kind < "$file" > "$work/any.photons"; then
      "$bin/tempolux-info" --check "$work/any.photons" > /dev/null || bad "$file without $kind: not valid"
      "$bin/tempolux-info" --json "$work/any.photons" | sed -n '/by_kind/,/}/p' | grep -q "\"$kind\"" && bad "$file: $kind is left"
    else bad "$file: the example failed"
    fi
  done
done
[ $failed = 0 ] && echo ok
exit $failed
