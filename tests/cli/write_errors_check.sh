# Each call with which a tool writes a file fails in turn, by EIO and by ENOSPC: the tool exits with 3 and one line, and
# the files of before stay as they were, or new ones are whole. PLACES calls of each command, 4 without (the first,
# the last and between); `make stress` takes 1000, which is all.
. "$HERE/each_tool.sh"
preload=$BUILD/tests/libfail-write.so
[ -e "$preload" ] || { echo "$preload is not built"; exit 77; }
failed=0 places=${PLACES:-4}
failing() { LD_PRELOAD=$preload ASAN_OPTIONS=verify_asan_link_order=0 exec "$@" > /dev/null; }
# The file FILE as a run left it before: that of an undisturbed run, with another end.
before() { cat "whole/$1"; echo before; }
with_errors() {
  name=$1; shift
  rm -rf whole run calls errors
  mkdir whole
  (cd whole && export FAIL_COUNT="$PWD/../calls" && failing "$@" 2> /dev/null) ||
    { echo "$name: the undisturbed run fails"; failed=1; return; }
  calls=$(tail -1 calls)
  [ "$calls" -gt 0 ] || { echo "$name: no call that writes was counted"; failed=1; return; }
  tried=0
  for at in $("${PYTHON:-python3}" -c "
n, most = $calls, $places
print(*sorted({1 + round(i * (n - 1) / max(1, most - 1)) for i in range(min(n, most))}))"); do
    for error in 5 28; do
      rm -rf run && mkdir run && (cd whole && find . -type f) | while read -r file; do
        mkdir -p "run/${file%/*}" && before "$file" > "run/$file"; done
      (cd run && export FAIL_AT="$at" FAIL_ERRNO="$error" && failing "$@" 2> ../errors)
      code=$?
      # state/files of a plan is a list that each plan adds to.
      wrong=$(cd run && find . -type f ! -path ./plan/state/files | while read -r file; do
        (cd .. && before "$file" 2> /dev/null | cmp -s - "run/$file") || cmp -s "../whole/$file" "$file" || echo "$file"
      done)
      gone=$(cd whole && find . -type f | while read -r file; do [ -e "../run/$file" ] || echo "$file"; done)
      [ $code = 3 ] && [ "$(grep -c . errors)" = 1 ] && [ -z "$wrong$gone" ] ||
        { echo "$name: call $at of $calls, errno $error: exit $code, left: $wrong, gone: $gone, $(cat errors)"
          failed=1; }
      tried=$((tried + 1))
    done
  done
  echo "$name: $tried errors in $calls calls"
}
each_tool with_errors
exit $failed
