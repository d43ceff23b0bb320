#!/bin/sh
# Make the pictures of docs/troubleshooting.md again: sh docs/make_troubleshooting.sh [BIN]
# Run at the top of the tree; BIN is the folder with the tools. Takes about half a CPU minute. Left the fault, right the
# cure, at one exposure.
bin=${1:-build/release/bin} out=docs/images scenes=pipelines/scenes
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
set -e
size='--size 200x113'

# chain NAME SCENE FRAME PHOTONS CACHE-OPTIONS...: a frame by way of the cache.
chain() {
  name=$1 scene=$2 frame=$3 photons=$4; shift 4
  "$bin/photon-trace" "$scenes/$scene" --frame "$frame" --photons "$photons" -o "$work/$name.photons" -q
  "$bin/irradcache-build" "$scenes/$scene" --frame "$frame" --photons "$work/$name.photons" $size "$@" \
    --keep-points "$work/$name.irradpoints" -o "$work/$name.irradcache" -q
  "$bin/frame-render" "$scenes/$scene" --frame "$frame" $size --irradcache "$work/$name.irradcache" \
    --points "$work/$name.irradpoints" --photons "$work/$name.photons" --channels RGBA,layers,id -o "$work/$name.exr" -q
}
# look NAME SCENE FRAME PHOTONS FRAME-OPTIONS...: a frame by the density of photons, looked up directly.
look() {
  name=$1 scene=$2 frame=$3 photons=$4; shift 4
  "$bin/photon-trace" "$scenes/$scene" --frame "$frame" --photons "$photons" -o "$work/$name.photons" -q
  "$bin/frame-render" "$scenes/$scene" --frame "$frame" $size --integrator photons --photons "$work/$name.photons" --spp 16 \
    --channels RGBA,layers,id "$@" -o "$work/$name.exr" -q
}
pair() {  # NAME LAYER-OPTIONS...
  name=$1; shift
  "$bin/tempolux-info" --sheet "$out/trouble-$name.png" --columns 2 --tile 200 "$@" "$work/$name-bad.exr" "$work/$name-good.exr"
  echo "$out/trouble-$name.png $(wc -c < "$out/trouble-$name.png")"
}

look leak-bad S3_indirect_room.glb 1 20k --neighbours 400
chain leak-good S3_indirect_room.glb 1 200k
pair leak --layer indirect

chain blotch-bad S2_cornell_moving.glb 12 20k --rays 16 --error-bound 0.4
chain blotch-good S2_cornell_moving.glb 12 200k
pair blotch --layer indirect

look corner-bad S1_cornell.glb 0 20k --neighbours 300
chain corner-good S1_cornell.glb 0 200k
pair corner --layer indirect

# Two frames between which only a box moves; shown is what changes from one to the next.
chain a S2_cornell_moving.glb 12 20k --rays 32 --seed 1
chain b S2_cornell_moving.glb 13 20k --rays 32 --seed 2
chain c S2_cornell_moving.glb 12 200k
chain d S2_cornell_moving.glb 13 200k
for x in 'a b bad' 'c d good'; do
  set -- $x
  "$bin/aqm-compare" "$work/$1.exr" "$work/$2.exr" --allow-stale --difference "$work/boiling-$3.png" -q 2> /dev/null
done
"$bin/tempolux-info" --sheet "$out/trouble-boiling.png" --columns 2 --tile 200 --exposure 0 "$work/boiling-bad.png" "$work/boiling-good.png"

# The short block becomes a mirror: light that it throws onto walls is found by chance in path tracing.
python3 - "$scenes/cornell_classic.gltf" "$work/mirror.gltf" << 'END'
import json, sys
scene = json.load(open(sys.argv[1]))
scene["materials"].append({"name": "Mirror", "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0.05}})
for mesh in scene["meshes"]:
    if mesh["name"] == "ShortBlock":
        for primitive in mesh["primitives"]:
            primitive["material"] = len(scene["materials"]) - 1
json.dump(scene, open(sys.argv[2], "w"))
END
scenes=$work size="--size 104x104"
"$bin/frame-render" $scenes/mirror.gltf $size --integrator path --spp 16 -o "$work/firefly-bad.exr" -q
chain firefly-good mirror.gltf 0 200k
pair firefly
