# Cryptomatte: a reader that is written from the pages finds objects and materials by the manifest, whose coverage adds up
# to alpha; the same bytes for any number of threads; the filter and smoke carry mattes unchanged, blur and warping leave
# them out with one line.
. "$HERE/expect.sh"
scene=$HERE/../../pipelines/scenes/S2_cornell_moving.glb
export PYTHONDONTWRITEBYTECODE=1
render() { frame-render "$scene" -q --frame 10 --size 48x27 --integrator path --compression none "$@"; }
read_mattes() { python3 "$HERE/../formats/read_mattes.py" "$@"; }
mattes() { python3 "$HERE/../formats/read_mattes.py" "$1" > "$1.txt" && cat "$1.txt"; }
same_mattes() { mattes "$1" > a.txt && mattes "$2" > b.txt && cmp a.txt b.txt || bad "other mattes: $1 $2"; }

# Alpha is a mean of ones and zeros, joined in float32: 1e-6. In a closed room it is 1.
render --spp 8 --pixel-error .02 --shutter 180 --f-stop 1 --focus 2 --channels RGBA,Z,id,motion,cryptomatte -o f.exr || bad 'frame-render failed'
read_mattes f.exr --alpha 1e-6 > seen.txt || bad "$(cat seen.txt)"
grep -q 'CryptoObject .* MovingBox$' seen.txt && grep -q '^CryptoMaterial ' seen.txt || bad "names: $(cat seen.txt)"
tempolux-info f.exr > info.txt
grep -q "layer CryptoObject   ranks 6   names $(grep -c '^CryptoObject' seen.txt)" info.txt || bad "tempolux-info: $(grep -A3 mattes info.txt)"
grep -q 'manifest' info.txt && bad 'tempolux-info prints the manifest'
for threads in 1 2 3; do
  render --spp 8 --pixel-error .02 --shutter 180 --f-stop 1 --focus 2 --channels RGBA,Z,id,motion,cryptomatte -o t.exr --threads $threads
  cmp f.exr t.exr || bad "$threads threads: other bytes"
done
# Mattes do not change other channels, and --half does not touch them.
render --spp 8 --pixel-error .02 --shutter 180 --f-stop 1 --focus 2 --channels RGBA,Z,id,motion -o without.exr
tempolux-info --json --diff f.exr without.exr | grep -q '"channel": *"[RGBAZ]"' && bad 'mattes change the picture'
tempolux-info without.exr | grep -q 'matte' && bad 'mattes that nobody asked for'
render --spp 8 --pixel-error .02 --shutter 180 --f-stop 1 --focus 2 --channels RGBA,Z,id,motion,cryptomatte --half -o h.exr && same_mattes f.exr h.exr
# Halves: one layer of mattes, of the samples of both.
render --spp 8 --halves --channels RGBA,cryptomatte -o r.exr && read_mattes r.exr --alpha 1e-6 > seen.txt || bad "halves: $(cat seen.txt)"
same_mattes r.exr r_a.exr

# The filter carries them, also by the name of their group; without them their attributes are gone.
render --spp 4 --channels RGBA,layers,Z,N,id,albedo,coverage,halves,seen,cryptomatte -o raw.exr
st-filter raw.exr -q -o g.exr && same_mattes raw.exr g.exr
st-filter raw.exr -q --channels RGBA,cryptomatte -o g.exr && same_mattes raw.exr g.exr
st-filter raw.exr -q --channels RGBA -o g.exr && tempolux-info --json g.exr | grep -q 'cryptomatte/' && bad 'attributes without channels'
# Blur and warping leave them out; frame-render --mask --base counts them for all pixels.
expect 0 'cryptomatte is left out' st-filter blur f.exr --shutter 180 -o made.exr
tempolux-info --json made.exr | grep -q 'Crypto[OM]' && bad 'blur keeps mattes'
render --spp 4 --channels RGBA,specular,Z,N,id,cryptomatte -o key.exr
expect 0 'cryptomatte is left out' ibr-warp key.exr --scene "$scene" --frame 11 -o made.exr
tempolux-info --json made.exr | grep -q 'Crypto[OM]' && bad 'a warped frame keeps mattes'
expect 2 'cannot be warped' ibr-warp key.exr --scene "$scene" --frame 11 --channels Z,cryptomatte -q -o made.exr
expect 0 '' ibr-warp key.exr --scene "$scene" --frame 10 -q -o w.exr --mask why.exr
render --spp 4 --channels RGBA,cryptomatte --base w.exr --mask why.exr -o all.exr && read_mattes all.exr > seen.txt || bad 'a masked frame'
python3 -c 'import sys; rows = [line.split() for line in open("seen.txt")]
sys.exit(abs(sum(float(r[2]) for r in rows if r[0] == "CryptoObject") - 1) > 1e-3)' || bad "a masked frame: $(cat seen.txt)"
exit $failed
