#!/bin/sh
# The gathering chain does no work that a scene does not need: sh tests/pipelines/leaving_out.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. The test reads the files, their statistics, the inputs
# that each tool reports, and the mapped libraries. rerun.sh tests which commands make leaves out.
bin=$1 scene=pipelines/scenes/S2_cornell_moving.glb
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
failed=0
bad() { echo "FAILED: $*"; failed=1; }
tool() { t=$1; shift; LD_DEBUG=files LD_DEBUG_OUTPUT="$work/libraries" "$bin/$t" "$@" -q || { echo "FAILED: $t $*: exit $?"; exit 1; }; }
edit() { python3 -B tests/pipelines/edit_gltf.py "$@" || exit 1; }
planned() { python3 -B tests/pipelines/planned.py "$@"; }
kinds() { "$bin/tempolux-info" --json "$1" | tr -d ' \n' | sed 's/.*"by_kind":{//' | grep -o '"[a-z]*":{' | tr -d '":{' | tr '\n' ' '; }
# count NAME FILE: a count of the file's statistics
count() { sed -n "s/.*\"$1\": *\([0-9.]*\).*/\1/p" "$2" | head -1; }

edit $scene "$work/still.glb" still
edit "$work/still.glb" "$work/walk.glb" camera-from 2
small='--point-count 2k --rays 50'

# Only the camera moves: photons and points of frames 0 and 2 are equal, bit for bit.
tool scene-plan "$work/walk.glb" --frames 0-3 -o "$work/plan"
[ "$(grep -c '^photons/0000-.*words' "$work/plan/plan.mk")" = 1 ] && [ "$(grep -c '^photons/.*words' "$work/plan/plan.mk")" = 1 ] || bad 'only the camera moves: photons of more than frame 0'
[ "$(planned "$work/plan" photon_kinds)" = indirect ] || bad 'no mirror, no glass: photons of other kinds than indirect'
# In a closed room with lamps neither photons nor points are aimed; with a sky they are.
ls "$work"/plan/state/*.view 2> /dev/null && bad 'a closed room: a file of where cameras look'
grep -q '[.]view' "$work/plan/plan.mk" && bad 'a closed room: photons are aimed'
tool photon-trace "$work/walk.glb" --frame 0 --photons 20k --kinds indirect -o "$work/0.photons"
tool photon-trace "$work/walk.glb" --frame 2 --photons 20k --kinds indirect -o "$work/2.photons"
"$bin/tempolux-info" --diff "$work/0.photons" "$work/2.photons" > /dev/null || bad 'only the camera moves: other photons'
tool irradcache-build points "$work/walk.glb" --photons "$work/0.photons" --point-count 2k -o "$work/0.irradpoints"

tool irradcache-build records "$work/walk.glb" --points "$work/0.irradpoints" --rays 50 --size 160x90 -o "$work/0.irradcache" \
  --stats "$work/0.json" --depfile "$work/0.d"
grep -q '\.photons' "$work/0.d" && bad 'records from points: photons were read'

# Pixels: records were placed for pixel centres, and a record is valid only within its radius. In corners and at edges a
# sample away from the centre may find no valid record. It then follows a path, which may end at a point. Here seven of
# 14 400 samples do; at most one in a thousand may. Without mirror or glass no photons are read.
tool frame-render "$work/walk.glb" --irradcache "$work/0.irradcache" --points "$work/0.irradpoints" --spp 1 --pixel-error 0 \
  --size 160x90 --channels RGBA,layers -o "$work/0.exr" --stats "$work/frame.json"
[ "$(count gathered_in_pixels "$work/frame.json")" -le 14 ] || bad 'records are missing in the picture they were placed for'
[ "$(count points_read "$work/frame.json")" -le "$(count gathered_in_pixels "$work/frame.json")" ] || bad 'a sample with a record read a point'
"$bin/tempolux-info" --json "$work/0.exr" | tr -d ' \n' | grep -q '"caustic.G"[^}]*"max":0[.0]*[,}]' ||
  bad 'no mirror, no glass: a caustic layer that is not 0'

# A single object under a sky is lit by paths alone: no photons, points or records are planned or made.
python3 -B - "$work/lone.gltf" <<'END' || bad 'a lone object: no scene'
import sys
sys.path.insert(0, "tests/stress")
from scenes import Scene, sphere_mesh
scene = Scene()
positions, triangles, normals = sphere_mesh((0, 0, 0), (1, 1, 1), 8, inwards=False)
scene.mesh(positions, triangles, scene.material(0.7), normals)
scene.camera((0, 1, 4), (0, 0, 0), fov=0.7)
scene.save(sys.argv[1])
END
"${MAKE:-make}" -s -f Makefile.example SCENE="$work/lone.gltf" FRAMES=0 SIZE=32x18 OUT="$work/lone" BIN="$bin" QUALITY=draft TIME='--environment 1,1,1' \
  demo > /dev/null 2> "$work/lone.log" || { cat "$work/lone.log"; bad 'a lone object: not rendered'; }
[ "$(planned "$work/lone" indirect)" = paths ] || bad 'a lone object: not paths'
[ -s "$work/lone/frames/0000.exr" ] || bad 'a lone object: no frame'
find "$work/lone" -name '*.photons' -o -name '*.irradpoints' -o -name '*.irradcache' | grep . && bad 'a lone object: made for nothing'

# With a mirror there are caustic photons; without one there are none, even if they are asked for.
tool photon-trace "$work/walk.glb" --photons 5k --kinds caustic,indirect -o "$work/matte.photons" --stats "$work/matte.json"
[ "$(count specular_rays "$work/matte.json")" = 0 ] || bad 'no mirror, no glass: specular rays'
[ "$(kinds "$work/matte.photons")" = 'indirect ' ] || bad "no mirror, no glass: photons of kinds $(kinds "$work/matte.photons")"
edit "$work/still.glb" "$work/mirror.glb" mirror
tool scene-plan "$work/mirror.glb" --frames 0 -o "$work/mirror"
[ "$(planned "$work/mirror" photon_kinds)" = caustic,indirect ] || bad 'a mirror: no caustic photons planned'
tool photon-trace "$work/mirror.glb" --photons 5k --kinds caustic,indirect -o "$work/mirror.photons" --stats "$work/mirror.json"
[ "$(count specular_rays "$work/mirror.json")" -gt 0 ] || bad 'a mirror: no specular ray is counted'
[ "$(kinds "$work/mirror.photons")" = 'caustic indirect ' ] || bad "a mirror: photons of kinds $(kinds "$work/mirror.photons")"

# A lamp is off in the middle of the frames: the pilot runs at a frame at which it is on.
edit $scene "$work/off.glb" event lamp-off
tool scene-plan "$work/off.glb" --frames 3-5 -o "$work/off"
[ "$(planned "$work/off" indirect)" = records ] || bad 'planned by a dark frame'

# If paths find indirect light, photons carry only the mirror's caustics, or there are none.
tool scene-plan "$work/mirror.glb" --frames 0 --indirect paths -o "$work/paths"
case $(planned "$work/paths" photon_kinds) in
  '' | caustic) ;;
  *) bad 'paths asked for: photons of indirect light planned all the same';;
esac

# A texture that no ray touches is not decoded, and the decoder is not opened. A texture that a ray touches is in the
# list.
top=$(pwd)
(cd "$work" && python3 -B "$top/tests/cli/make_floor.py") || bad 'make_floor.py'
for camera in Aside Above; do
  LD_DEBUG=files LD_DEBUG_OUTPUT="$work/textures-$camera" "$bin/frame-render" "$work/scene/inside.gltf" --camera $camera \
    --integrator path --size 16x9 --spp 1 -o "$work/$camera.exr" --stats "$work/$camera.json" -q || bad "textures: exit $?"
done
[ "$(count textures "$work/Aside.json") $(count textures "$work/Above.json")" = '0 1' ] || bad 'a texture that no ray touches was decoded'
grep -hoE 'file=[^ ]*(tempolux-images|libpng|libjpeg)[^ ]*' "$work"/textures-Aside.* | sort -u | grep . && bad 'these were mapped for no texture'
grep -qhE 'file=[^ ]*tempolux-images' "$work"/textures-Above.* || bad 'the list of libraries lacks the module of images'

# The loader's list of libraries, including those opened at run time.
ls "$work"/libraries.* > /dev/null 2>&1 || bad 'the loader lists no libraries'
grep -hoE 'file=[^ ]*(OpenImageIO|openvdb|opencv)[^ ]*' "$work"/libraries.* | sort -u | grep . && bad 'these were mapped'
grep -qhE 'file=[^ ]*embree' "$work"/libraries.* || bad 'the list of libraries lacks Embree: it says nothing'
[ $failed = 0 ] && echo ok
exit $failed
