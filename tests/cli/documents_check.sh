# What the pages of formats/ say of our files is what the tools write and read: the example of stats.md and its names,
# streams told by their first bytes, all columns in a CSV, comparisons that error-report would refuse.
failed=0
bad() { echo "$*"; failed=1; }
formats=$HERE/../../formats scene=$HERE/../../pipelines/scenes/S1_cornell.glb
photon-trace "$scene" --photons 2k -o p.photons --stats photon-trace.json -q || bad photons
irradcache-build "$scene" --photons p.photons --point-count 100 --size 8x6 --rays 4 --keep-points p.irradpoints -o c.irradcache \
  --stats irradcache-build.json -q || bad cache
frame-render "$scene" --size 8x6 --spp 2 --irradcache c.irradcache --points p.irradpoints -o f.exr --stats frame-render.json -q || bad frame
gather-temporal final "$scene" --points p.irradpoints --size 8x6 --rays 4 -o s.radsamples --cache t.irradcache --stats gather-temporal.json -q || bad temporal
cp f.exr g.exr
aqm-compare f.exr g.exr --json comparison.json --stats aqm-compare.json -q >/dev/null || bad comparison
scene-plan "$scene" -o plan --stats scene-plan.json -q || bad plan
"${PYTHON:-python3}" -B - "$formats/stats/stats.md" <<'END' || failed=1
import json, re, sys
page = open(sys.argv[1]).read()
example = json.loads(page.split("## Example\n")[1].split("\n## ")[0])
made = json.load(open("photon-trace.json"))
assert list(example) == list(made), (list(example), list(made))
assert [list(p) for p in example["phases"]] == [list(p) for p in made["phases"]]
assert [(p["name"], p["parallel"]) for p in example["phases"]] == [(p["name"], p["parallel"]) for p in made["phases"]]
assert list(example["counts"]) == list(made["counts"]) and list(example["results"]) == list(made["results"])
for tool in ("scene-plan", "photon-trace", "irradcache-build", "gather-temporal", "frame-render", "aqm-compare"):
    row = next(line for line in page.splitlines() if line.startswith(f"| {tool} |"))
    named = set(re.findall("`([a-z_]+)", row))
    made = json.load(open(tool + ".json"))
    used = {name.split(".")[0] for name in (*made["counts"], *made["results"])}
    assert used <= named, f"stats.md: {tool}: {used - named} are not named"
END
for file in p.photons p.irradpoints c.irradcache; do
  for mode in '' --digest --check; do
    tempolux-info $mode $file | sed "s/$file/-/g" >named.txt
    tempolux-info $mode - <$file >from_file.txt && cmp -s named.txt from_file.txt || bad "tempolux-info $mode - <$file: $(head -2 from_file.txt)"
    cat $file | tempolux-info $mode - >piped.txt && cmp -s named.txt piped.txt || bad "cat $file | tempolux-info $mode -"
  done
done
# A map says by which emission table its paths were started: the one that scene-plan calls frozen. Readers do not mind another.
emission=$(tempolux-info --json p.photons | sed -n 's/.*"emission": *"\([^"]*\)".*/\1/p')
frozen=$(sed -n 's/.*"frozen": "\(.*\)".*/\1/p' plan/plan.json | head -1)
[ -n "$emission" ] && [ "$emission" = "$frozen" ] || bad "emission '$emission', frozen $frozen"
"${PYTHON:-python3}" -B - "$HERE/../formats" <<'END' || bad 'another emission table'
import sys
sys.path.insert(0, sys.argv[1])
from read_photons import read_photons, write_photons
photons = read_photons("p.photons")
photons.header["emission"] = "other"
write_photons("other.photons", photons)
del photons.header["emission"]
write_photons("older.photons", photons)
END
for map in other older; do
  irradcache-build points "$scene" --photons $map.photons --point-count 50 -o o.irradpoints 2>errors.txt || bad "$map: exit $?"
  [ -s errors.txt ] && bad "$map: $(cat errors.txt)"
done
header() { tempolux-info --export header.csv "$1"; head -1 header.csv; }
accept=$HERE/../formats
header "$accept/photons/accept/columns.photons" | grep 'bounce,wi_x,wi_y,wi_z,albedo_r,albedo_g,albedo_b' >/dev/null || bad 'csv without photons columns'
header p.photons | grep 'wi_x\|albedo' && bad 'csv with columns that the file has not'
header "$accept/irradcache/accept/columns-influence-update.irradcache" |
  grep 'rotational_r_x_W_m2.*translational_b_z_W_m3,influence_W_m2,update_r_W_m2' >/dev/null || bad 'csv without columns of the cache'
"${PYTHON:-python3}" -B - "$accept" <<'END' || failed=1
import csv, subprocess, sys
sys.path.insert(0, sys.argv[1])
from read_irradcache import read_irradcache
name = sys.argv[1] + "/irradcache/accept/columns-influence-update.irradcache"
subprocess.run(["tempolux-info", "--export", "all.csv", name], check=True)
rows, records = list(csv.DictReader(open("all.csv"))), read_irradcache(name).records
assert len(rows) == len(records) > 0
for row, record in zip(rows, records):
    assert None not in row and None not in row.values(), row
    for kind, unit in (("rotational", "W_m2"), ("translational", "W_m3")):
        flat = [v for channel in getattr(record, kind) for v in (channel if hasattr(channel, "__len__") else [channel])]
        got = [float(row[f"{kind}_{c}_{a}_{unit}"]) for c in "rgb" for a in "xyz"]
        assert all(abs(x - y) <= 1e-6 * abs(y) for x, y in zip(got, flat)), (kind, got, flat)
    assert abs(float(row["influence_W_m2"]) - record.influence) <= 1e-6 * record.influence
END
echo '{"schema":"tempolux.comparison","version":"1.0"}' >empty.json
tempolux-info --check empty.json >out.txt 2>&1 && bad 'a comparison without total is valid'
grep -q total out.txt || bad "$(cat out.txt)"
tempolux-info --check comparison.json photon-trace.json >/dev/null || bad 'our own JSON is not valid'
exit $failed
