# . each_tool.sh -- commands of all tools, on inputs that this makes in ./in; outputs are named without a folder.
# each_tool DO    calls DO NAME COMMAND... for each; a NAME is the tool's, and more where one is not enough.
scene=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
mirror=$PWD/in/mirror.glb in=$PWD/in
mkdir in
from=$scene
for change in still 'camera-from 2' mirror; do
  "${PYTHON:-python3}" -B "$HERE/../pipelines/edit_gltf.py" "$from" "in/${change%% *}.glb" $change || exit 1
  from=in/${change%% *}.glb
done
photon-trace "$mirror" -q --photons 20k --kinds caustic,indirect -o in/p.photons &&
irradcache-build "$mirror" -q --photons in/p.photons --point-count 1k --rays 50 --size 64x36 --keep-points in/p.irradpoints \
  -o in/c.irradcache &&
frame-render "$mirror" -q --size 96x54 --irradcache in/c.irradcache --points in/p.irradpoints --photons in/p.photons --spp 1 \
  --channels RGBA,layers,Z,id -o in/x.exr --stats in/x.json &&
photon-trace "$scene" -q --photons 20k --map static -o in/s.photons --paths in/s.paths &&
photon-trace "$scene" -q --frame 10 --map dynamic --static in/s.paths -o in/d.photons &&
irradcache-build points "$scene" -q --map static --photons in/s.photons --point-count 1k -o in/s.irradpoints &&
irradcache-build points "$scene" -q --frame 10 --update in/s.irradpoints --photons in/s.photons --dynamic in/d.photons --point-count 1k -o in/u.irradpoints &&
irradcache-build records "$scene" -q --map static --points in/s.irradpoints --rays 32 --size 32x18 -o in/s.irradcache &&
photonmap-split in/u.irradpoints -q --energy 1 --low in/l.irradpoints --high in/h.irradpoints &&
photon-trace "$scene" -q --photons 5k -o in/0.photons && photon-trace "$scene" -q --frame 1 --photons 5k -o in/1.photons &&
irradcache-build points "$scene" -q --photons in/0.photons --point-count 1k -o in/t.0000.irradpoints &&
irradcache-build points "$scene" -q --frame 1 --photons in/1.photons --point-count 1k -o in/t.0001.irradpoints &&
frame-render "$mirror" -q --size 96x54 --integrator path --spp 2 --halves --channels RGBA,layers,id -o in/r.exr &&
aqm-compare in/x.exr --reference-halves in/r_a.exr in/r_b.exr -q --json in/e.json || exit 1
each_tool() {
  "$1" scene-plan scene-plan "$scene" --frames 0-5 -o plan
  "$1" photon-trace photon-trace "$mirror" --photons 100k -o a.photons
  "$1" photon-trace-static photon-trace "$scene" --photons 20k --map static -o a.photons --paths a.paths
  "$1" photon-trace-dynamic photon-trace "$scene" --frame 10 --map dynamic --static "$in/s.paths" -o a.photons
  "$1" photonmap-split photonmap-split "$in/p.irradpoints" --low a.irradpoints --high b.irradpoints
  "$1" photonmap-split-photons photonmap-split "$in/p.photons" --energy 2 --low a.photons --high b.photons
  "$1" irradcache-build-update irradcache-build points "$scene" --frame 10 --point-count 1k --photons "$in/s.photons" \
    --update "$in/s.irradpoints" --dynamic "$in/d.photons" -o a.irradpoints
  "$1" irradcache-build-localised irradcache-build records "$scene" --frame 10 --update "$in/s.irradcache" --points "$in/u.irradpoints" \
    --dynamic "$in/d.photons" --rays 32 --size 32x18 -o a.irradcache
  "$1" irradcache-build-high irradcache-build records "$scene" --frame 10 --points "$in/l.irradpoints" --high "$in/h.irradpoints" --rays 32 \
    --size 32x18 -o a.irradcache
  "$1" irradcache-build irradcache-build "$mirror" --photons "$in/p.photons" --point-count 1k --rays 50 --size 64x36 \
    --keep-points a.irradpoints -o a.irradcache
  "$1" irradcache-build-records irradcache-build records "$mirror" --points "$in/p.irradpoints" \
    --frame 2 --rays 50 --size 64x36 -o a.irradcache
  "$1" gather-temporal gather-temporal final "$scene" --points "$in/t.####.irradpoints" --rays 50 --size 64x36 --frames 0-1 \
    -o "a.####.radsamples" --cache "a.####.irradcache"
  "$1" frame-render frame-render "$mirror" --size 96x54 --irradcache "$in/c.irradcache" --points "$in/p.irradpoints" \
    --photons "$in/p.photons" --spp 2 --channels RGBA,layers,Z,N,id -o a.exr
  "$1" frame-render-high frame-render "$scene" --frame 10 --size 48x27 --points "$in/l.irradpoints" --high "$in/h.irradpoints" --spp 2 -o a.exr
  "$1" frame-render-paths frame-render "$mirror" --size 96x54 --integrator path --spp 2 --halves -o a.exr
  "$1" st-filter st-filter "$in/x.exr" "$in/x.exr" "$in/x.exr" --quiet -o a.exr
  "$1" aqm-compare aqm-compare "$in/x.exr" --reference-halves "$in/r_a.exr" "$in/r_b.exr" --json a.json --difference d.exr
  "$1" error-report error-report --run scene=S,curve=a,x=1 "$in/x.json" "$in/e.json" \
    --run scene=S,curve=a,x=2 "$in/x.json" "$in/e.json" -o report
  "$1" tempolux-info tempolux-info "$in/p.photons" --export a.ply
  "$1" tempolux-info-png tempolux-info "$in/x.exr" --png a.png
}
