# Light that a scene has is not left out without a word: kinds of photons, parts of maps, records that are missing,
# frames that others are built upon.
scenes=$HERE/../../pipelines/scenes
matte=$scenes/S1_cornell.glb moving=$scenes/S2_cornell_moving.glb
. "$HERE/expect.sh"
# A Cornell box whose short block is a mirror, with a second camera.
"${PYTHON:-python3}" - "$scenes/cornell_classic.gltf" <<'END' || bad 'mirror.gltf'
import copy, json, sys
scene = json.load(open(sys.argv[1]))
scene["materials"].append({"name": "Mirror", "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0.05}})
block = next(mesh for mesh in scene["meshes"] if mesh["name"] == "ShortBlock")
for primitive in block["primitives"]:
    primitive["material"] = len(scene["materials"]) - 1
camera = copy.deepcopy(next(node for node in scene["nodes"] if "camera" in node))
camera["name"], camera["translation"] = "Other", [x + 0.1 for x in camera.get("translation", [0, 0, 0])]
scene["nodes"].append(camera)
scene["scenes"][0]["nodes"].append(len(scene["nodes"]) - 1)
json.dump(scene, open("mirror.gltf", "w"))
END
# The same mirror, smooth, and a point lamp: what it sends there no path finds.
"${PYTHON:-python3}" - <<'END' || bad 'lamp.gltf'
import json
scene = json.load(open("mirror.gltf"))
scene["materials"][-1]["pbrMetallicRoughness"]["roughnessFactor"] = 0
json.dump(scene, open("smooth.gltf", "w"))
scene["extensionsUsed"] = scene.get("extensionsUsed", []) + ["KHR_lights_punctual"]
scene["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
scene["nodes"].append({"translation": [0, 1, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}})
scene["scenes"][0]["nodes"].append(len(scene["nodes"]) - 1)
json.dump(scene, open("lamp.gltf", "w"))
scene["materials"][-1]["pbrMetallicRoughness"]["roughnessFactor"] = 0.3
json.dump(scene, open("gloss.gltf", "w"))
END
for scene in smooth gloss; do expect 0 '' frame-render $scene.gltf --integrator path --size 16x9 --spp 1 -o made.exr; done
expect 0 'lamp.gltf: materials "Mirror": what point, spot and sun lights send by way of mirrors and smooth glass is missing' \
  frame-render lamp.gltf --integrator path --size 16x9 --spp 1 -o made.exr
# Any frame without photons lacks this light, if it matters: a pool in the sun. With a map of caustic light, it does not.
"${PYTHON:-python3}" - <<'END' || bad 'pool.glb'
import os, sys
sys.path.insert(0, os.path.join(os.environ["HERE"], "..", "stress"))
from scenes import Scene, box_mesh
scene = Scene()
scene.quad((-2, -1.5, 3), (2, -1.5, 3), (2, -1.5, -3), (-2, -1.5, -3), scene.material(0.6))
scene.mesh(*box_mesh((-2.1, -1.6, -3.1), (2.1, 0, 3.1)), scene.glass(ior=1.33))
scene.sun((-0.3, -0.9, -0.25), (3, 3, 3))
scene.document["extensions"]["KHR_lights_punctual"]["lights"][0]["name"] = "Noon"
scene.camera((0, 6, 5), (0, -0.5, 0), fov=0.7)
scene.save("pool.glb")
END
photon-trace pool.glb --environment 1,1,1 --photons 50k --kinds caustic,indirect -o pool.photons -q && irradcache-build points pool.glb --environment 1,1,1 --photons pool.photons --point-count 200 -o pool.irradpoints -q || bad 'pool'
missing='smooth glass is missing .* of the picture., as that of light "Noon"'
for light in "" "--points pool.irradpoints"; do
  expect 0 "$missing" frame-render pool.glb --environment 1,1,1 $light --size 48x27 --spp 2 -o made.exr
done
expect 0 '' frame-render pool.glb --environment 1,1,1 --points pool.irradpoints --photons pool.photons --size 48x27 --spp 2 -o made.exr
# A reference does not have the random numbers of the frame of the same seed, or it would err alike.
frame-render "$matte" --size 16x9 --spp 2 --channels RGBA -o paths.exr -q && frame-render "$matte" --size 16x9 --spp 2 --channels RGBA --integrator path -o reference.exr -q || bad 'paths'
[ "$(tempolux-info --digest paths.exr)" != "$(tempolux-info --digest reference.exr)" ] || bad 'the reference has the random numbers of the frame'
# A frame says its noise and, by photons of the audit's own, its bias.
frame-render "$matte" --size 64x36 --spp 4 --channels RGBA --audit 1 --stats audit.json -o audited.exr -q || bad 'audit'
for name in noise.codes noise.direct.codes audit.indirect audit.indirect_error audit.direct; do
  grep -q "\"$name\"" audit.json || bad "stats without $name"
done
# Paths would audit paths: a frame by paths under a sky is not audited and says so. Lamps are audited, by photons.
"${PYTHON:-python3}" - <<'END' || bad 'ground.glb'
import os, sys
sys.path.insert(0, os.path.join(os.environ["HERE"], "..", "stress"))
from scenes import Scene, box_mesh
for name in ("ground", "lit"):
    scene = Scene()
    scene.quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2), scene.material(0.6))
    scene.mesh(*box_mesh((-1, 0, -1), (1, 1, 1)), scene.material(0.6))
    if name == "lit":
        scene.quad((-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1), scene.material(0, 5))
    scene.camera((0, 3, 5), (0, 0.5, 0), fov=0.7)
    scene.save(f"{name}.glb")
END
for scene in ground lit; do
  frame-render $scene.glb --environment 1,1,1 --size 48x27 --spp 4 --channels RGBA --audit 1 --stats $scene.json -o $scene.exr -q || bad "audit of $scene"
  tempolux-info --account $scene.exr > $scene.said
done
grep -qx 'no bias, as camera paths find all light' ground.said && grep -q '"audit.unbiased": 1' ground.json || bad 'a frame by paths does not say that it has no bias'
grep -q '"name": "audit"' ground.json && bad 'paths were audited by paths'
grep -q '"audit.direct"' lit.json && ! grep -q 'no bias' lit.said || bad 'a frame with a lamp is not audited'
# Layer indirect has half of the light. Layer caustic has .01 %: its ninefold bias is below .1 % of the picture.
"${PYTHON:-python3}" - <<'END' || bad 'audited.exr'
import os, sys
sys.path.insert(0, os.path.join(os.environ["HERE"], "..", "stress"))
import exr
def save(name, **of):
    numbers = {f"tempolux:audit.{layer}{part}": value for layer, values in of.items()
               for part, value in zip(("", "_error", ".of_layer", ".of_layer_error"), values)}
    exr.write(name, 1, 1, {"R": [1.0]}, numbers=numbers)
faint = (.0009, .0004, 9, 4)
save("both.exr", caustic=faint, indirect=(.005, .001, .01, .002))
save("faint.exr", caustic=faint)
save("vague.exr", caustic=(.1, .5, 2.35, 10.85), indirect=(.005, .001, .01, .002), specular=(-.1, .01, -.2, .02))
END
tempolux-info --account both.exr | grep -qxF 'audit: indirect light +1.0 +- 0.2 %' || bad 'faint light is named in the account'
tempolux-info --account faint.exr | grep -qxF 'audit: indirect and caustic light are below 2 % of the picture' || bad 'account of faint light'
tempolux-info --account vague.exr 2> vague.warned | grep -qxF 'audit: indirect light +1.0 +- 0.2 %, light in mirrors and glass -20 +- 2 %, caustic light not known, as too few of the tested paths bring it' || bad 'account of a layer that the audit does not know'
expect 0 '--seen-error 0.01: .* codes are left' frame-render "$matte" --size 16x9 --spp 2 --seen-error .01 -o made.exr
tiny="--size 16x9 --rays 8" point="--point-count 200" frame="--size 16x9 --spp 2 --pixel-error 0"
for kinds in direct indirect caustic caustic,indirect; do
  photon-trace mirror.gltf --photons 5k --kinds $kinds -o "mirror.$kinds" -q || bad "photons: $kinds"
  photon-trace "$matte" --photons 5k --kinds $kinds -o "matte.$kinds" -q || bad "photons: $kinds"
done

# Without indirect light a map is refused, without caustic light there is a warning where there is a mirror. Beside a map of caustic light alone
# paths find the rest, unless the photons are to tell it.
for kinds in direct caustic; do
  for scene in mirror matte; do
    file=$matte; [ $scene = mirror ] && file=mirror.gltf
    expect 2 "holds no indirect light" frame-render "$file" --integrator photons --photons $scene.$kinds $frame -o made.exr
    expect 2 "holds no indirect light" irradcache-build points "$file" --photons $scene.$kinds $point -o made.irradpoints
    expect 2 "holds no indirect light" irradcache-build "$file" --photons $scene.$kinds $point $tiny -o made.irradcache
  done
done
expect 2 "holds no indirect light" frame-render mirror.gltf --photons mirror.direct $frame -o made.exr
expect 0 '' frame-render mirror.gltf --photons mirror.caustic $frame --channels caustic,indirect -o made.exr
for layer in caustic indirect; do
  tempolux-info --json made.exr | tr -d ' \n' | grep -q "\"$layer.G\"[^}]*\"max\":0[.0]*[,}]" && bad "caustic photons beside paths: no $layer light"
done
for kinds in indirect caustic,indirect; do
  word='mirror.indirect: holds no caustic light'; [ $kinds = caustic,indirect ] && word=
  expect 0 '' irradcache-build points "$matte" --photons matte.$kinds $point -o matte.$kinds.irradpoints
  expect 0 '' frame-render "$matte" --photons matte.$kinds $frame -o made.exr
  expect 0 "$word" irradcache-build points mirror.gltf --photons mirror.$kinds $point -o mirror.$kinds.irradpoints
  expect 0 "$word" frame-render mirror.gltf --photons mirror.$kinds $frame -o made.exr
done
kinds() { tempolux-info --json "$1" | sed -n 's/.*"kinds": *"\([^"]*\)".*/\1/p'; }
[ "$(kinds mirror.indirect.irradpoints)" = direct,indirect ] || bad "kinds of points: $(kinds mirror.indirect.irradpoints)"
for file in mirror.caustic,indirect matte.indirect matte.caustic,indirect; do
  [ "$(kinds $file.irradpoints)" = direct,caustic,indirect ] || bad "kinds of points of $file: $(kinds $file.irradpoints)"
done
expect 0 'mirror.indirect.irradpoints: holds no caustic light' \
  irradcache-build records mirror.gltf --points mirror.indirect.irradpoints $tiny -o mirror.irradcache
expect 0 '' irradcache-build records "$matte" --points matte.indirect.irradpoints $tiny -o matte.irradcache

# A cache holds no caustic light; without photons of it paths find what mirrors throw, and nothing is missed. Photons that are
# named and hold none are.
points="--points mirror.caustic,indirect.irradpoints"
expect 0 '' frame-render mirror.gltf --irradcache mirror.irradcache $points $frame --channels caustic -o made.exr
tempolux-info --json made.exr | tr -d ' \n' | grep -q '"caustic.G"[^}]*"max":0[.0]*[,}]' && bad 'no photons: no caustic light'
expect 0 '' frame-render mirror.gltf --irradcache mirror.irradcache $points --photons mirror.caustic,indirect $frame -o made.exr
expect 0 '' frame-render mirror.gltf --irradcache mirror.irradcache $points --photons mirror.caustic $frame -o made.exr
expect 0 'mirror.indirect: holds no caustic light' \
  frame-render mirror.gltf --irradcache mirror.irradcache $points --photons mirror.indirect $frame -o made.exr
expect 0 '' frame-render "$matte" --irradcache matte.irradcache --points matte.indirect.irradpoints $frame -o made.exr

# Parts of maps are refused. Of a cache of one record a whole picture can be made: rays find what is missing.
"${PYTHON:-python3}" -B - "$HERE/../formats" <<'END' || bad 'parts'
import sys
sys.path.insert(0, sys.argv[1])
from read_photons import read_photons, write_photons
from read_irradcache import read_irradcache, write_irradcache
for part in ("static", "dynamic"):
    photons = read_photons("matte.caustic,indirect")
    photons.header["map"] = part
    write_photons("matte." + part, photons)
cache = read_irradcache("matte.irradcache")
cache.records = cache.records[:1]
write_irradcache("one.irradcache", cache)
END
for part in static dynamic; do
  expect 2 "matte.$part: a $part map is a part" frame-render "$matte" --photons matte.$part $frame -o made.exr
  expect 2 "matte.$part: a $part map is a part" irradcache-build points "$matte" --photons matte.$part $point -o made.irradpoints
done
counted() { grep -q "\"$1\": *[1-9]" one.json; }
expect 0 '' frame-render "$matte" --irradcache one.irradcache $frame -o made.exr --stats one.json
counted gathered_in_pixels || bad 'one record: no ray in its place'
counted points_read && bad 'no points: some were read'
expect 0 '' frame-render "$matte" --irradcache one.irradcache --points matte.indirect.irradpoints $frame -o made.exr --stats one.json
counted gathered_in_pixels && counted points_read || bad 'one record and points: none was read'
expect 0 '' frame-render "$matte" --points matte.indirect.irradpoints $frame -o made.exr --stats one.json
counted gathered_in_pixels && counted points_read || bad 'points alone: none was read'
counted lookups && bad 'points alone: records were found'

# A base is of this state of the scene and of this view; what is kept of it is neither rounded nor independent noise.
render="--size 16x9 --spp 1"
for f in 3 9; do frame-render "$moving" --frame $f $render -o moving.$f.exr -q || bad "frame $f"; done
for camera in auto Other; do frame-render mirror.gltf --camera $camera $render -o mirror.$camera.exr -q || bad "camera $camera"; done
mask="--mask moving.9.exr"
expect 0 '' frame-render "$moving" --frame 9 $render $mask --base moving.9.exr -o made.exr
expect 2 'moving.3.exr: made for another state of the scene: moving_geometry' \
  frame-render "$moving" --frame 9 $render $mask --base moving.3.exr -o made.exr
expect 2 'mirror.auto.exr: made for another state of the scene' \
  frame-render "$moving" --frame 9 $render $mask --base mirror.auto.exr -o made.exr
expect 2 'mirror.Other.exr: seen by another camera' frame-render mirror.gltf $render $mask --base mirror.Other.exr -o made.exr
expect 0 'mirror.Other.exr: seen by another camera' \
  frame-render mirror.gltf $render $mask --base mirror.Other.exr -o made.exr --allow-stale
expect 0 '' frame-render mirror.gltf $render $mask --base mirror.auto.exr -o made.exr
expect 2 '--halves: pixels of --base' frame-render "$moving" --frame 9 --size 16x9 --spp 2 $mask --base moving.9.exr --halves -o made.exr
expect 2 '--half: would round the pixels of --base' frame-render "$moving" --frame 9 $render $mask --base moving.9.exr --half -o made.exr

# Seeds are 64 bits, not the nearest that is.
trace="photon-trace $matte --photons 1k -o made.photons"
for seed in 18446744073709551616 99999999999999999999999 -1 1.5 0x10; do expect 2 'is not a whole number from 0 to 2^64-1' $trace --seed=$seed; done
expect 0 '' $trace --seed 18446744073709551615
exit $failed
