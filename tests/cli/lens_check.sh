# Options of lens and shutter at their limits: one line and exit 2, or a picture without NaN (the reader checks). A scene
# without lens and shutter is the same bytes as with options that turn them off.
. "$HERE/expect.sh"
scene=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
render="$BUILD/bin/frame-render $scene --frame 10 --size 16x9 --integrator path --spp 4 -q -o made.exr"
whole() {   # whole OPTION...: renders, and the picture is valid
  expect 0 '' $render "$@"
  "$BUILD/bin/tempolux-info" --check made.exr > /dev/null || bad "no valid picture: $*"
}
expect 2 'no distance is sharp: give --focus' $render --f-stop 2
for focus in 0 -1 nan; do expect 2 '--focus' $render --f-stop 2 --focus=$focus; done
expect 2 "neither a distance in metres nor the name of a node" $render --f-stop 2 --focus Nobody
for number in nan -1 x; do
  expect 2 '--f-stop' $render --f-stop=$number --focus 2
  expect 2 '--lens-radius' $render --lens-radius=$number --focus 2
  expect 2 '--shutter' $render --shutter=$number
done
expect 2 'f-stop is below 0.001' $render --f-stop 1e-9 --focus 2
expect 2 'excludes' $render --f-stop 2 --lens-radius .1
expect 2 '--shutter-open' $render --shutter 180 --shutter-open middle
whole --f-stop 1 --focus inf
whole --f-stop .001 --focus 1e-6
whole --lens-radius 1000 --focus 1e9
whole --lens-radius 1e-30 --focus 2
whole --f-stop 1 --focus MovingBox
whole --shutter 3600
whole --shutter 36000 --shutter-open begin
whole --shutter 1e-9
whole --shutter 180 --f-stop .1 --focus MovingBox
digest() { "$BUILD/bin/tempolux-info" --digest made.exr | cut -d' ' -f1; }
whole; sharp=$(digest)
whole --f-stop 0 --shutter 0; [ "$(digest)" = "$sharp" ] || bad 'options that turn lens and shutter off change the picture'
whole --shutter 180 --threads 1; one=$(digest)
whole --shutter 180 --threads 3; [ "$(digest)" = "$one" ] || bad 'a blurred picture depends on the number of threads'
[ "$one" != "$sharp" ] || bad 'a shutter changes nothing'
# Means of what a pixel shows come with coverage: in blurred frames, and in sharp ones that are to be filtered (halves).
has_means() { "$BUILD/bin/tempolux-info" made.exr | grep -q 'coverage.mean'; }
whole --channels RGBA,coverage --shutter 0; ! has_means || bad 'a sharp frame without halves has means'
whole --channels RGBA,coverage,layers,halves --shutter 0; has_means || bad 'no means in a frame for the filter'
whole --channels RGBA,coverage --f-stop 1 --focus 2; has_means || bad 'no means with a lens'
whole --channels RGBA,coverage --shutter 180; has_means || bad 'no means with a shutter'
# Stored light belongs to the middle of the shutter. Where the shutter opens at the frame's time, this is another time.
photons() { "$BUILD/bin/photon-trace" "$scene" --frame 10 --photons 1k -q -o light.photons "$@" || bad 'no photons'; }
cached="$BUILD/bin/frame-render $scene --frame 10 --size 16x9 --spp 4 --integrator photons --photons light.photons -q -o made.exr"
photons
expect 0 '' $cached --shutter 180
expect 2 'made for another state of the scene' $cached --shutter 180 --shutter-open begin
photons --shutter 180 --shutter-open begin
expect 0 '' $cached --shutter 180 --shutter-open begin
# Blur made from a sharp frame.
whole --channels RGBA,Z,id,motion
mv made.exr sharp.exr
whole
mv made.exr still.exr
blur="$BUILD/bin/st-filter blur sharp.exr -q -o blurred.exr"
expect 2 'neither blurs anything' $blur
expect 2 'no distance is sharp' $blur --f-stop 2
expect 2 'must be a distance' $blur --f-stop 2 --focus 0
expect 2 'excludes' $blur --f-stop 2 --lens-radius 1 --focus 2
for look in '--shutter 3600' '--lens-radius 1000 --focus 1e9' '--f-stop .001 --focus inf' '--shutter 180 --f-stop 1 --focus 2'; do
  expect 0 '' $blur $look --threads 1
  "$BUILD/bin/tempolux-info" --check blurred.exr > /dev/null || bad "no valid picture: blur $look"
  one=$("$BUILD/bin/tempolux-info" --digest blurred.exr | cut -d' ' -f1)
  expect 0 '' $blur $look --threads 3
  [ "$("$BUILD/bin/tempolux-info" --digest blurred.exr | cut -d' ' -f1)" = "$one" ] || bad "depends on threads: blur $look"
done
expect 2 'no flow' "$BUILD/bin/st-filter" blur still.exr --shutter 180 -q -o blurred.exr
exit $failed
