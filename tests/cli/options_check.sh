# Options: limits are said in words and checked; what a run would not do is refused; messages are for people.
scenes=$HERE/../../pipelines/scenes
scene=$scenes/S1_cornell.glb
longest=300
. "$HERE/expect.sh"
render="frame-render $scene --size 8x6 --spp 1"

# Help: no types of the program, what is typed in the first line; limits as numbers.
for tool in photon-trace irradcache-build gather-temporal frame-render st-filter aqm-compare tempolux-info error-report scene-plan; do
  "$tool" --help >help.txt
  grep -nE 'INT|FLOAT|NONNEGATIVE|POSITIVE|[0-9]x\)|\[\[|179769' help.txt && bad "$tool --help: see above"
done
irradcache-build --help | grep -x 'Usage: irradcache-build \[OPTIONS\] \[points|records\] SCENE' >/dev/null || bad "$(irradcache-build --help | sed -n 2p)"
aqm-compare --help | grep -x 'Usage: aqm-compare \[OPTIONS\] test \[reference\]' >/dev/null || bad "$(aqm-compare --help | sed -n 2p)"
frame-render --help | grep -A2 -e '--neighbours N' | tr -d '\n' | grep -q '(2 to 512) \[50\]' || bad 'limits of --neighbours'

# Limits.
expect 2 "--spp: '0' is not from 1 to 16777216" $render -o made.exr --spp 0
expect 2 "--environment: '1,2': not a colour" $render -o made.exr --environment 1,2
expect 2 "--fail-above: 'nan' is not 0 or more" aqm-compare a.exr b.exr --fail-above nan

# What would be ignored.
photon-trace "$scene" --photons 1k -o p.photons -q || bad photons
irradcache-build points "$scene" --photons p.photons --point-count 100 -o p.irradpoints -q || bad points
irradcache-build records "$scene" --points p.irradpoints --size 8x6 --rays 4 -o c.irradcache -q || bad records
expect 2 'a frame is OpenEXR; name it f.exr' $render -o made.png
expect 2 '--integrator photons reads no cache' $render --integrator photons --photons p.photons --irradcache c.irradcache -o made.exr
for option in '--rays 5' '--size 8x6' '--points p.irradpoints' '--keep-points made.k'; do
  expect 2 "${option% *}: points does not read it" irradcache-build points "$scene" --photons p.photons -o made.irradpoints $option
done
for option in '--photons p.photons' '--point-count 5' '--light-samples 1' '--keep-points made.k'; do
  expect 2 "${option% *}: a run with --points does not read it" \
    irradcache-build records "$scene" --points p.irradpoints --size 8x6 -o made.irradcache $option
done
for count in 0 1G; do
  expect 2 "--point-count: .* is not from 1 to" irradcache-build points "$scene" --photons p.photons --point-count $count -o made.irradpoints
done

# Messages: no word of a library, no byte of the file, no frame that nobody asked for; the option as it is called.
for bytes in '\211PNG\r\n' 'hello' '\377\376'; do
  printf "$bytes" >none.glb
  expect 2 'none.glb: is neither a .glb nor a .gltf file' photon-trace none.glb -o made.photons
done
printf '{"asset": {"version": "2.0"},\n \201}' >none.gltf
expect 2 'none.gltf: line 2: column 2: syntax error' photon-trace none.gltf -o made.photons
grep -q 'json.exception\|last read' errors.txt && bad "$(cat errors.txt)"
moving=$scenes/S2_cornell_moving.glb
expect 0 '' frame-render "$moving" --frame 0 --size 8x6 --spp 1 --channels motion -o made.exr
expect 0 'frame 900 is outside the animation' frame-render "$moving" --frame 900 --size 8x6 --spp 1 --channels motion -o made.exr
irradcache-build points "$moving" --frame 3 --photons p.photons --point-count 50 --allow-stale -o moving.irradpoints -q
expect 2 'make it again for this one' irradcache-build records "$moving" --frame 9 --points moving.irradpoints --size 8x6 -o made.irradcache
for tool in photon-trace frame-render; do
  expect 2 "--frames: '5-x'" $tool "$scene" --frames 5-x -o made.exr
done

# Nothing emits: the frame is black, and it is said why; unless materials need no light.
"${PYTHON:-python3}" - "$scenes/cornell_classic.gltf" <<'END' || bad 'dark.gltf'
import json, sys
scene = json.load(open(sys.argv[1]))
for material in scene["materials"]:
    material.pop("emissiveFactor", None)
    material.pop("extensions", None)
json.dump(scene, open("dark.gltf", "w"))
for material in scene["materials"]:
    material["extensions"] = {"KHR_materials_unlit": {}}
scene["extensionsUsed"] = ["KHR_materials_unlit"]
json.dump(scene, open("unlit.gltf", "w"))
END
expect 0 'nothing in the scene emits light' frame-render dark.gltf --size 8x6 --spp 1 -o made.exr
expect 0 '' frame-render unlit.gltf --size 8x6 --spp 1 -o made.exr
exit $failed
