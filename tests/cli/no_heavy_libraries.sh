#!/bin/sh
# no_heavy_libraries.sh BIN_DIR -- no tool may link OpenImageIO, OpenVDB or FFTW, itself or through another library: the
# first two cost 0.4 s and 130 MB at every start. They live in modules, opened at need. Nor may a tool link what reads images, unless it
# reads or writes frames: most scenes have no image, and starting OpenEXR and its like takes as many instructions as
# planning a small scene.
[ -d "$1" ] || { echo "no folder of tools: $1"; exit 1; }
bad=0 count=0
for tool in "$1"/*; do
  [ -f "$tool" ] && [ -x "$tool" ] || continue
  count=$((count + 1))
  libraries=$(ldd "$tool") || { echo "$tool: ldd failed"; bad=1; continue; }
  if echo "$libraries" | grep -iE 'openimageio|openvdb|opencv|ffmpeg|libav|fftw'; then echo "^ $tool links these"; bad=1; fi
  case $(basename "$tool") in
    frame-render | ibr-warp | st-filter | volume-compose) images='png|jpeg';;   # write frames
    aqm-compare | tempolux-info) images='jpeg';;
    *) images='png|jpeg|openexr|imath';;
  esac
  if echo "$libraries" | grep -iE "lib($images)"; then echo "^ $tool links these: they belong into tempolux-images.so"; bad=1; fi
  if echo "$libraries" | grep -iE 'lib(draco|meshoptimizer|webp|avif)'; then echo "^ $tool links these: they belong into tempolux-decode"; bad=1; fi
  if echo "$libraries" | grep 'not found'; then echo "^ $tool cannot be started"; bad=1; fi
done
echo "$count tools looked at"
[ "$count" -gt 0 ] || bad=1
exit $bad
