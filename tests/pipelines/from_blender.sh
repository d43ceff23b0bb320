#!/bin/sh
# from_blender.sh BIN_DIR -- pipelines/blender/tempolux_export.py keeps lamps, constraints, world and numbers of frames.
# Skipped without Blender.
command -v blender > /dev/null || { echo 'there is no blender'; exit 77; }
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "from Blender: $*" >&2; exit 1; }
blender -b --factory-startup -P tests/pipelines/from_blender_shot.py -- "$work/shot.blend" > "$work/log" 2>&1 || bad "$(tail -3 "$work/log")"
blender -b --factory-startup "$work/shot.blend" -P pipelines/blender/tempolux_export.py -- "$work/shot.glb" > "$work/log" 2>&1
grep -q "No module named 'numpy'" "$work/log" && { echo "Blender's glTF exporter needs python3-numpy"; exit 77; }
[ -f "$work/shot.glb" ] || bad "$(tail -3 "$work/log")"
grep -qF 'material Noisy: Base Color by Noise Texture is not exported' "$work/log" || bad "a colour by nodes is lost in silence: $(cat "$work/log")"
grep -qF 'Inner: this lamp in an instanced collection is not exported' "$work/log" || bad "a lamp in a collection is lost in silence: $(cat "$work/log")"
grep -q INFO "$work/log" && bad "the exporter's own words: $(grep -m1 INFO "$work/log")"
line="make -f Makefile.example SCENE=$work/shot.glb FRAMES=3-6 SIZE=1920x1080 OUT=shot QUALITY=draft SKY=1,1.2,1.6 'TIME=--fps 30'"
grep -qxF "$line" "$work/log" || bad "does not print $line: $(grep make "$work/log")"
python3 - "$work/shot.glb" << 'END' || bad 'the file'
import json, math, struct, sys
data = open(sys.argv[1], "rb").read()
size = struct.unpack("<I", data[12:16])[0]
shot = json.loads(data[20:20 + size])
strength = {m["name"]: m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] for m in shot["materials"]
            if "KHR_materials_emissive_strength" in m.get("extensions", {})}
panel = 60 / (4 * 0.8 * 0.4)                        # Cycles: P / (4 area)
ball = 15 / (4 * math.pi ** 2 * 0.05 ** 2)          # P / 4 pi W/sr over the ball's outline, pi r^2
assert abs(strength["Panel"] / panel - 1) < 1e-5 and abs(strength["Panel.twin"] / panel - 1) < 1e-5, strength
assert 1 < strength["Bulb"] / ball < 1.03, strength   # an icosphere's outline is a little smaller
lights = shot["extensions"]["KHR_lights_punctual"]["lights"]
assert len(lights) == 1 and abs(lights[0]["intensity"] - 10 / (4 * math.pi)) < 1e-4, lights
used = [n["extensions"]["KHR_lights_punctual"]["light"] for n in shot["nodes"] if "KHR_lights_punctual" in n.get("extensions", {})]
assert used == [0], used
eye = next(i for i, n in enumerate(shot["nodes"]) if n["name"] == "Eye")
moved = {c["target"]["path"]: (a, c) for a in shot["animations"] for c in a["channels"] if c["target"]["node"] == eye}
assert {"rotation", "translation"} <= set(moved), moved
animation, channel = moved["rotation"]
times = shot["accessors"][animation["samplers"][channel["sampler"]]["input"]]
assert abs(times["min"][0] - 3 / 30) < 1e-5 and abs(times["max"][0] - 6 / 30) < 1e-5, times   # frames keep their numbers
assert shot["asset"]["generator"].endswith("tempolux_export")
looks = {m["name"]: (m["pbrMetallicRoughness"], m.get("extensions", {})) for m in shot["materials"]}
def near(a, b):
    return all(abs(x - y) < 1e-6 for x, y in zip(a, b))
plain, more = looks["Matte"]
assert plain["metallicFactor"] == 0 and more["KHR_materials_specular"]["specularFactor"] == 0 and near(plain["baseColorFactor"], (.2, .4, .6)), looks
plain, more = looks["Chrome"]
assert plain.get("metallicFactor", 1) == 1 and near([plain["roughnessFactor"]], [.1]) and near(plain["baseColorFactor"], (.9, .8, .7)), looks
plain, more = looks["Solid"]
chord = 4 * .2 ** 3 / (6 * .2 ** 2)                 # Cauchy's 4 V / S of a cube
assert near([more["KHR_materials_ior"]["ior"], more["KHR_materials_volume"]["thicknessFactor"]], [1.6, chord]), looks
assert "KHR_materials_transmission" in looks["Sheet"][1] and "KHR_materials_volume" not in looks["Sheet"][1], looks
assert near(looks["Noisy"][0]["baseColorFactor"], (.3, .3, .3)), looks
nodes = [shot["nodes"][c["target"]["node"]]["name"] for a in shot["animations"] for c in a["channels"]]
assert "Cube Matte" in nodes and "Cube Chrome" not in nodes, nodes
END

# An export over a file whose triangles have another order and whose corners differ by 1e-7 of their size leaves the
# file as it is, to the byte. If corners have moved by 1e-3, the file changes.
cat > "$work/stir.py" << 'END'
import json, struct, sys
import numpy
path, kept, by = sys.argv[-3], sys.argv[-2], float(sys.argv[-1])
data = bytearray(open(path, "rb").read())
size = struct.unpack_from("<I", data, 12)[0]
document, random = json.loads(data[20:20 + size]), numpy.random.default_rng(1)
for mesh in document["meshes"]:
    for part in mesh["primitives"]:
        for name, number in (("POSITION", part["attributes"]["POSITION"]), ("", part["indices"])):
            accessor = document["accessors"][number]
            start = 28 + size + document["bufferViews"][accessor["bufferView"]]["byteOffset"]
            kind = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
            rows = numpy.frombuffer(data, kind, accessor["count"] * (3 if name else 1), start).reshape(-1, 3)
            if name:
                rows += (by * abs(rows).max() * (2 * random.random(rows.shape) - 1)).astype("f4")
            else:
                rows[:] = numpy.roll(rows[random.permutation(len(rows))], 1, axis=1)
open(kept, "wb").write(data)
END
for by in 1e-7 1e-3; do
  blender -b --factory-startup -P "$work/stir.py" -- "$work/shot.glb" "$work/again.glb" $by > "$work/log" 2>&1 && cp "$work/again.glb" "$work/stirred.glb" || bad "$(tail -3 "$work/log")"
  blender -b --factory-startup "$work/shot.blend" -P pipelines/blender/tempolux_export.py -- "$work/again.glb" > "$work/log" 2>&1
  if cmp -s "$work/again.glb" "$work/stirred.glb"; then same=1e-7; else same=1e-3; fi
  [ $same = $by ] || bad "exported again over what differs by $by: $(grep -A3 Error "$work/log")"
done
"$1/frame-render" "$work/shot.glb" --frame 4 --fps 30 --environment 1,1.2,1.6 --size 16x9 --integrator path --spp 1 -o "$work/f.exr" > "$work/log" 2>&1 || bad "$(cat "$work/log")"
grep -v 'by way of mirrors and smooth glass is missing' "$work/log" | grep . && bad "a message: $(cat "$work/log")"   # the spot and the glass: true
echo 'from Blender: lamps, constraints, world, frames and a second export are right'
