#!/bin/sh
# Everything builds with -DTEMPOLUX_OIIO=OFF, into build/no-oiio, and files that need the child program are refused by
# its name. Run at the top of the tree. Not in ctest, because it builds.
bad() { echo "without OpenImageIO: $*" >&2; exit 1; }
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
{ cmake --preset no-oiio && cmake --build --preset no-oiio; } > "$work/log" 2>&1 || { tail -5 "$work/log" >&2; bad 'it does not build'; }
[ -e build/no-oiio/modules/tempolux-oiio ] && bad 'the helper was built'
bin=build/no-oiio/bin
$bin/tempolux-info --png "$work/a.png" tests/fuzz/corpus/pictures/baseline.jpg 2> "$work/said"
[ $? = 2 ] && grep -q 'tempolux-oiio' "$work/said" || bad "a JPEG picture: $(cat "$work/said")"
$bin/frame-render pipelines/scenes/S1_cornell.glb --size 16x9 --spp 1 -q -o "$work/a.exr" &&
  $bin/tempolux-info --png "$work/a.png" "$work/a.exr" && [ -s "$work/a.png" ] || bad 'EXR and PNG need no helper'
echo 'built without OpenImageIO'
