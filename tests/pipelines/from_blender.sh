#!/bin/sh
# from_blender.sh BIN_DIR [PYTHON] -- pipelines/blender/tempolux_export.py keeps lamps, constraints, world, numbers of frames, what
# the render alone shows, what deforms; bakes nodes; names what it loses. By Blender, or by PYTHON with the module bpy.
# Skipped without them.
python=$2
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "from Blender: $*" >&2; exit 1; }
if [ "$python" ]; then
  [ -x "$python" ] || { echo "there is no $python: sh tests/pipelines/get_bpy.sh"; exit 77; }
  in_blender() { "$python" -B tests/pipelines/as_blender.py "$@"; }
else
  command -v blender > /dev/null || { echo 'there is no blender'; exit 77; }
  in_blender() {
    shot=$1 script=$2
    shift 2
    [ "$shot" = - ] && shot=
    blender -b --factory-startup ${shot:+"$shot"} -P "$script" -- "$@"
  }
fi
export_shot() { in_blender "$work/shot.blend" pipelines/blender/tempolux_export.py "$@" > "$work/log" 2>&1; }
in_blender - tests/pipelines/from_blender_shot.py "$work/shot.blend" > "$work/log" 2>&1
[ -f "$work/shot.blend" ] || bad "$(tail -3 "$work/log")"
export_shot "$work/shot.glb"
grep -q "No module named 'numpy'" "$work/log" && { echo "the exporter needs python3-numpy"; exit 77; }
[ -f "$work/shot.glb" ] || bad "$(tail -3 "$work/log")"
for words in 'material Noisy: colour by nodes: baked' 'Domain: smoke is left out' 'material Odd: becomes grey (ValueError: the node group Empty has no output)' \
    'Wave: its deformation: '; do
  grep -qF "$words" "$work/log" || bad "does not say '$words': $(cat "$work/log")"
done
grep -q 'INFO\|Traceback' "$work/log" && bad "words that are not ours: $(grep -m1 'INFO\|Traceback' "$work/log")"
[ "$(grep '^tempolux_export.py: ' "$work/log" | tail -3 | sed 's/^tempolux_export.py: //; s/:.*//' | tr '\n' ,)" = 'kept,baked,lost or changed,' ] ||
  bad "no summary of three lines: $(cat "$work/log")"
line="make -f $PWD/Makefile.example SCENE=$work/shot.glb FRAMES=3-6 SIZE=1920x1080 OUT=$work/shot QUALITY=draft EXPOSURE=-1.5 SKY=1,1.2,1.6 'TIME=--fps 30'"
grep -qxF "$line" "$work/log" || bad "does not print $line: $(grep make "$work/log")"
python3 - "$work/shot.glb" << 'END' || bad 'the file'
import json, math, struct, sys
data = open(sys.argv[1], "rb").read()
size = struct.unpack("<I", data[12:16])[0]
shot, binary = json.loads(data[20:20 + size]), data[28 + size:]
def numbers(index):
    accessor = shot["accessors"][index]
    start = shot["bufferViews"][accessor["bufferView"]]["byteOffset"]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
    return struct.unpack_from(f"<{width * accessor['count']}f", binary, start)
strength = {m["name"]: m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] for m in shot["materials"]
            if "KHR_materials_emissive_strength" in m.get("extensions", {})}
old = int(shot["asset"]["generator"].split()[1].split(".")[0]) < 4
panel = 60 * (1 / 4 if old else 1 / math.pi) / (0.8 * 0.4)   # Cycles of 3.4: P / (4 area); of 4.2 and later: P / (pi area)
ball = 15 / (4 * math.pi ** 2 * 0.05 ** 2)          # P / 4 pi W/sr over the ball's outline, pi r^2
assert all(abs(v / panel - 1) < 1e-5 for k, v in strength.items() if k.startswith(("Panel", "Holder Inner"))), strength
assert sum(k.startswith(("Panel", "Holder Inner")) for k in strength) == 3, strength   # a lamp in an instanced collection too
assert 1 < strength["Bulb"] / ball < 1.03, strength   # an icosphere's outline is a little smaller
lights = {light["name"]: light for light in shot["extensions"]["KHR_lights_punctual"]["lights"]}
assert set(lights) == {"Spot", "Flicker"} and abs(lights["Spot"]["intensity"] - 10 / (4 * math.pi)) < 1e-4, lights
brighter = lights["Flicker"]["intensity"] * 4 * math.pi   # 1 W, or 8 by three stops where this Blender has Exposure
assert min(abs(brighter - 1), abs(brighter - 8)) < 1e-3, lights
named = {n["name"]: n for n in shot["nodes"]}
def channels(pick):
    return {pick(c): (a["samplers"][c["sampler"]], c) for a in shot["animations"] for c in a["channels"] if pick(c)}
def of(name):
    number = next(i for i, n in enumerate(shot["nodes"]) if n["name"] == name)
    return channels(lambda c: c["target"].get("node") == number and c["target"]["path"])
pointers = channels(lambda c: c["target"].get("extensions", {}).get("KHR_animation_pointer", {}).get("pointer"))
flicker = [v for k, v in pointers.items() if k.endswith("/intensity")]
assert len(flicker) == 1 and abs(numbers(flicker[0][0]["output"])[-1] / numbers(flicker[0][0]["output"])[0] - 4) < 1e-4, pointers
moved = of("Eye")
assert {"rotation", "translation"} <= set(moved), moved
times = shot["accessors"][moved["rotation"][0]["input"]]
assert abs(times["min"][0] - 3 / 30) < 1e-5 and abs(times["max"][0] - 6 / 30) < 1e-5, times   # frames keep their numbers
shift = shot["cameras"][0]["extras"]["lens_shift"]
assert abs(shift[0] - .2 * 16 / 9) < 1e-5 and abs(shift[1] - .1 * 16 / 9) < 1e-5, shift   # Blender's unit is the width
late, _ = of("Late")["scale"]
assert late["interpolation"] == "STEP" and numbers(late["output"])[0] == 0 and abs(numbers(late["output"])[-1] - 1) < 1e-6, late
assert len(numbers(of("Wave")["weights"][0]["output"])) and "Domain" not in named, named
finer = shot["meshes"][named["Finer"]["mesh"]]["primitives"][0]["attributes"]["POSITION"]
assert shot["accessors"][finer]["count"] >= 98, shot["accessors"][finer]   # two levels of a cube, which the render alone has
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
assert "baseColorTexture" in looks["Noisy"][0], looks
# Metallic between 0 and 1 is a mixture in Blender and in glTF.
plain, more = looks["Half"]
assert plain["metallicFactor"] == .5 and near(plain["baseColorFactor"], (.9, .3, .1)) and "KHR_materials_ior" not in more, looks["Half"]
# A quarter of a mirror of .8: the reflection is .2 at all angles; of the matte part .75 is seen, as .8 times what the file says.
plain, more = looks["Glazed"]
specular = more["KHR_materials_specular"]
along, front = specular["specularFactor"], [.04 * specular["specularFactor"] * t for t in specular["specularColorFactor"]]
assert plain["metallicFactor"] == 0 and near(front, (.2, .2, .2)) and near([along], [.2]), looks["Glazed"]
assert near([.8 * c for c in plain["baseColorFactor"][:3]], [.75 * c for c in (.1, .4, .2)]), looks["Glazed"]
# Metallic .3 without a dielectric reflection.
plain, more = looks["Bare"]
assert near([plain["metallicFactor"]], [.3]) and more["KHR_materials_specular"]["specularFactor"] == 0, looks["Bare"]
# Blender's widths are r^2 / a and r^2 a, a^2 = 1 - .9 * .8; on the side of a cylinder the wide one goes round the axis.
plain, more = looks["Brushed"]
a = (1 - .9 * .8) ** .5
thin, wide = plain["roughnessFactor"] ** 2, more["KHR_materials_anisotropy"]["anisotropyStrength"] ** 2
assert near([thin, wide * (1 - thin) + thin], [.35 ** 2 * a, .35 ** 2 / a]), looks["Brushed"]
attributes = shot["meshes"][named["Brushed"]["mesh"]]["primitives"][0]["attributes"]
normals, tangents = numbers(attributes["NORMAL"]), numbers(attributes["TANGENT"])
sides = [k for k in range(len(normals) // 3) if abs(normals[3 * k + 1]) < .9]
def around(k):
    x, y, z = normals[3 * k:3 * k + 3]
    across = math.hypot(x, z)
    return z / across, 0, -x / across, 1
assert len(sides) >= 16 and all(abs(p - q) < .02 for k in sides for p, q in zip(tangents[4 * k:4 * k + 4], around(k))), "tangents"
# In Blender nothing is behind a lamp without power; one that has power in any frame stays.
assert "Dark" not in named and not any(k.startswith("Dark") for k in [*strength, *looks]), sorted(named)
assert "Rises" in named, sorted(named)
wraps = {}
for name in ("Once", "Thrice"):
    texture = shot["materials"][shot["meshes"][named[name]["mesh"]]["primitives"][0]["material"]]["pbrMetallicRoughness"]["baseColorTexture"]
    wraps[name] = shot["samplers"][shot["textures"][texture["index"]]["sampler"]]["wrapS"]
assert wraps == {"Once": 33071, "Thrice": 10497}, wraps
# Glass: no normal leans away from its triangle by more than 30 degrees; where the cylinder is round, normals stay smooth.
part = shot["meshes"][named["Tumbler"]["mesh"]]["primitives"][0]
def rows(index, size):
    values = numbers(index)
    return [values[k:k + size] for k in range(0, len(values), size)]
points, normals = rows(part["attributes"]["POSITION"], 3), rows(part["attributes"]["NORMAL"], 3)
view = shot["accessors"][part["indices"]]
corners = struct.unpack_from(f"<{view['count']}{'H' if view['componentType'] == 5123 else 'I'}", binary,
                             shot["bufferViews"][view["bufferView"]]["byteOffset"])
def dot(a, b):
    return sum(x * y for x, y in zip(a, b))
cosines = []
for k in range(0, len(corners), 3):
    a, b, c = (points[i] for i in corners[k:k + 3])
    u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    cosines += [dot(cross, normals[i]) / math.sqrt(dot(cross, cross)) for i in corners[k:k + 3]]
assert min(cosines) > math.cos(math.radians(30)) and min(cosines) < .999, (min(cosines), max(cosines))
animated = [shot["nodes"][c["target"]["node"]]["name"] for a in shot["animations"] for c in a["channels"] if "node" in c["target"]]
assert "Cube Matte" in animated and "Cube Chrome" not in animated, animated
END

# An export over a file whose triangles have another order and whose corners differ by 1e-7 of their size leaves the
# file as it is, to the byte. If corners have moved by 1e-3, the file changes.
cat > "$work/stir.py" << 'END'
import json, struct, sys
import numpy
path, kept, by = sys.argv[-3], sys.argv[-2], float(sys.argv[-1])
data = bytearray(open(path, "rb").read())
size = struct.unpack_from("<I", data, 12)[0]
document, random, done = json.loads(data[20:20 + size]), numpy.random.default_rng(1), set()
for mesh in document["meshes"]:
    if any("targets" in part for part in mesh["primitives"]):
        continue
    for part in mesh["primitives"]:
        for name, number in (("POSITION", part["attributes"]["POSITION"]), ("", part["indices"])):
            if number in done:                           # equal arrays are stored once
                continue
            done.add(number)
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
  in_blender - "$work/stir.py" "$work/shot.glb" "$work/again.glb" $by > "$work/log" 2>&1 && cp "$work/again.glb" "$work/stirred.glb" || bad "$(tail -3 "$work/log")"
  export_shot "$work/again.glb"
  if cmp -s "$work/again.glb" "$work/stirred.glb"; then same=1e-7; else same=1e-3; fi
  [ $same = $by ] || bad "exported again over what differs by $by: $(grep -A3 Error "$work/log")"
done
"$1/frame-render" "$work/shot.glb" --frame 4 --fps 30 --environment 1,1.2,1.6 --size 16x9 --integrator path --spp 1 -o "$work/f.exr" > "$work/log" 2>&1 || bad "$(cat "$work/log")"
grep -v 'by way of mirrors and smooth glass is missing' "$work/log" | grep . && bad "a message: $(cat "$work/log")"   # the spot and the glass: true
echo 'from Blender: lamps, constraints, world, frames, render state, deformation, bakes and a second export are right'
