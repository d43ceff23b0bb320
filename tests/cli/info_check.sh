# tempolux-info on every kind of file: facts that are known, validity, digests, differences, exports.
failed=0
bad() { echo "$*"; failed=1; }
accept=$HERE/../formats/photons/accept refuse=$HERE/../formats/photons/refuse
py() { "${PYTHON:-python3}" -c "import json,sys; d=json.load(open('out.json')); assert $1, d" || bad "$2"; }

# Every file that a reader must accept is valid, every one it must refuse is not: exit 1, one line each.
tempolux-info --check "$accept"/*.photons >out.txt || bad "a good file is not valid"
[ "$(grep -c ': valid$' out.txt)" = "$(ls "$accept"/*.photons | wc -l)" ] || bad "$(cat out.txt)"
to_refuse=$(ls "$refuse"/*.photons | grep -v /overlay-base)   # good itself: others there lie on it
tempolux-info --check $to_refuse >out.txt 2>errors.txt
[ $? = 1 ] || bad 'bad files: exit not 1'
[ -s out.txt ] && bad "valid, but should not be: $(cat out.txt)"
[ "$(wc -l <errors.txt)" = "$(echo "$to_refuse" | wc -l)" ] || bad 'bad files: not one line each'
tempolux-info --check no-such-file 2>/dev/null
[ $? = 2 ] || bad 'a missing file is an error of the command: exit 2'

# --whole looks at the ends alone: each type is whole, and without its last byte, or with less of it, it is not. A file of
# no known type is whole unless it is empty.
printf '{"words": [1, 2, 3, 4, 5, 6, 7, 8, 9]}' >whole.json
for file in "$HERE"/../formats/*/accept/worked-example.* "$HERE"/../lib/image/example.exr "$HERE"/../fuzz/corpus/pictures/rgb.png whole.json; do
  tempolux-info --whole "$file" >out.txt && grep -q ': whole$' out.txt || bad "$file: not whole"
  size=$(wc -c <"$file")
  for most in $((size - 1)) $((size - 9)) $((size / 2)) 20 5 1 0; do
    head -c $most "$file" >cut
    tempolux-info --whole cut >out.txt 2>errors.txt
    [ $? = 1 ] && [ ! -s out.txt ] && [ "$(wc -l <errors.txt)" = 1 ] || bad "$file cut to $most bytes of $size: not noticed"
  done
done
echo words >cut && tempolux-info --whole cut >out.txt || bad 'a file of no known type: not whole'
tempolux-info --whole no-such-file 2>/dev/null
[ $? = 2 ] || bad '--whole of a missing file: exit 2'

# Facts of the worked example, computed from the page by the second reader.
example=$accept/worked-example.photons
tempolux-info --json "$example" >out.json || bad 'facts'
(cd "$HERE/../formats" && "${PYTHON:-python3}" - "$example" "$OLDPWD/out.json" <<'END') || bad 'facts differ from the second reader'
import json, math, struct, sys
from read_photons import read_photons
facts, p = json.load(open(sys.argv[2])), read_photons(sys.argv[1])
records = [struct.unpack("<6f2HHBB", b.records[i:i + 32]) for b in p.blocks for i in range(0, len(b.records), 32)]
assert facts["photons"] == len(records) > 0
for c in range(3):
    assert facts["stored_flux_W"][c] == math.fsum(r[3 + c] for r in records)
    assert math.isclose(facts["mean_flux_W"][c], facts["stored_flux_W"][c] / len(records), rel_tol=1e-12)
assert sum(kind["photons"] for kind in facts["by_kind"].values()) == len(records)
assert {line["object"]: line["photons"] for line in facts["by_object"]} == \
       {o: sum(r[8] == o for r in records) for o in {r[8] for r in records}}
END

# Names of objects stand beside their ids: the example's photons lie on object 7, the eighth node with a mesh.
"${PYTHON:-python3}" - <<'END'
import base64, json, struct
triangle = base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()
json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(8))}],
           "nodes": [{"name": f"Sofa {i}", "mesh": 0} for i in range(8)],
           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
           "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
           "bufferViews": [{"buffer": 0, "byteLength": 36}],
           "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + triangle}]}, open("s.gltf", "w"))
END
tempolux-info --scene s.gltf "$example" | grep -q 'object 7 .*name Sofa 7$' || bad 'no name of an object'

# Digest: an overlay with its base is the whole map; a map equals itself and differs from another.
tempolux-info --diff "$example" "$example" >out.txt || bad 'a file differs from itself'
[ -s out.txt ] && bad 'equal files need no words'
tempolux-info --diff "$example" "$accept/groups.photons" >out.txt
[ $? = 1 ] && grep -q '^digests' out.txt || bad 'two maps that differ'
tempolux-info --diff "$example" out.json 2>/dev/null
[ $? = 2 ] || bad '--diff of two types of file: exit 2'

# Points: one row or vertex for each photon.
photons=$(sed -n 's/^  "photons": \([0-9]*\),$/\1/p' out.json)
tempolux-info --export points.csv "$example" && [ "$(wc -l <points.csv)" = $((photons + 1)) ] || bad 'CSV'
tempolux-info - --export - <"$example" | cmp - points.csv || bad 'CSV of a pipe'
tempolux-info --export points.ply "$example" || bad 'PLY'
header=$(sed '/^end_header$/q' points.ply | wc -c)
[ "$(wc -c <points.ply)" = $((header + photons * 55)) ] || bad 'PLY: 55 bytes for each photon'
tempolux-info "$example" --export points.obj 2>/dev/null
[ $? = 2 ] || bad '--export to another format: exit 2'

# JSON: our own is told, checked and compared; others' is not ours.
tool-probe s.glb -o a.out --stats a.json --threads 1
tempolux-info --check a.json >/dev/null || bad 'statistics are not valid'
tempolux-info a.json | grep -q '^type  *tempolux.stats$' || bad 'statistics are not known'
echo '{"a": 1}' >other.json
tempolux-info --check other.json 2>/dev/null && bad 'JSON of others is valid'
"${PYTHON:-python3}" -c "print('{\"schema\":' + '['*200000 + ']'*200000 + '}')" >deep.json
tempolux-info --check deep.json 2>errors.txt
[ $? = 1 ] && grep -q deeper errors.txt || bad 'deep JSON'

# Images: made by PNG, which any Python can write; difference at a known pixel.
"${PYTHON:-python3}" - <<'END'
import struct, zlib
def png(name, rows):
    def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + bytes(v for p in row for v in p) for row in rows)
    open(name, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0))
                           + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))
rows = [[(0, 0, 0)] * 8 for _ in range(4)]
png("black.png", rows)
rows[2] = rows[2][:5] + [(255, 0, 0)] + rows[2][6:]
png("dot.png", rows)
END
tempolux-info --diff black.png dot.png --json >out.json
[ $? = 1 ] || bad 'images that differ: exit 1'
py 'd["channels_differing"] == [{"channel": "R", "pixels": 1, "largest": 1.0, "at": [5, 2]}]' 'difference of images'
tempolux-info --sheet sheet.png black.png dot.png --columns 1 && tempolux-info --json sheet.png >out.json || bad 'sheet'
py '(d["width"], d["height"]) == (8, 10)' 'sheet: two tiles of 8 x 4 and a gap of 2'
tempolux-info --png layer.png --layer indirect dot.png 2>errors.txt
[ $? = 2 ] && [ ! -e layer.png ] && grep -q '^tempolux-info: dot.png: ' errors.txt || bad "missing layer: $(cat errors.txt)"
# Several files are read at once. The output has their order, and ends before the first bad file.
many=$(for round in 1 2 3 4 5 6 7 8 9; do ls "$HERE"/../formats/*/accept/worked-example.*; done)
for file in $many; do tempolux-info --digest "$file"; done >one-by-one.txt
for threads in 1 5; do
  tempolux-info --threads $threads --digest $many >out.txt && cmp out.txt one-by-one.txt || bad "digests by $threads threads: another order"
  echo words >no-file
  tempolux-info --threads $threads --digest $many no-file $many missing >out.txt 2>errors.txt
  [ $? = 2 ] && cmp out.txt one-by-one.txt && grep -q '^tempolux-info: no-file: ' errors.txt && [ "$(wc -l <errors.txt)" = 1 ] ||
    bad "a bad file among many, by $threads threads: $(cat errors.txt)"
done
# Channels that are no colour layer, R among them.
tempolux-info --json "$HERE/../fuzz/corpus/pictures/zip.exr" >out.json || bad 'R without G and B'
py '[c["channel"] for c in d["channels"]] == ["A", "R", "id"] and d["layers"] == [] and d["channels"][1]["max"] == 39' 'R without G and B'
exit $failed
