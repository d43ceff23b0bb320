# st-filter: what it refuses, by one line that names the file and the remedy; frames of others; a range and its frames alone.
. "$HERE/expect.sh"
scene=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
render() { frame-render "$scene" -q --size 48x27 --spp 1 --integrator path --seed-mode frame --channels RGBA,layers,Z,N,id,albedo,motion,coverage,samples "$@"; }
render --frames 8-12 -o f.##.exr || bad 'frame-render failed'
st-filter f.08.exr f.09.exr f.10.exr f.11.exr f.12.exr -o one.exr -q || bad 'five files'
st-filter f.##.exr --frames 8-12 -o g.##.exr -q || bad 'a range'
tempolux-info --diff one.exr g.10.exr >/dev/null || bad 'a frame of a range differs from the frame alone'
st-filter f.08.exr f.09.exr f.10.exr --position 1 -o first.exr -q && tempolux-info --diff first.exr g.08.exr >/dev/null || bad 'the first frame of a range'
for threads in 1 2 3 7; do
  st-filter f.##.exr --frames 8-12 -o t.##.exr -q --threads $threads
  cmp g.10.exr t.10.exr || bad "$threads threads: other bytes"
done
st-filter f.##.exr --frames 8-12 --channels RGBA,Z -o c.##.exr -q || bad 'channels'
[ "$(tempolux-info --json c.10.exr | grep -o '"channel": *"[^"]*"' | cut -d'"' -f4 | tr '\n' ' ')" = 'A B G R Z ' ] || bad 'other channels than were asked for'
st-filter f.08.exr f.09.exr f.10.exr f.11.exr f.12.exr --channels RGBA,Z -o c.exr -q && tempolux-info --diff c.exr c.10.exr >/dev/null || bad 'channels of one file'
expect 2 "no channels 'P'; there are A, B" st-filter f.10.exr --channels P -o made.exr
frame-render "$scene" -q --size 24x14 --spp 1 --integrator path -o small.exr
frame-render "$scene" -q --size 48x27 --spp 1 --integrator path --channels RGBA -o plain.exr
expect 2 'flow of 24x14 pixels, the frame has 48x27' st-filter f.10.exr --flow small.exr -o made.exr
expect 2 'small.exr: frames of .* one size' st-filter f.10.exr small.exr f.11.exr -q -o made.exr
expect 2 'plain.exr: no flow' st-filter f.10.exr --flow plain.exr -o made.exr
expect 2 'name one for each' st-filter f.10.exr f.11.exr --flow f.10.exr -o made.exr
expect 2 'there are 1 frames' st-filter f.10.exr --position 2 -o made.exr
expect 2 'need a pattern' st-filter f.##.exr --frames 8-12 -o made.exr
expect 2 'by one pattern each' st-filter f.10.exr f.11.exr --frames 8-12 -o m.##.exr
# Another program's frames: no noise, no motion, no surfaces; one warning for each, once.
st-filter plain.exr plain.exr plain.exr -o p.exr 2>err.txt || bad 'a plain frame is refused'
[ "$(grep -c 'noise cannot be distinguished from texture' err.txt)" = 1 ] && [ "$(grep -c 'as if nothing moved' err.txt)" = 1 ] || bad "$(cat err.txt)"
[ "$(wc -l <err.txt)" -le 4 ] || bad "more warnings than reasons: $(cat err.txt)"
# Halves: the same bytes for any number of threads, single still or window; noise without its layer is refused.
frame-render "$scene" -q --frames 9-11 --size 48x27 --spp 2 --integrator path --seed-mode frame --channels RGBA,layers,Z,N,id,albedo,motion,coverage,halves,seen -o h.##.exr
st-filter h.10.exr -q --threads 1 -o h1.exr && st-filter h.10.exr -q --threads 3 -o h3.exr && cmp h1.exr h3.exr || bad 'a still with halves'
st-filter h.##.exr --frames 9-11 -q -o w.##.exr && st-filter h.09.exr h.10.exr h.11.exr -q -o w.exr && tempolux-info --diff w.exr w.10.exr >/dev/null || bad 'a window with halves'
frame-render "$scene" -q --size 48x27 --spp 2 --integrator path --channels RGBA,halves -o alone.exr
expect 2 'alone.exr: noise of layer .* write it with --channels layers,halves' st-filter alone.exr -o made.exr
exit $failed
