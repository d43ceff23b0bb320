# What frame-render learns of light from far away as a file: the same picture as learning it in the frame, the same bytes for any number
# of threads, the plan names it where there is something to learn, what is no such file is refused.
. "$HERE/expect.sh"
scenes=$HERE/../../pipelines/scenes
python3 -B - "$HERE/../bench" <<'EOF' || bad 'scene'
import sys
sys.path.insert(0, sys.argv[1])
from open_scenes import hut
hut(5, True).save("hut.glb")
EOF
sky='--environment-color 1,1,1' view='--camera inside --size 64x36' few='--spp 2 --pixel-error 0'
learn() { frame-render hut.glb $sky $view --learn-lights -q "$@" || bad "learn $*"; }
for threads in 1 2 3 7; do learn --threads $threads -o $threads.lightgrid; done
for threads in 2 3 7; do cmp 1.lightgrid $threads.lightgrid || bad "$threads threads: other bytes"; done
tempolux-info --json 1.lightgrid > info.json
python3 - <<'EOF' || bad "facts: $(cat info.json)"
import json
f = json.load(open("info.json"))
assert f["type"] == "lightgrid" and f["cells"] > 50 and f["parts"] == [32, 16] and 0 < f["mean_to_sky"] <= 1
EOF

# Kept as a file it aims the samples of the same frame to the last bit as it does when it is learned there.
learn $few -o learned.exr
expect 0 '' frame-render hut.glb $sky $view $few --lights 1.lightgrid -q -o read.exr
frame-render hut.glb $sky $view $few -q -o plain.exr
digest() { tempolux-info --json "$1" | sed -n 's/.*"digest": *"\(.*\)".*/\1/p'; }
[ "$(digest learned.exr)" = "$(digest read.exr)" ] || bad 'read from the file the picture is another'
[ "$(digest plain.exr)" != "$(digest read.exr)" ] || bad 'the file is not used'
# One grid for the cameras of several frames.
learn --frames 0-20x10 -o range.lightgrid
tempolux-info --diff 1.lightgrid 1.lightgrid > /dev/null || bad 'a file differs from itself'
# Nothing is to be learned under a lamp, or where most is open: no cells, and the plan says so.
frame-render "$scenes/S2_cornell_moving.glb" --size 64x36 --learn-lights -q -o lamp.lightgrid || bad 'lamp'
tempolux-info --json lamp.lightgrid | tr -d ' ' | grep -q '"cells":0,' || bad 'cells under a lamp'
expect 0 '' frame-render "$scenes/S2_cornell_moving.glb" --size 32x18 $few --lights lamp.lightgrid -q -o lamp.exr
scene-plan "$scenes/S2_cornell_moving.glb" --frames 0 -q -o lamp || bad 'plan under a lamp'
scene-plan hut.glb $sky --camera inside --frames 0 -q -o inside || bad 'plan inside'
scene-plan hut.glb $sky --camera outside --frames 0 -q -o outside || bad 'plan outside'
grep -q '^lights/' inside/plan.mk || bad 'the plan does not say that light comes through openings'
grep -q '^lights/' lamp/plan.mk outside/plan.mk && bad 'the plan has lights learned where there is nothing to learn'

expect 2 '--learn-lights alone' frame-render hut.glb $sky $view -o x.lightgrid
expect 2 'read or learn' frame-render hut.glb $sky $view --learn-lights --lights 1.lightgrid -o x.exr
head -c 5000 1.lightgrid > cut.lightgrid
expect 1 'cut.lightgrid: byte' tempolux-info --check cut.lightgrid
expect 2 'cut.lightgrid: byte' frame-render hut.glb $sky $view --lights cut.lightgrid -o x.exr
expect 2 'other parts of the sky' frame-render hut.glb $sky $view --lights "$HERE/../formats/lightgrid/accept/worked-example.lightgrid" -o x.exr
[ -e x.exr ] || [ -e x.lightgrid ] && bad 'a refused run left a file'
exit $failed
