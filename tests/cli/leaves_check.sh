# Among 3600 leaves, where points stand for little more than themselves and most light is followed on: the same bytes for
# any number of threads, and when it is done again.
"${PYTHON:-python3}" -B "$HERE/../bench/walls.py" --write leaves leaves.gltf && mkdir one || exit 1
failed=0
for threads in 1 1 2 2 3 3 4 4 7 7; do
  mkdir made
  photon-trace leaves.gltf -q --threads $threads --photons 50k --kinds caustic,indirect -o made/p.photons &&
  irradcache-build points leaves.gltf -q --threads $threads --photons made/p.photons --point-count 10k -o made/p.irradpoints &&
  irradcache-build records leaves.gltf -q --threads $threads --points made/p.irradpoints --rays 30 --size 48x27 \
    -o made/c.irradcache &&
  frame-render leaves.gltf -q --threads $threads --irradcache made/c.irradcache --points made/p.irradpoints --size 48x27 \
    --spp 1 --channels RGBA,layers -o made/f.exr || exit 1
  [ -f one/f.exr ] || cp made/* one
  diff -r one made || { echo "other bytes with $threads threads"; failed=1; }
  rm -r made
done
exit $failed
