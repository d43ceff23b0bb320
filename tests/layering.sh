#!/bin/sh
# The arrows of lib/README.md, checked with grep. Run at the top of the tree.
bad=0
forbid() {  # folder, pattern of an #include it must not have, reason
  if grep -rnE --include='*.h' --include='*.cpp' "^ *#include [<\"]($2)" "$1" 2>/dev/null; then echo "^ $1: $3"; bad=1; fi
}
third='CLI/|OpenEXR/|Imf|Imath|OpenImageIO/|openvdb/|embree|tiny_gltf|nlohmann/|tbb/|png.h|jpeglib.h|draco/|meshoptimizer|webp/|avif/|seccomp|fftw3'
forbid formats "lib/|tools/|$third" 'formats needs the standard library and xxhash only'
forbid lib 'tools/|CLI/|iostream' 'lib has no command line and prints nothing'
forbid modules 'tools/|CLI/' 'a module knows no tool'
# inside lib: folder, what it may include of lib
may() {
  others=$(grep -rhoE --include='*.h' --include='*.cpp' '^ *#include "lib/[a-z_]+/' "lib/$1" 2>/dev/null | sed 's|.*"lib/||; s|/$||' | sort -u)
  for other in $others; do
    case " $1 $2 " in *" $other "*) ;; *) echo "lib/$1 includes lib/$other: not one of its arrows ($2)"; bad=1;; esac
  done
}
may core     ''
may image    'core'
may volume   'core'
may scene    'core image volume'
may trace    'core image scene'
may material 'core image scene'
may light    'core volume image scene'
may transport 'core volume scene trace material light'
may photon   'core volume scene trace material light'
may density  'core'
may irradcache 'core density'
may points   'core volume scene trace material light transport density irradcache'
may light_texture 'core scene trace irradcache'
may gather   'core volume scene trace material light transport density irradcache points'
may temporal 'core scene trace light irradcache points light_texture gather'
may render   'core volume image scene trace material light transport photon density irradcache points light_texture gather'
may audit    'core volume scene trace material light transport photon density points render'
may pilot    'core image scene trace material light transport photon density irradcache points light_texture gather render audit'
may compose  'core volume image scene trace light transport points light_texture gather render'
may warp     'core image volume scene trace material render'
may aqm      'core image'
may filter   'core image'
may plan     'core scene trace material light render pilot'
may report   'core image aqm'
for folder in lib/*/; do
  case " lib/core/ lib/image/ lib/volume/ lib/scene/ lib/trace/ lib/material/ lib/light/ lib/transport/ lib/photon/ lib/density/ lib/irradcache/ lib/points/ lib/light_texture/ lib/gather/ lib/temporal/ lib/render/ lib/audit/ lib/pilot/ lib/compose/ lib/warp/ lib/aqm/ lib/filter/ lib/plan/ lib/report/ " in
    *" $folder "*) ;; *) echo "$folder: has no line in tests/layering.sh"; bad=1;; esac
done
# each third-party header in one file of the tree (tests and benchmarks apart)
for header in embree3/ OpenEXR/ OpenImageIO/ openvdb/ png.h jpeglib.h tiny_gltf nlohmann/json.hpp CLI/ draco/ meshoptimizer webp/ avif/ seccomp.h fftw3 xxhash; do
  files=$(grep -rlE --include='*.h' --include='*.cpp' "^ *#include [<\"]$header" formats lib tools modules 2>/dev/null)
  [ "$(echo "$files" | grep -c .)" -le 1 ] || { echo "$header is included by more than one file:" $files; bad=1; }
done
# headers that include a library are private to their folder
for header in lib/scene/gltf_model.h; do
  others=$(grep -rlF --include='*.h' --include='*.cpp' "\"$header\"" lib tools modules | grep -v "^${header%/*}/")
  [ -z "$others" ] || { echo "$header is private to ${header%/*}, but included by:" $others; bad=1; }
done
# JSON's types enter headers by json_file.h, but for the header of the glTF gate
others=$(grep -rlF --include='*.h' '"lib/core/json.h"' lib tools modules | grep -v '^lib/scene/gltf_json.h$')
[ -z "$others" ] || { echo "lib/core/json.h is for .cpp files and lib/scene/gltf_json.h, but included by:" $others; bad=1; }
others=$(grep -rlF --include='*.h' --include='*.cpp' '"lib/scene/gltf_json.h"' lib tools modules | grep -v '^lib/scene/gltf_')
[ -z "$others" ] || { echo "lib/scene/gltf_json.h is private to lib/scene/gltf_*, but included by:" $others; bad=1; }
# lib/README.md says in which order folders and their headers are read
read_first=$(sed -n '/^## What to read first/,/^## How/s/^| \([a-z\\_]*\) | \(.*\) |$/\1 \2/p' lib/README.md | tr -d '\\')
for folder in lib/*/; do
  headers=$(echo "$read_first" | sed -n "s|^$(basename $folder) ||p" | grep -oE '[a-z0-9_]+\.h')
  [ -n "$headers" ] || { echo "$folder: lib/README.md does not say what to read first"; bad=1; }
  for header in $headers; do [ -e "$folder$header" ] || { echo "$folder$header is named in lib/README.md and missing"; bad=1; }; done
done
tbb=$(grep -rlE '^ *#include [<"]tbb/' lib tools formats 2>/dev/null | grep -v '^lib/core/'); [ -z "$tbb" ] || { echo "tbb outside lib/core: $tbb"; bad=1; }
if grep -rnE '\b(exit|abort|getenv)\(' lib formats --include='*.cpp' --include='*.h' | grep -v 'check.h'; then echo '^ lib and formats call no exit and read no environment'; bad=1; fi
# a main declares options and calls tools/stages
for tool in tools/*.cpp; do
  [ "$(wc -l < "$tool")" -le 150 ] || { echo "$tool: more than 150 lines; move work to tools/stages"; bad=1; }
done
# lengths come from footprints, from what is seen near by and from the photons' spacing, never from the size of the scene
if grep -rnE 'diagonal\(|frame\(?\)?\.bounds' lib/density lib/points lib/light_texture lib/gather lib/irradcache lib/photon lib/render lib/audit lib/pilot --include='*.cpp' --include='*.h' |
  grep -v 'reachable_area.cpp.*const Box3& bounds'; then echo '^ a length of the scene'; bad=1; fi   # there: rounding of coordinates
exit $bad
