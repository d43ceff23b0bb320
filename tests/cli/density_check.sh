# gather-temporal density: a furnace by photons of many frames; a range and single frames, any number of threads, photons and counts give
# the same bytes; what is refused; one photon, none, time cut at a lamp that is switched.
. "$HERE/expect.sh"
furnace=$HERE/../data/units/U5_furnace_closed.gltf
python=${PYTHON:-python3}
photon-trace "$furnace" --frames 0-8 --photons 10k --seed-mode frame --kinds indirect -q -o p.####.photons || bad photons
gather-temporal density "$furnace" --frames 0-8 --photons p.####.photons -q -o d.####.meshirrad --stats range.json || bad density
# In a closed room of one radiance all around the light that photons bring as indirect makes up for what is not emitted. 90000 paths in nine
# frames: of some 1e5 photons the mean has an error of .3 % of the half of the light that is indirect; each of a picture's 20 independent places 1/16 / sqrt 20.
frame-render "$furnace" --size 32x32 --frame 4 --meshirrad d.0004.meshirrad --spp 4 -q -o f.exr || bad frame
tempolux-info --json f.exr > info.json
"$python" - <<'END' || bad "not the furnace's radiance"
import json
channels = {c["channel"]: c["mean"] for c in json.load(open("info.json"))["channels"]}
for name, want in zip("RGB", (2, 5, 1.25)):
    assert abs(channels[name] / want - 1) < .02, (name, channels[name], want)
END
tempolux-info --json d.0004.meshirrad > info.json
"$python" - <<'END' || bad 'windows or flux'
import json
f = json.load(open("info.json"))
assert f["holds"] == "windows" and f["window_frames"]["max"] == 9 and f["window_frames"]["mean"] > 8.5, f["window_frames"]
END
# Counts of each frame, then each frame by itself, its neighbours named: what make does.
st-filter mesh "$furnace" --frames 0-8 --counts --photons p.####.photons --threads 3 -q -o c.####.meshirrad || bad counts
gather-temporal density "$furnace" --frames 0-8 --counts c.####.meshirrad -q -o r.####.meshirrad || bad 'counts of a range'
for threads in 1 2 7; do
  gather-temporal density "$furnace" --frame 4 --counts c.000?.meshirrad --threads $threads -q -o t.meshirrad
  cmp t.meshirrad r.0004.meshirrad || bad "alone with $threads threads: other bytes than as one of a range"
done
tempolux-info --diff d.0004.meshirrad r.0004.meshirrad > /dev/null || bad 'photons and their counts give other light'
# As a picture: frame 4 of 0 to 8 has windows of 9 frames, 9/33 of white, within half a code of 8 bits there; its light is another picture.
tempolux-info --png w.png --layer window d.0004.meshirrad && tempolux-info --json w.png > info.json || bad 'no picture of windows'
"$python" -c 'import json; c = json.load(open("info.json"))["channels"][0]; assert abs(c["max"] - 9 / 33) < 0.003, c' || bad 'windows in the picture'
tempolux-info --png l.png d.0004.meshirrad && ! cmp -s w.png l.png || bad 'no picture of light'
expect 2 'holds light of one frame' tempolux-info --png made.png --layer age c.0004.meshirrad
expect 2 'holds counts, not light' frame-render "$furnace" --frame 4 --meshirrad c.0004.meshirrad -o made.exr
expect 2 'holds no counts' gather-temporal density "$furnace" --frame 4 --counts d.0004.meshirrad -o made.meshirrad
expect 2 'has no counts' gather-temporal density "$furnace" --frame 4 --counts c.0005.meshirrad -o made.meshirrad
expect 2 'named twice' gather-temporal density "$furnace" --frame 4 --counts c.0004.meshirrad c.0004.meshirrad -o made.meshirrad
expect 2 'name the photons' gather-temporal density "$furnace" --frame 4 -o made.meshirrad
expect 2 'need a pattern' gather-temporal density "$furnace" --frames 0-8 --photons p.####.photons -o made.meshirrad
expect 2 'need a pattern' gather-temporal density "$furnace" --frames 0-8 --photons p.0000.photons -o made.####.meshirrad
st-filter mesh "$furnace" --frame 5 --counts --cell 0.3 --photons p.0005.photons -q -o other.meshirrad
expect 2 'differ in scene, cell or kinds' gather-temporal density "$furnace" --frame 4 --counts c.0004.meshirrad other.meshirrad -o made.meshirrad
expect 2 'static_geometry\|differ' gather-temporal density "$HERE/../data/units/U2_directional.gltf" --frame 4 --counts c.0004.meshirrad -o made.meshirrad
head -c 1000 c.0004.meshirrad > cut.meshirrad
expect 2 'cut.meshirrad: byte' gather-temporal density "$furnace" --frame 4 --counts cut.meshirrad -o made.meshirrad
# One photon, and none.
for paths in 1 2; do
  photon-trace "$furnace" --frames 0-2 --photons $paths --seed-mode frame --kinds indirect -q -o one.####.photons
  gather-temporal density "$furnace" --frames 0-2 --photons one.####.photons -q -o one.####.meshirrad || bad "$paths paths"
  frame-render "$furnace" --size 8x8 --frame 1 --meshirrad one.0001.meshirrad --spp 1 -q -o one.exr || bad "picture of $paths paths"
done
exit $failed
