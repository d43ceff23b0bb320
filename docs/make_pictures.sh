#!/bin/sh
# Make the pictures of README.md and docs/chain.md again, into docs/images: sh docs/make_pictures.sh [BIN]
# Run at the top of the tree; BIN is the folder with the tools. Takes about four CPU minutes; all from scenes of the tree.
bin=${1:-build/release/bin} out=docs/images scene=pipelines/scenes/S2_cornell_moving.glb
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
set -e
mkdir -p $out
info="$bin/tempolux-info" draw='python3 -B docs/draw.py'

# The demo's frames, every sixth: as the README's command makes them.
make -s -f Makefile.example demo BIN="$(cd "$bin" && pwd)" OUT="$work/demo" FRAMES=0-47x6
"$info" --sheet $out/demo.png --columns 4 --tile 240 "$work"/demo/frames/00??.exr

# One frame through the chain, at 320x180.
"$bin/scene-plan" $scene --frames 0-47 -o "$work/plan" -q
$draw plan "$work/plan/plan.json" $out/scene-plan.png
"$bin/photon-trace" $scene --frame 12 --photons 200k --kinds indirect -o "$work/p.photons"
"$bin/photon-trace" $scene --frame 12 --photons 30k --kinds indirect -o "$work/few.photons"
"$bin/irradcache-build" $scene --frame 12 --photons "$work/p.photons" --size 320x180 --keep-points "$work/p.irradpoints" -o "$work/c.irradcache"
"$bin/frame-render" $scene --frame 12 --size 320x180 --irradcache "$work/c.irradcache" --points "$work/p.irradpoints" --channels RGBA,id \
  -o "$work/f.exr" --stats "$work/f.json"
"$info" --png $out/frame-render.png "$work/f.exr"
"$info" --json "$work/f.exr" > "$work/frame.json"
"$info" --export "$work/photons.csv" "$work/few.photons"
"$info" --export "$work/points.csv" "$work/p.irradpoints"
"$info" --export "$work/records.csv" "$work/c.irradcache"
$draw points "$work/photons.csv" "$work/frame.json" $out/photon-trace.png 0.02
$draw points "$work/points.csv" "$work/frame.json" $out/irradcache-build-points.png 0.08
$draw dots "$work/records.csv" "$work/frame.json" $out/frame-render.png $out/irradcache-build-records.png

# Records that keep their samples, after two frames.
for f in 10 11 12; do
  "$bin/photon-trace" $scene --frame $f --photons 200k --kinds indirect -o "$work/k.photons"
  "$bin/irradcache-build" points $scene --frame $f --photons "$work/k.photons" -o "$work/k.$f.irradpoints"
done
"$bin/gather-temporal" final $scene --frames 10-12 --points "$work/k.##.irradpoints" --size 320x180 -o "$work/k.##.radsamples" --cache "$work/k.##.irradcache"
$draw kept "$work/k.12.radsamples" "$work/frame.json" $out/frame-render.png $out/gather-temporal.png

# The frame of one sample, and filtered with two frames before and after.
for f in 10 11 12 13 14; do
  "$bin/frame-render" $scene --frame $f --size 320x180 --spp 1 --pixel-error 0 --seed-mode frame --irradcache "$work/c.irradcache" --points "$work/p.irradpoints" \
    --allow-stale -q --channels RGBA,layers,Z,N,id,albedo,motion,coverage,samples -o "$work/one.$f.exr"
done
"$bin/st-filter" "$work"/one.1[0-4].exr -o "$work/filtered.exr"
"$info" --sheet $out/st-filter.png --columns 1 --tile 160 "$work/one.12.exr" "$work/filtered.exr"

# Light textures: photons counted, smoothed; beside gathering.
"$bin/st-filter" mesh $scene --frame 12 --photons "$work/p.photons" --filter none --cell 0.1 -o "$work/counted.meshirrad"
"$bin/st-filter" mesh $scene --frame 12 --photons "$work/p.photons" -o "$work/smoothed.meshirrad"
for textures in counted smoothed; do
  "$bin/frame-render" $scene --frame 12 --size 320x180 --meshirrad "$work/$textures.meshirrad" -o "$work/$textures.exr"
done
"$info" --sheet $out/light-textures.png --columns 1 --tile 160 "$work/counted.exr" "$work/smoothed.exr"
"$info" --sheet $out/light-textures-beside.png --columns 3 --tile 240 "$work/counted.exr" "$work/smoothed.exr" "$work/f.exr"

# Photons over time: of this frame alone, and of the frames of its segment.
"$bin/photon-trace" $scene --frames 0-23 --photons 25k --seed-mode frame --kinds indirect -o "$work/few.##.photons"
"$bin/gather-temporal" density $scene --frame 12 --photons "$work/few.##.photons" -o "$work/alone.12.meshirrad"
"$bin/gather-temporal" density $scene --frames 0-23 --photons "$work/few.##.photons" -o "$work/windows.##.meshirrad"
for textures in alone windows; do
  "$bin/frame-render" $scene --frame 12 --size 320x180 --meshirrad "$work/$textures.12.meshirrad" -o "$work/$textures.exr"
done
"$info" --sheet $out/density.png --columns 1 --tile 160 "$work/alone.exr" "$work/windows.exr"

# A walk: every fourth frame, keys marked; one frame as it was warped, and what of it is traced.
tools=$(realpath "$bin") top=$PWD
make -f Makefile.example --no-print-directory demo BIN="$tools" METHOD=walkthrough SCENE=pipelines/scenes/S4_atrium.glb SIZE=320x180 OUT="$work/walk"
every_fourth=$(for f in $(seq 0 4 44); do printf '%s/walk/frames/%04d.exr ' "$work" "$f"; done)
marks=$(awk '!/split$/ { print $1; print $2 } /split$/ { print $4 }' "$work/walk/walk.log" | sort -u | while read -r key; do
  case " $every_fourth " in *"/$key.exr "*) echo "$work/walk/frames/$key.exr";; esac; done | paste -sd,)
# shellcheck disable=SC2086
exposure=$(cat "$work"/walk/shown/exposure-*)
"$info" --sheet $out/walkthrough.png --columns 4 --tile 160 --mark "$marks" --exposure "$exposure" $every_fourth
keys=$(cd "$work/walk" && sed -n 's/^walk\/0000+0016-[^ ]*: words := \([^ ]* [^ ]*\) .*/\1/p' plan.mk)
# shellcheck disable=SC2086
(cd "$work/walk" && "$tools/ibr-warp" $keys --scene "$top/pipelines/scenes/S4_atrium.glb" --frame 8 -o "$work/warped.exr" --mask "$work/why.exr")
"$info" --png "$work/warped.png" --exposure "$exposure" "$work/warped.exr"
"$info" --png "$work/why.png" "$work/why.exr"
"$info" --sheet $out/ibr-warp.png --columns 1 --tile 160 --exposure 0 "$work/warped.png" "$work/why.png"

# Where light is bright: a room lit by indirect light alone.
room=pipelines/scenes/S3_indirect_room.glb
"$bin/photon-trace" $room --frame 1 --photons 200k --kinds indirect,caustic -o "$work/p.photons"
"$bin/irradcache-build" $room --frame 1 --photons "$work/p.photons" --size 320x180 --keep-points "$work/p.irradpoints" -o "$work/c.irradcache"
"$bin/frame-render" $room --frame 1 --size 320x180 --irradcache "$work/c.irradcache" --points "$work/p.irradpoints" --channels RGBA,id \
  -o "$work/room.exr"
"$info" --png "$work/room.png" "$work/room.exr"
"$info" --json "$work/room.exr" > "$work/room.json"
"$bin/photonmap-split" "$work/p.irradpoints" --energy 2 --low "$work/low.irradpoints" --high "$work/high.irradpoints"
"$info" --export "$work/high.csv" "$work/high.irradpoints"
$draw dots "$work/high.csv" "$work/room.json" "$work/room.png" $out/photonmap-split.png

# Its error, and error against time of path tracing.
"$bin/frame-render" $scene --frame 12 --size 320x180 --integrator path --spp 512 --halves -o "$work/r.exr"
compare() { "$bin/aqm-compare" "$@" --reference-halves "$work/r_a.exr" "$work/r_b.exr" -q; }
compare "$work/f.exr" --difference "$work/wrong.png"
"$info" --sheet $out/aqm-compare.png --columns 1 --tile 160 --exposure 0 "$work/wrong.png"
runs=
for spp in 1 2 4 8 16; do
  "$bin/frame-render" $scene --frame 12 --size 320x180 --integrator path --spp $spp --seed 1 -o "$work/t.exr" --stats "$work/path$spp.json"
  compare "$work/t.exr" --json "$work/path$spp.error"
  runs="$runs --run scene=S2,curve=path,x=$spp $work/path$spp.json $work/path$spp.error"
done
"$bin/error-report" $runs -o "$work/report"
"$info" --sheet $out/error-report.png --columns 1 --tile 320 --exposure 0 "$(ls "$work"/report/*.png | head -n 1)"
"$info" --sheet $out/tempolux-info.png --columns 3 --tile 106 "$work"/00??.exr
ls -l $out
