# Options that say how a scene is read reach it: each changes the picture as it should.
failed=0
bad() { echo "$*"; failed=1; }
"${PYTHON:-python3}" -B "$HERE/make_floor.py" || bad 'make_floor.py'
render() {  # NAME SCENE OPTIONS...: a picture of 16x9 at 1 s
  name=$1 scene=$2; shift 2
  frame-render "scene/$scene.gltf" --frame 24 --integrator path --size 16x9 --spp 4 -o "$name.exr" -q "$@" 2> "$name.txt" ||
    bad "$scene $*: $(cat "$name.txt")"
}
same() { tempolux-info --diff "$1.exr" "$2.exr" > /dev/null; }
# green NAME KEY: min, max or mean of the green channel
green() { tempolux-info "$1.exr" | sed -n "s/^ *channel G .* $2 \([^ ]*\).*/\1/p"; }
holds() { "${PYTHON:-python3}" -c "import sys; sys.exit(not ($1))" || bad "$2: $1"; }

# The lamp is 3 m above the floor, 2 m after a second of "Sink", 1 m after one of "Fall".
render plain plain
render sink sink
render two two
render by_name two --animation Sink
render fall two --animation Fall
same two sink || bad 'two animations of one property: not the first'
same by_name sink || bad '--animation Sink is not it'
holds "$(green fall max) > 2 * $(green sink max) > 4 * $(green plain max)" '--animation Fall'   # (2/1)^2, (3/2)^2
frame-render scene/two.gltf --animation Wall --size 16x9 -o no.exr 2> errors && bad 'an animation that does not exist'
grep -q 'none is named "Wall"; there is Sink, Fall' errors || bad "$(cat errors)"

# 683 cd are 1 W/sr; one rounding of each of some sums and products.
render spec plain --light-units spec
holds "abs($(green plain mean) / $(green spec mean) - 683) < 0.01" '--light-units spec'

render auto plain --camera auto
render above plain --camera Above
render aside plain --camera Aside
same auto plain && same above plain || bad '--camera: auto is the first'
holds "$(green aside max) == 0" '--camera Aside looks past the floor'

# A texture in another folder is refused.
frame-render scene/outside.gltf --size 16x9 -o no.exr 2> errors; [ $? = 2 ] && grep -q "leads out of the scene's folder" errors || bad "outside: $(cat errors)"

# One seed for all frames, or one for each.
for mode in fixed frame; do
  frame-render scene/plain.gltf --frames 0,1 --seed-mode $mode --integrator path --size 16x9 --spp 4 -o "$mode.####.exr" -q || bad $mode
done
same fixed.0000 fixed.0001 || bad '--seed-mode fixed: frames of a still scene differ'
same frame.0000 frame.0001 && bad '--seed-mode frame: frames have the same noise'
exit $failed
