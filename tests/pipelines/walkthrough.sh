#!/bin/sh
# METHOD=walkthrough on a room in which the camera pans: sh tests/pipelines/walkthrough.sh BIN [MOMENTS]
# Run at the top of the tree; BIN is the folder with the tools. Keys equal the rendered frames to the bit. A second run
# makes nothing. A deleted frame is made again with the same bytes. Other numbers of threads and other orders give the
# same frames, and so does a run that is killed with -9 at MOMENTS moments (2).
bin=$1 moments=${2:-2} failed=0
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
bad() { echo "FAILED: $*"; failed=1; }
python3 -B pipelines/scenes/make_walkthrough.py pan pipelines/scenes/S3_indirect_room.glb "$work/pan.glb" || exit 1
makes() {   # makes VARIABLE=VALUE...: make takes the place of this shell; `before` holds words before make
  exec $before make V=1 -f Makefile.example --no-print-directory demo BIN="$bin" SCENE="$work/pan.glb" FRAMES=0-6 \
    INDIRECT=records SIZE=48x27 PHOTONS=5k POINTS='--point-count 1k' CACHE='--rays 20 --error-bound 1' \
    PIXELS='--spp 2 --pixel-error 0' KEY_DISTANCE=4 "$@" > "$work/log" 2>&1
}
run() { (before='' makes "$@"); }
digests() { "$bin/tempolux-info" --digest "$1"/frames/*.exr | sed "s|$1/||"; }
digest() { "$bin/tempolux-info" --digest "$1" | cut -d' ' -f1; }

run METHOD=walkthrough OUT="$work/a" || { cat "$work/log"; exit 1; }
digests "$work/a" > "$work/expected"
[ "$(wc -l < "$work/expected")" = 7 ] || bad "7 frames, not $(wc -l < "$work/expected")"
grep -vE '^[0-9]{4} [0-9]{4}  middle [0-9]{4}  seen [^ ]+  traced .*  (warp|split)$' "$work/a/walk.log" && bad 'log'
marked=$(cd "$work/a" && sh "$OLDPWD/pipelines/walkthrough.sh" marks)
for key in 0000 0004; do
  case ",${marked#--mark }," in *",frames/$key.exr,"*) ;; *) bad "key $key is not marked in the sheet: $marked";; esac
done
# shellcheck disable=SC2086
(cd "$work/a" && "$bin/tempolux-info" --sheet marked.png --columns 8 --tile 160 \
  --exposure "$(cat shown/exposure-*)" $marked frames/*.exr &&
  cmp marked.png sheet.png && rm marked.png) || bad 'the sheet marks no keys'
run METHOD=walkthrough OUT="$work/a"
grep -q 'Nothing to be done' "$work/log" || bad "a second run: $(head -3 "$work/log")"

# A key equals the rendered frame to the bit, except for the layer that only keys have.
run METHOD=frames OUT="$work/f" CHANNELS=RGBA,Z,N,id,specular || { cat "$work/log"; exit 1; }
for key in 0000 0004; do
  [ "$(digest "$work/a/frames/$key.exr")" = "$(digest "$work/f/frames/$key.exr")" ] ||
    bad "key $key is not the frame rendered"
done

# With a filter: a key equals the frame filtered alone, and warped frames exist.
run METHOD=walkthrough FILTER=1 OUT="$work/s" || { cat "$work/log"; exit 1; }
run METHOD=frames FILTER=1 FRAMES=0,4 OUT="$work/sf" CHANNELS=RGBA,Z,N,id,layers ||
  { cat "$work/log"; exit 1; }
for key in 0000 0004; do
  [ "$(digest "$work/s/frames/$key.exr")" = "$(digest "$work/sf/frames/$key.exr")" ] ||
    bad "filtered key $key is not the frame filtered"
done
[ "$(find "$work/s/frames" -name '*.exr' | wc -l)" = 7 ] || bad 'filtered walkthrough: not 7 frames'
find "$work/s" -name '*.part*' | grep . && bad 'filtered walkthrough: left-overs'

# A frame made alone equals that of the range. Without mirrors no pixel is masked as specular.
run METHOD=walkthrough OUT="$work/one" FRAMES=3 || { cat "$work/log"; exit 1; }
digests "$work/one" | diff - "$work/expected" | grep '^<' && bad 'frame 3 alone is another one'
grep -h '"traced_specular"' "$work"/a/walked/*.warp.json | grep -qv ': 0,*$' &&
  bad 'nothing mirrors: pixels are masked for it'

warped=$(ls "$work"/a/walked/*.warp.json | head -n 1 | sed 's|.*/\([0-9]*\)-.*|\1|')
[ -n "$warped" ] || bad 'no frame was warped'
rm "$work/a/frames/$warped.exr" "$work/a/walked/$warped-"*; run METHOD=walkthrough OUT="$work/a"
digests "$work/a" | diff "$work/expected" - || bad "$warped, deleted, came back as another"

RUN= run METHOD=walkthrough OUT="$work/b" -j1 RUN='taskset -c 0' || { cat "$work/log"; exit 1; }
digests "$work/b" | diff "$work/expected" - || bad 'one processor, one job: other frames'

for threads in 1 2 3 7; do
  "$bin/ibr-warp" "$work/a/keys/0000-"*.exr "$work/a/keys/0004-"*.exr --scene "$work/pan.glb" --frames 1,2 \
    --threads $threads -q -o "$work/w.##.exr" --mask "$work/m.##.exr" --flow "$work/v.##.exr" ||
    bad "ibr-warp: $threads threads"
  cat "$work"/[wmv].0[12].exr > "$work/all.$threads"
  cmp "$work/all.1" "$work/all.$threads" || bad "ibr-warp: other bytes by $threads threads"
done

# Kills make with all its processes, each time after a longer while.
for moment in $(seq 1 "$moments"); do
  before=setsid makes METHOD=walkthrough OUT="$work/k" &
  group=$!
  sleep "$(awk "BEGIN { print 0.3 + 3 * ($moment - 1) / $moments }")"
  kill -9 -- -$group 2> /dev/null
  wait $group 2> /dev/null
done
run METHOD=walkthrough OUT="$work/k" || { cat "$work/log"; exit 1; }
digests "$work/k" | diff "$work/expected" - || bad 'killed on its way: other frames'
[ $failed = 0 ] && echo ok
exit $failed
