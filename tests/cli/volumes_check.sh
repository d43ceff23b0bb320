# Media from files: what is read, what is refused, answers known on paper, the same bytes for any number of threads.
. "$HERE/expect.sh"
command -v make-vdb > /dev/null || { echo 'built without volumes'; exit 77; }
units=$HERE/../data/units
furnace=$units/U5_furnace_closed.gltf
python=${PYTHON:-python3}

# cube.vdb: density 1 in 16^3 voxels; smoke.vdb: a ball, denser inside; of the others each has one fault.
"$python" - <<'END' || bad 'values'
import math, struct
def write(name, f):
    with open(name, "wb") as out:
        out.write(b"".join(struct.pack("<f", f(x, y, z)) for x in range(16) for y in range(16) for z in range(16)))
write("ones", lambda x, y, z: 1.0)
write("zeros", lambda x, y, z: 0.0)
write("ball", lambda x, y, z: max(0.0, 1 - math.dist((x, y, z), (7.5, 7.5, 7.5)) / 8))
write("negative", lambda x, y, z: -1.0 if (x, y, z) == (3, 4, 5) else 1.0)
write("below", lambda x, y, z: -1.0 if x < 8 else 1.0)
write("nan", lambda x, y, z: math.nan if (x, y, z) == (3, 4, 5) else 1.0)
END
place="16 16 16 .05 -.375 -.375 -.375"
make-vdb cube.vdb $place < ones; make-vdb empty.vdb $place < zeros; make-vdb smoke.vdb $place < ball
make-vdb negative.vdb $place < negative; make-vdb nan.vdb $place < nan
make-vdb below.vdb $place < below; make-vdb int32.vdb $place density fog 0 int32 < ones
make-vdb flags.vdb $place density fog 0 bool < ones
make-vdb mixed.vdb $place surface level-set < ones; make-vdb mixed.vdb $place density < ones
make-vdb far.vdb 16 16 16 5 300 300 300 < ones
make-vdb half.vdb $place density fog 0 half < ones; make-vdb double.vdb $place density fog 0 double < ones
make-vdb level.vdb $place density level-set < ones; make-vdb outside.vdb $place density fog 0.5 < ones
make-vdb heat.vdb $place heat < ones; make-vdb vector.vdb $place density fog 0 vector < ones
make-vdb two.vdb $place heat < ones; make-vdb two.vdb $place soot < ball
make-vdb twins.vdb $place density < zeros; make-vdb twins.vdb $place density < ones
cp ones text.vdb; : > nothing.vdb

tiny="--size 8x8 --spp 1 --integrator path -q -o made.exr"
for file in cube half double heat empty; do expect 0 '' frame-render "$furnace" --volume $file.vdb $tiny; done
expect 0 '' frame-render "$furnace" --volume twins.vdb:density:1 $tiny
expect 0 '' frame-render "$furnace" --volume two.vdb:soot $tiny
refused() { expect 2 "$2" frame-render "$furnace" --volume $1 $tiny; }
# One voxel of 4096 is replaced, with a warning; more than a hundredth is another quantity. Seen to fail: all were refused.
mended() { expect 0 "$2" frame-render "$furnace" --volume $1 ${tiny% -q*} -o made.exr; }
mended negative.vdb "grid 'density': voxel (3, 4, 5) is -1; a density is finite and not negative, so 0 replaces it"
mended nan.vdb "voxel (3, 4, 5) is nan"
refused below.vdb "so 'density' is another quantity, or damaged"
mended int32.vdb ''
mended flags.vdb ''
refused level.vdb "level.vdb: grid 'density' is not a density but a level set (distances from a surface); convert it"
# The level set beside a density is not among the offers.
refused mixed.vdb:surface 'a level set (distances from a surface); choose from density (fog volume)'
# Smoke in centimetres is outside of the room and of the picture.
mended far.vdb 'nothing sees it: its voxels lie outside of the scene'
refused vector.vdb 'is not a density'
refused outside.vdb 'not 0 outside its voxels'
refused two.vdb 'several grids that could be meant: heat (fog volume), soot (fog volume)'
refused twins.vdb 'several grids that could be meant'
refused text.vdb 'text.vdb: is not an OpenVDB file'
refused nothing.vdb 'is not an OpenVDB file'
refused absent.vdb 'absent.vdb: cannot be opened'
refused 'smoke.####.vdb' 'smoke.0000.vdb: cannot be opened'
expect 2 "has no grid 'fire'; it has density" frame-render "$furnace" --volume cube.vdb:fire $tiny
expect 2 'name one' frame-render "$furnace" --sigma-t 3 $tiny
expect 2 'is given 2 times for 1 volumes' frame-render "$furnace" --volume cube.vdb --sigma-t 3 --sigma-t 4 $tiny
expect 2 'at most 1' frame-render "$furnace" --volume cube.vdb --albedo 2 $tiny

# A file cut anywhere: an error in one line, or voxels that are whole; never a signal, never long.
size=$(wc -c < smoke.vdb)
for percent in 1 5 10 20 30 40 50 60 70 80 90 95 99; do
  head -c $((size * percent / 100)) smoke.vdb > cut.vdb
  timeout 10 frame-render "$furnace" --volume cut.vdb $tiny > out.txt 2>&1
  code=$?
  case $code in 0) ;; 2) [ "$(wc -l < out.txt)" = 1 ] || bad "cut at $percent %: $(cat out.txt)";; *) bad "cut at $percent %: exit $code: $(cat out.txt)";; esac
done

means() { tempolux-info --json "$1" > info.json; }
check() {  # FILE TOLERANCE R G B [LAYER.]: means of channels
  means "$1"
  "$python" - "$2" "$3" "$4" "$5" "$6" <<'END' || bad "$1: $2 $3 $4 $5"
import json, sys
tolerance, *wanted = map(float, sys.argv[1:5])
prefix = sys.argv[5] if len(sys.argv) > 5 else ""
channels = {c["channel"]: c["mean"] for c in json.load(open("info.json"))["channels"]}
for name, want in zip("RGB", wanted):
    got = channels[prefix + name]
    assert abs(got - want) <= tolerance * max(want, 1e-9), (name, got, want)
END
}

# A cube of soot above the middle: in a file whose +z is up, and in one whose +y is.
make-vdb up_y.vdb 16 16 16 .05 -.375 .025 -.375 < ones; make-vdb up_z.vdb 16 16 16 .05 -.375 -.375 .025 < ones
dark="--sigma-t 9 --albedo 0 --size 16x16 --spp 64 --integrator path -q"
frame-render "$furnace" --volume up_y.vdb $dark -o up_y.exr && frame-render "$furnace" --volume up_z.vdb --volume-up z $dark -o up_z.exr &&
  frame-render "$furnace" --volume up_z.vdb $dark -o wrong.exr || bad 'axes of smoke'
red() { tempolux-info --json "$1" | "$python" -c 'import json, sys; print(next(c["mean"] for c in json.load(sys.stdin)["channels"] if c["channel"] == "R"))'; }
"$python" -c 'import sys; y, z, wrong = map(float, sys.argv[1:]); sys.exit(not (abs(z / y - 1) < .02 < abs(wrong / y - 1)))' \
  "$(red up_y.exr)" "$(red up_z.exr)" "$(red wrong.exr)" || bad "axes of smoke: $(red up_y.exr) $(red up_z.exr) $(red wrong.exr)"
expect 2 'name one' frame-render "$furnace" --volume-up z $tiny

# A furnace: in a closed room of one radiance all around, smoke that absorbs nothing changes nothing, by paths, and by photons and slices.
# Noise: .3 % of the mean of a path traced picture, .6 % of a composed one, whose photons are few in the part of the room that is seen.
medium="--volume smoke.vdb --sigma-t 6 --albedo 1"
frame-render "$furnace" $medium --size 32x32 --spp 64 --integrator path -q -o path.exr || bad 'path'
check path.exr .01 2 5 1.25
frame-render "$furnace" $medium --phase-g .8 --size 32x32 --spp 64 --integrator path -q -o g.exr || bad 'path, g'
check g.exr .01 2 5 1.25
photon-trace "$furnace" $medium --photons 1M --kinds indirect,volume -q -o p.photons || bad photons
frame-render "$furnace" $medium --size 32x32 --photons p.photons --spp 8 --channels RGBA,Z,layers -q -o base.exr || bad base
volume-compose "$furnace" $medium --photons p.photons --base base.exr -q -o composed.exr || bad compose
check composed.exr .02 2 5 1.25

# Without the medium the file is as if there were no such option, and no medium is known.
frame-render "$furnace" --volume none --size 8x8 --spp 1 --integrator path -q -o none.exr && frame-render "$furnace" --size 8x8 --spp 1 --integrator path -q -o plain.exr
[ "$(tempolux-info --digest none.exr | cut -c 1-32)" = "$(tempolux-info --digest plain.exr | cut -c 1-32)" ] || bad '--volume none is not nothing'
tempolux-info --json plain.exr | grep -q 'volume.R' && bad 'a layer volume without medium'
photon-trace "$furnace" --volume none --photons 10k --kinds indirect -q -o none.photons
expect 2 'media differ' volume-compose "$furnace" $medium --photons none.photons --base base.exr -o x.exr
photon-trace "$furnace" $medium --photons 10k --kinds indirect -q -o surfaces.photons
expect 2 'has no photons in media' volume-compose "$furnace" $medium --photons surfaces.photons --base base.exr -o x.exr
expect 2 'has smoke in its layer volume already' volume-compose "$furnace" $medium --photons p.photons --base composed.exr -o x.exr

# Sun and smoke that grows: under the segment's majorants photons of both frames start alike, and the first map can be updated.
cp smoke.vdb sun.0000.vdb; cp cube.vdb sun.0001.vdb
sun="$units/U2_directional.gltf --volume sun.####.vdb --volume-frames 0-1"
scene-plan $sun --frames 0-1 --update 10% -q -o plan || bad 'plan of sun and smoke'
bounds=$(ls plan/state/*.majorants)
sun="$sun --majorants $bounds --photons 10k --kinds direct,indirect,volume"
photon-trace $sun --frame 0 -q -o sun0.photons && photon-trace $sun --frame 1 -q -o fresh.photons || bad 'photons of the sun'
photon-trace $sun --frame 1 --update sun0.photons --strategy all -q -o updated.photons || bad 'update under the sun'
[ "$(tempolux-info --digest fresh.photons | cut -c 1-32)" = "$(tempolux-info --digest updated.photons | cut -c 1-32)" ] || bad 'an update of all groups is no fresh map'

# By pilots: refused where there are none; where the smoke is as it was nothing is traced; an update of all groups is a fresh map. Further paths
# keep what the lamps emit.
expect 2 'has no pilots' photon-trace $sun --frame 1 --update sun0.photons --share 10% --strategy dip -o x.photons
photon-trace $sun --frame 0 --pilots 3% -q -o pilots.photons && photon-trace $sun --frame 1 --pilots 3% -q -o fresh.photons || bad pilots
for strategy in fde dip hybrid path census; do
  photon-trace $sun --frame 1 --update pilots.photons --share 50% --strategy $strategy -q -o $strategy.photons --stats s.json || bad "$strategy"
  grep -q '"groups_updated": 0' s.json && bad "$strategy sees no change"
  photon-trace $sun --frame 1 --update fresh.photons --share 50% --strategy $strategy -q -o still.photons --stats s.json || bad "$strategy of the same smoke"
  grep -q '"groups_updated": 0' s.json && ! grep -q pilot_paths s.json || bad "$strategy traces where nothing has changed"
done
tempolux-info dip.photons | grep -q '^ *frame 1   groups' || bad 'no group says that it was traced at frame 1'
photon-trace $sun --frame 1 --update pilots.photons --strategy all -q -o updated.photons
tempolux-info --diff fresh.photons updated.photons > /dev/null || bad 'with pilots an update of all groups is no fresh map'
photon-trace $sun --frame 1 --update fresh.photons --refine 5k -q -o refined.photons || bad refine
"$python" - <<'END' || bad 'refined'
import json, subprocess
a, b = (json.loads(subprocess.run(["tempolux-info", "--json", f + ".photons"], capture_output=True, check=True).stdout) for f in ("fresh", "refined"))
assert b["emitted_paths"] == a["emitted_paths"] + 5000, b["emitted_paths"]
assert all(abs(x / y - 1) < 1e-6 for x, y in zip(a["emitted_flux_W"], b["emitted_flux_W"]))
END
# The number of paths that --photons means has another number of groups. The map's own number holds.
photon-trace ${sun%--photons*} $(echo "${sun#*--photons}" | cut -d' ' -f3-) --frame 1 --update fresh.photons --refine 5k -q -o again.photons || bad 'refine without --photons'
expect 2 'is the map of another state' photon-trace $sun --frame 1 --update pilots.photons --refine 5k -o x.photons
expect 2 'has another number of groups or paths' photon-trace $sun --frame 1 --update refined.photons --share 10% -o x.photons
# What movers change cannot be told apart where all light meets media: said before anything is made.
room=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
expect 2 '--moving records: the scene has media' scene-plan "$room" --volume smoke.vdb --frames 0-7 --moving records -q -o moving
expect 2 '--moving time: the scene has media' scene-plan "$room" --volume smoke.vdb --frames 0-7 --moving time -q -o moving

# Frames of a range are read together: one that is damaged does not harm those before it, and is named.
head -c 300 cube.vdb > sun.0001.vdb
expect 2 'sun.0001.vdb' photon-trace $sun --frames 0-1 -q -o range.####.photons
cmp range.0000.photons sun0.photons || bad 'frame 0 of a range whose frame 1 is damaged'

for threads in 1 2 3 7; do
  photon-trace "$furnace" $medium --photons 20k --kinds indirect,volume --threads $threads -q -o t$threads.photons
  volume-compose "$furnace" $medium --photons p.photons --base base.exr --threads $threads -q -o t$threads.exr
  cmp t1.photons t$threads.photons && cmp t1.exr t$threads.exr || bad "$threads threads"
done
exit $failed
