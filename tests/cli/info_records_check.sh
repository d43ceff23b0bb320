# tempolux-info on .irradpoints and .irradcache: facts that are known, validity, digests, differences, exports.
failed=0
bad() { echo "$*"; failed=1; }
formats=$HERE/../formats

for type in irradpoints irradcache; do
  accept=$formats/$type/accept refuse=$formats/$type/refuse example=$formats/$type/accept/worked-example.$type
  tempolux-info --check "$accept"/* >out.txt || bad "$type: a good file is not valid"
  [ "$(grep -c ': valid$' out.txt)" = "$(ls "$accept" | wc -l)" ] || bad "$(cat out.txt)"
  tempolux-info --check "$refuse"/* >out.txt 2>errors.txt
  [ $? = 1 ] && [ ! -s out.txt ] && [ "$(wc -l <errors.txt)" = "$(ls "$refuse" | wc -l)" ] ||
    bad "$type: bad files: not one line each: $(cat out.txt)"
  tempolux-info "$accept"/* >out.txt && tempolux-info --json "$accept"/* >out.json || bad "$type: facts"

  # Digest: as on the page. A file equals itself; another file, and another type, differ.
  page=$(sed -n 's/.*digest is \([0-9a-f]\{32\}\).*/\1/p' "$HERE/../../formats/$type/$type.md")
  [ "$(tempolux-info --digest "$example" | cut -d' ' -f1)" = "$page" ] || bad "$type: digest is not the page's, '$page'"
  tempolux-info --diff "$example" "$example" >out.txt && [ ! -s out.txt ] || bad "$type: a file differs from itself"
  tempolux-info --diff "$example" "$accept/no-history.$type" >out.txt
  [ $? = 0 ] && grep -q history out.txt || bad "$type: history is shown, and does not count"
  tempolux-info --diff "$example" "$accept/origin-far-away.$type" >/dev/null
  [ $? = 1 ] || bad "$type: files that differ: exit 1"
  tempolux-info --diff "$example" "$formats/photons/accept/worked-example.photons" 2>/dev/null
  [ $? = 2 ] || bad "$type: --diff of two types of file: exit 2"

  # Facts and rows of the worked example, against the second reader.
  tempolux-info --json "$example" >out.json || bad "$type: facts"
  tempolux-info --export rows.csv "$example" || bad "$type: CSV"
  tempolux-info --export points.ply "$example" || bad "$type: PLY"
  PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$formats "${PYTHON:-python3}" - $type "$example" <<'END' || bad "$type: differs from the second reader"
import csv, importlib, json, math, struct, sys
name, path = sys.argv[1:]
file = getattr(importlib.import_module("read_" + name), "read_" + name)(path)
facts, rows = json.load(open("out.json")), list(csv.DictReader(open("rows.csv")))
points = name == "irradpoints"
records = file.points if points else file.records
assert facts["points" if points else "records"] == len(records) == len(rows) > 0
assert facts["by_set"]["dynamic"] == sum(r.set == 1 for r in records)
for row, r in zip(rows, records):
    assert [float(row[k]) for k in ("x_m", "y_m", "z_m")] == list(r.position) and int(row["object"]) == r.object
    assert math.isclose(float(row["radius_m"]), r.radius, rel_tol=1e-8)
for kind in ("direct", "indirect") if points else ("irradiance",):
    values = [r.irradiance[kind] if points else r.irradiance for r in records]
    for c, channel in enumerate("rgb"):
        for row, v in zip(rows, values):
            assert math.isclose(float(row[f"{kind}_{channel}_W_m2"]), v[c], rel_tol=1e-8)
        spread = facts["by_kind"][kind]["irradiance_W_m2"] if points else facts["irradiance_W_m2"]
        assert spread["max"][c] == max(v[c] for v in values) and spread["min"][c] == min(v[c] for v in values)
        assert math.isclose(spread["mean"][c], math.fsum(v[c] for v in values) / len(values), rel_tol=1e-12)

head, body = open("points.ply", "rb").read().split(b"end_header\n", 1)
assert f"element vertex {len(records)}\n".encode() in head
layout = "<" + "".join({b"double": "d", b"float": "f", b"uchar": "B", b"ushort": "H"}[line.split()[1]]
                       for line in head.splitlines() if line.startswith(b"property"))
vertices = list(struct.iter_unpack(layout, body))
at = {line.split()[2].decode(): i for i, line in enumerate(l for l in head.splitlines() if l.startswith(b"property"))}
for v, r in zip(vertices, records):
    assert v[:3] == tuple(r.position) and v[at["radius"]] == r.radius and v[at["object"]] == r.object
assert max(v[at[c]] for v in vertices for c in ("red", "green", "blue")) == 255   # the brightest is white
END
done

# .radsamples: valid or not, the page's digest, and by how many samples of which age a file is made.
accept=$formats/radsamples/accept refuse=$formats/radsamples/refuse example=$formats/radsamples/accept/worked-example.radsamples
tempolux-info --check "$accept"/* >out.txt || bad 'radsamples: a good file is not valid'
tempolux-info --check "$refuse"/* >out.txt 2>errors.txt
[ $? = 1 ] && [ ! -s out.txt ] && [ "$(wc -l <errors.txt)" = "$(ls "$refuse" | wc -l)" ] || bad "radsamples: bad files: $(cat out.txt)"
page=$(sed -n 's/.*digest is \([0-9a-f]\{32\}\).*/\1/p' "$HERE/../../formats/radsamples/radsamples.md")
[ "$(tempolux-info --digest "$example" | cut -d' ' -f1)" = "$page" ] || bad "radsamples: digest is not the page's, '$page'"
tempolux-info --json "$example" | "${PYTHON:-python3}" -c '
import json, sys
f = json.load(sys.stdin)
assert (f["records"], f["samples"], f["points"]) == (1, 3, 2) and f["age"]["samples_by_age"] == [0, 1, 1, 1] and f["age"]["mean"] == 2
assert f["share_of_samples"] == {"valid": 1, "dynamic": 1 / 3, "miss": 1 / 3, "near": 1 / 3, "anchored": 1 / 3}' || bad 'radsamples: facts'
tempolux-info --diff "$example" "$accept/two-records.radsamples" >/dev/null
[ $? = 1 ] || bad 'radsamples: files that differ: exit 1'

tempolux-info --export rows.csv out.json 2>errors.txt
[ $? = 2 ] && [ "$(wc -l <errors.txt)" = 1 ] || bad 'no points in JSON: exit 2, one line'
exit $failed
