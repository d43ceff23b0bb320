# Killed at any moment, or where nothing can be written, no tool leaves a wrong file under its final name. ROUNDS kills of
# each command, 3 without; `make stress` takes 50.
. "$HERE/each_tool.sh"
failed=0 rounds=${ROUNDS:-3}
command -v tool-probe > /dev/null && { kill_nine.sh 40 tool-probe s.glb -o a.out --second b.out --pause 1000 --bytes 4MiB || failed=1; }
killed() { shift; kill_nine.sh "$rounds" "$@" || failed=1; }
each_tool killed

# A disk of one page (of 1 KiB where none can be mounted), which no tool's output fits; larger ones, full in the middle of a file.
filled() { shift; full_disk.sh 1 "$@" || failed=1; }
each_tool filled
full_disk.sh 1024 photon-trace "$mirror" --photons 100k -o a.photons || failed=1
full_disk.sh 256 tempolux-info "$in/p.photons" --export a.csv || failed=1

# A folder that cannot be written; root may write anywhere but in /sys.
mkdir closed && chmod a-w closed
folder=$PWD/closed
[ "$(id -u)" = 0 ] && folder=/sys
refused() {
  name=$1; shift
  (cd "$folder" && exec "$@") > closed.txt 2>&1
  code=$?
  [ $code = 3 ] && [ "$(grep -c . closed.txt)" = 1 ] && grep -q "^$1: .*: cannot create" closed.txt ||
    { echo "$name into a closed folder: exit $code, $(cat closed.txt)"; failed=1; }
}
each_tool refused
exit $failed
