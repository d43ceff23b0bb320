# Among 3600 leaves most gather rays find no point that represents their hits, and continue: the same bytes for any
# number of threads, and in a second run.
"${PYTHON:-python3}" -B "$HERE/../support/open_scenes.py" . leaves && mkdir one || exit 1
. "$HERE/../support/chain.sh"
of_photons='--photons 50k --kinds caustic,indirect' of_points='--point-count 10k' of_records='--rays 30 --size 48x27'
of_pixels='--size 48x27 --spp 1 --channels RGBA,layers'
failed=0
for threads in 1 1 2 2 3 3 4 4 7 7; do
  mkdir made
  light made/f leaves.glb --threads $threads && frame made/f leaves.glb --threads $threads || exit 1
  [ -f one/f.exr ] || cp made/* one
  diff -r one made || { echo "other bytes with $threads threads"; failed=1; }
  rm -r made
done
exit $failed
