#!/bin/sh
# The scenes of pipelines/scenes render, and those written by a script equal the script's output: sh
# tests/pipelines/scenes.sh BIN
# Run at the top of the tree; BIN is the folder with the tools.
bin=$1 failed=0
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
for scene in pipelines/scenes/*.gl*; do
  if "$bin/scene-plan" "$scene" --frames 0 -o "$work/plan" -q 2> "$work/stderr" && [ ! -s "$work/stderr" ]; then echo "ok: $scene"
  else echo "FAILED: $scene: $(cat "$work/stderr")"; failed=1; fi
done
python3 pipelines/scenes/make_cornell_classic.py | cmp - pipelines/scenes/cornell_classic.gltf || failed=1
python3 -B pipelines/scenes/make_evening.py | cmp - pipelines/scenes/evening.glb || failed=1

# The lamp sends pi * radiance * area = pi * (17, 12, 4) * 0.130 * 0.105 W: 0.72901, 0.51460, 0.17153.
"$bin/photon-trace" pipelines/scenes/cornell_classic.gltf --photons 10k -o "$work/p.photons" &&
  "$bin/tempolux-info" "$work/p.photons" | grep -q '^emitted_flux_W  *0\.72900.* 0\.5145.* 0\.1715' || { echo 'FAILED: flux of the lamp'; failed=1; }
exit $failed
