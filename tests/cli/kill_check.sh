# Killed at any moment, or on a disk that runs full, no tool leaves a wrong file under its final name.
failed=0
scene=$HERE/../../pipelines/scenes/S1_cornell.glb
have() { [ -x "$BUILD/bin/$1" ]; }
kill_nine.sh 40 tool-probe s.glb -o a.out --second b.out --pause 1000 --bytes 4MiB || failed=1
if have photon-trace; then
  kill_nine.sh 20 photon-trace "$scene" --photons 100k -o a.photons || failed=1
  full_disk.sh 1024 photon-trace "$scene" --photons 100k -o a.photons || failed=1
  photon-trace "$scene" --photons 100k -o a.photons || failed=1
fi
if have frame-render; then
  kill_nine.sh 20 frame-render "$scene" --size 160x90 --spp 2 -o a.exr || failed=1
  full_disk.sh 64 frame-render "$scene" --size 160x90 --spp 2 -o a.exr || failed=1
  frame-render "$scene" --size 160x90 --spp 2 -o a.exr || failed=1
fi
if have tempolux-info && [ -e a.photons ] && [ -e a.exr ]; then
  kill_nine.sh 20 tempolux-info "$PWD/a.photons" --export ply -o a.ply || failed=1
  full_disk.sh 1024 tempolux-info "$PWD/a.photons" --export csv -o a.csv || failed=1
  full_disk.sh 16 tempolux-info "$PWD/a.exr" --png a.png || failed=1
fi
have scene-plan && { kill_nine.sh 20 scene-plan "$scene" --frames 0-5 -o plan || failed=1; }
exit $failed
