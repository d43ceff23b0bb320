#!/bin/sh
# Error of five frames of one or two samples, filtered, beside 1 and 16 samples: sh docs/methods/st-filter.sh SCENES BIN [FRAME]
# SCENES: the folder with S2_cornell_moving.glb and S4_atrium.glb. About four CPU minutes; nothing is kept.
scenes=$1 bin=$2 f=${3:-10}
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
set -e
cpu() { python3 -c "import json,sys; print('%.2f' % sum(json.load(open(n))['cpu_s'] for n in sys.argv[1:]))" "$@"; }
for scene in "$scenes"/S2_cornell_moving.glb "$scenes"/S4_atrium.glb; do
  name=$(basename "$scene" .glb)
  render() { # frame samples output options
    at=$1 spp=$2 out=$3; shift 3
    "$bin/frame-render" "$scene" --frame $at --size 320x180 --spp $spp --seed-mode frame --photons "$work/$at.photons" \
      --irradcache "$work/$at.irradcache" --points "$work/$at.irradpoints" -q -o "$out" "$@"
  }
  for i in $((f-2)) $((f-1)) $f $((f+1)) $((f+2)); do
    "$bin/photon-trace" "$scene" --frame $i --photons 200k --kinds caustic,indirect -o "$work/$i.photons" -q
    "$bin/irradcache-build" "$scene" --frame $i --photons "$work/$i.photons" --size 320x180 --keep-points "$work/$i.irradpoints" -o "$work/$i.irradcache" -q
    for x in one: more:--for-filter two:--for-filter; do
      name_of=${x%%:*} error=0; [ -z "${x#*:}" ] || error=.016
      spp=1; [ "$name_of" != two ] || spp=2
      # shellcheck disable=SC2086
      render $i $spp "$work/$name_of.$i.exr" --channels RGBA,layers,Z,N,id,albedo,motion,coverage,samples --compression none --stats "$work/$name_of.$i.json" \
        --pixel-error $error ${x#*:}
    done
  done
  render $f 16 "$work/many.exr" --pixel-error 0 --channels RGBA,layers,Z,N,id --stats "$work/many.json"
  render $f 512 "$work/ref.exr" --pixel-error 0 --halves --channels RGBA,layers,id --seed 77
  for x in one more two; do
    "$bin/st-filter" "$work/$x.$((f-2)).exr" "$work/$x.$((f-1)).exr" "$work/$x.$f.exr" "$work/$x.$((f+1)).exr" "$work/$x.$((f+2)).exr" \
      -o "$work/$x.filtered.exr" --stats "$work/$x.filter.json" -q
  done
  for layer in direct emission specular RGB; do
    for x in one.$f one.filtered more.filtered two.filtered many; do
      "$bin/aqm-compare" "$work/$x.exr" --reference-halves "$work/ref_a.exr" "$work/ref_b.exr" --layer $layer --json "$work/$x.error" -q
    done
    python3 -c "import json,sys; print(*sys.argv[1:3], *('%s %.4f' % (n, json.load(open(f'{sys.argv[3]}/{x}.error'))['total']['rmse']) for n, x in (('one', f'one.{sys.argv[4]}'), ('filtered', 'one.filtered'), ('more for specular', 'more.filtered'), ('two', 'two.filtered'), ('sixteen', 'many'))))" $name $layer "$work" $f
  done
  echo "$name CPU s: one $(cpu "$work/one.$f.json"), more $(cpu "$work/more.$f.json"), two $(cpu "$work/two.$f.json"), filter $(cpu "$work/two.filter.json"), sixteen $(cpu "$work/many.json")"
done
