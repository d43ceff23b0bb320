# Light textures: a furnace by them, what is refused, the same bytes for any number of threads.
. "$HERE/expect.sh"
furnace=$HERE/../data/units/U5_furnace_closed.gltf
python=${PYTHON:-python3}

# In a closed room of one radiance all around the light that photons bring as indirect makes up for what is not emitted: no noise but the photons'.
# 256 photons count in an element: 1/16 of noise, averaged over some twenty independent places of the picture 1.4 %, of half of the light.
photon-trace "$furnace" --photons 50k --kinds indirect -q -o p.photons || bad photons
for filter in gaussian box; do
  st-filter mesh "$furnace" --photons p.photons --filter $filter -q -o $filter.meshirrad || bad "mesh $filter"
  frame-render "$furnace" --size 32x32 --meshirrad $filter.meshirrad --spp 4 -q -o $filter.exr || bad "frame $filter"
  tempolux-info --json $filter.exr > info.json
  "$python" - <<'END' || bad "$filter: not the furnace's radiance"
import json
channels = {c["channel"]: c["mean"] for c in json.load(open("info.json"))["channels"]}
for name, want in zip("RGB", (2, 5, 1.25)):
    assert abs(channels[name] / want - 1) < .03, (name, channels[name], want)
END
done
tempolux-info --json gaussian.meshirrad > info.json
"$python" - <<'END' || bad 'flux'
import json
f = json.load(open("info.json"))
assert f["type"] == "meshirrad" and f["elements"] > 1000 and f["photons"] > 50000
for a, b in zip(f["counted_flux_W"], f["filtered_flux_W"]):
    assert abs(a / b - 1) < .01, (a, b)
END
tempolux-info --diff gaussian.meshirrad gaussian.meshirrad || bad 'a file differs from itself'
tempolux-info --diff gaussian.meshirrad box.meshirrad > /dev/null && bad 'two filters give one light'
tempolux-info --check gaussian.meshirrad > /dev/null || bad check
head -c 1000 gaussian.meshirrad > cut.meshirrad
expect 1 'cut.meshirrad: byte' tempolux-info --check cut.meshirrad
expect 2 'cut.meshirrad: byte' frame-render "$furnace" --meshirrad cut.meshirrad -o x.exr
expect 2 'has no photons of kind direct' st-filter mesh "$furnace" --photons p.photons --kinds direct,indirect -o x.meshirrad
photon-trace "$furnace" --photons 20k --kinds direct,indirect -q -o d.photons
st-filter mesh "$furnace" --photons d.photons --kinds direct,indirect -q -o d.meshirrad || bad 'two kinds'
expect 2 'd.meshirrad: .*--kinds indirect' frame-render "$furnace" --meshirrad d.meshirrad -o x.exr
expect 2 'leave out one' frame-render "$furnace" --meshirrad gaussian.meshirrad --irradcache c.irradcache -o x.exr
expect 2 'static_geometry\|differ' frame-render "$HERE/../data/units/U2_directional.gltf" --meshirrad gaussian.meshirrad -o x.exr
for threads in 1 2 3 7; do
  st-filter mesh "$furnace" --photons p.photons --filter gaussian --threads $threads -q -o t$threads.meshirrad
  cmp t1.meshirrad t$threads.meshirrad || bad "$threads threads"
done
exit $failed
