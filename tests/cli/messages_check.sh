# Exit codes and messages: one line, the tool, the place, the remedy.
try() { tool-probe "$@"; echo "exit $?"; }
try scene.glb -o a.out; cat a.out | head -c 60 | head -1
try
try scene.glb
try scene.glb -o a.out --bogus
try scene.glb -o a.out --frames 5-x
try scene.glb -o a.out --bytes 1e6
try scene.glb -o a.out --seed -1
try scene.glb -o a.out --seed-mode sometimes
try scene.glb -o a.out --threads 5000
try scene.glb -o a.out --fps 0
TEMPOLUX_THREADS=many tool-probe scene.glb -o a.out; echo "exit $?"
for work in input-error caller-error resource-error system-error other-error; do
  try scene.glb -o b.out --work $work
done
try scene.glb -o no/such/folder/b.out
try scene.glb -o /dev/full
try scene.glb -o .
try scene.glb -o ''
try scene.glb -o b.out --second ./b.out
try scene.glb -o - --stats - | tail -1
try scene.glb -o - --depfile d.mk --bytes 0 | tail -1
tool-probe --help 3>&1 >/dev/full; echo "exit $?"
tool-probe scene.glb -o - 3>&1 >/dev/full; echo "exit $?"
tool-probe scene.glb -o - 3>&1 >&-; echo "exit $?"
tool-probe scene.glb -o b.out --second b2.out --work input-error -q; echo "exit $?"
tool-probe '/abs/s b/scene.glb' -o f.##.out --frames 3-4 --bytes 0 --threads 1 --depfile d.mk -v 2>&1 | sed 's/[0-9.]* s/T s/; s/([0-9.]* CPU/(T CPU/'
cat d.mk f.03.out f.04.out
ls -A
# Only names of files may be patterns: a scene, a camera or a map of light has its own name at every frame.
tool-probe '100% #1.glb' --camera 'view #2' --environment '50%.hdr' --volume 'smoke.##.vdb' --frame 7 -o g.out --bytes 0; echo "exit $?"
head -1 g.out
