#!/bin/sh
# A short chain under ThreadSanitizer, all stages with four threads, on a room with mirrors and glass and among leaves:
# no report.
#
#     sh tests/pipelines/tsan.sh build/tsan/bin
#
# The tools of that build use loops of std::thread (lib/core/parallel_threads.cpp). Embree and OpenEXR are Debian's and
# not built for the sanitizer, and they start threads through TBB. Reports from inside these libraries are suppressed
# (called_from_lib), and so are reports about strings, because Embree calls the copies in our programs.
bin=$(cd "$1" && pwd) && here=$(cd "$(dirname "$0")" && pwd) && scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
printf 'called_from_lib:%s\n' libembree3.so libtbb.so libOpenEXR libIlmThread > suppressions
echo 'race:^std::__cxx11::basic_string' >> suppressions
export TSAN_OPTIONS="suppressions=$scratch/suppressions ignore_noninstrumented_modules=1 halt_on_error=0 exitcode=66 log_path=$scratch/report"
"${PYTHON:-python3}" -B "$here/../support/open_scenes.py" . leaves &&
"${PYTHON:-python3}" -B "$here/edit_gltf.py" "$here/../../pipelines/scenes/S2_cornell_moving.glb" room.glb mirror || exit 1
. "$here/../support/chain.sh"
of_photons='--photons 20k --kinds caustic,indirect' of_points='--point-count 2k' of_records='--rays 30 --size 48x27'
of_pixels='--photons f.photons --size 48x27 --spp 2 --channels RGBA,layers,id'
failed=0
run() { "$@" -q --threads 4 || { echo "$1: exit $?"; failed=1; }; }
for scene in room.glb leaves.glb; do
  run "$bin/scene-plan" $scene --frames 0-2 -o plan
  light f $scene --threads 4 && frame f $scene --threads 4 || { echo "chain: exit $?"; failed=1; }
  run "$bin/frame-render" $scene --integrator path --halves --size 48x27 --spp 2 --channels RGBA -o r.exr
  run "$bin/aqm-compare" f.exr --reference-halves r_a.exr r_b.exr --json e.json
done
for report in report.*; do
  [ -f "$report" ] || continue
  failed=1
  grep -A12 'WARNING: ThreadSanitizer' "$report" | head -40
done
[ $failed = 0 ] && echo "tsan: no report"
exit $failed
