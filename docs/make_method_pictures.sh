#!/bin/sh
# Make the pictures of docs/methods/split.md, dynamic.md, caustics.md and outliers.md again, into docs/images: sh docs/make_method_pictures.sh [BIN]
# Run at the top of the tree; BIN is the folder with the tools. Takes about a CPU minute.
bin=${1:-build/release/bin} out=docs/images
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
set -e
info="$bin/tempolux-info" draw='python3 -B docs/draw.py'

# A bright spot: where the photons of the high part are, and few rays a record without and with explicit samples.
python3 -B tests/support/spot_room.py "$work/spot.glb"
"$bin/photon-trace" "$work/spot.glb" --photons 200k -o "$work/p.photons" -q
"$bin/photon-trace" "$work/spot.glb" --photons 20k --kinds direct,indirect -o "$work/few.photons" -q
"$bin/photonmap-split" "$work/few.photons" --cell 0.3 --low "$work/l.photons" --high "$work/h.photons" -q
"$info" --export "$work/high.csv" "$work/h.photons"
"$bin/irradcache-build" points "$work/spot.glb" --photons "$work/p.photons" -o "$work/p.irradpoints" -q
"$bin/photonmap-split" "$work/p.irradpoints" --low "$work/l.irradpoints" --high "$work/h.irradpoints" -q
frame() { "$bin/frame-render" "$work/spot.glb" --size 320x180 --points "$work/p.irradpoints" -q "$@"; }
frame --camera Behind --spp 16 --channels RGBA,id -o "$work/behind.exr"
"$info" --png "$work/behind.png" "$work/behind.exr"
"$info" --json "$work/behind.exr" > "$work/behind.json"
$draw dots "$work/high.csv" "$work/behind.json" "$work/behind.png" "$work/dots.png"
"$bin/irradcache-build" records "$work/spot.glb" --size 320x180 --rays 50 --points "$work/p.irradpoints" -o "$work/rays.irradcache" -q
"$bin/irradcache-build" records "$work/spot.glb" --size 320x180 --rays 50 --points "$work/l.irradpoints" --high "$work/h.irradpoints" -o "$work/split.irradcache" -q
for kind in rays split; do
  frame --irradcache "$work/$kind.irradcache" -o "$work/$kind.exr"
  "$info" --png "$work/$kind.png" "$work/$kind.exr" --exposure 2
done
"$info" --sheet $out/split.png --columns 3 --tile 240 "$work/dots.png" "$work/rays.png" "$work/split.png"

# Localised gathering: what follows from the standing scene (L_t), what is gathered for the frame (L_y), influence I, and the blend.
python3 -B tests/support/moving_room.py "$work/room.glb" > /dev/null
f="--frame 20" size="--size 320x180"
"$bin/photon-trace" "$work/room.glb" $f --map static --photons 1M --kinds indirect -o "$work/s.photons" --paths "$work/s.paths" -q
"$bin/photon-trace" "$work/room.glb" $f --map dynamic --static "$work/s.paths" -o "$work/d.photons" -q
"$bin/irradcache-build" points "$work/room.glb" $f --map static --photons "$work/s.photons" -o "$work/s.irradpoints" -q
"$bin/irradcache-build" points "$work/room.glb" $f --update "$work/s.irradpoints" --photons "$work/s.photons" --dynamic "$work/d.photons" -o "$work/u.irradpoints" -q
"$bin/irradcache-build" records "$work/room.glb" $f $size --map static --points "$work/s.irradpoints" -o "$work/s.irradcache" -q
"$bin/irradcache-build" records "$work/room.glb" $f $size --update "$work/s.irradcache" --points "$work/u.irradpoints" --dynamic "$work/d.photons" -o "$work/u.irradcache" -q
"$bin/irradcache-build" records "$work/room.glb" $f $size --points "$work/u.irradpoints" -o "$work/y.irradcache" -q
room() { "$bin/frame-render" "$work/room.glb" $f $size --points "$work/u.irradpoints" -q "$@"; }
room --irradcache "$work/u.irradcache" --influence 1e6 --channels indirect -o "$work/t.exr"
room --irradcache "$work/y.irradcache" --channels indirect -o "$work/y.exr"
room --irradcache "$work/u.irradcache" --channels RGBA,indirect,influence -o "$work/u.exr"
for layer in t y u; do "$info" --png "$work/$layer.png" --layer indirect --exposure 1 "$work/$layer.exr"; done
for layer in influence blend; do "$info" --png "$work/$layer.png" --layer $layer "$work/u.exr"; done
"$info" --png "$work/whole.png" "$work/u.exr"
"$info" --sheet $out/localised.png --columns 3 --tile 240 "$work/t.png" "$work/y.png" "$work/u.png" "$work/influence.png" "$work/blend.png" "$work/whole.png"
ls -l $out/split.png $out/localised.png

# Light through glass by paths, and by a map of caustic photons: a scene that stays outside of the tree.
glass=../shared/scenes/found/gltf/playcanvas/AttenuationTest.glb sky=../shared/scenes/found/hdri/spiaggia_di_mondello_1k.hdr
if [ -f $glass ]; then
  "$bin/photon-trace" $glass --environment $sky --frame 10 --kinds caustic -o "$work/c.photons" -q
  for map in '' "--photons $work/c.photons"; do
    "$bin/frame-render" $glass --environment $sky --frame 10 --camera auto --size 320x180 --spp 4 --pixel-error 0.016 $map -o "$work/glass${map:+map}.exr" -q
    "$info" --png "$work/glass${map:+map}.png" "$work/glass${map:+map}.exr"
  done
  "$info" --sheet $out/caustics-paths.png --columns 2 --tile 320 "$work/glass.png" "$work/glassmap.png"
else
  echo "skipped: caustics-paths.png, $glass is not there"
fi

# Light that one sample alone claims, left and spread.
window=../shared/scenes/made/S8_window_room.glb
if [ -f $window ]; then
  for keep in '' ' --keep-outliers'; do
    make -s -f Makefile.example BIN="$(realpath "$bin")" OUT="$work/window" SCENE=$window FRAMES=17 SIZE=320x180 CAMERA=auto \
      LIGHT_UNITS=spec SKY=1.1,1.5,2 PIXELS="--spp 4 --pixel-error 0.016$keep" "$work/window/frames/0017.exr"
    "$info" --png "$work/window${keep:+kept}.png" "$work/window/frames/0017.exr"
  done
  "$info" --sheet $out/outliers.png --columns 2 --tile 480 "$work/windowkept.png" "$work/window.png"
else
  echo "skipped: outliers.png, $window is not there"
fi
