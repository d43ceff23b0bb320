#!/bin/sh
# full_disk.sh KIB COMMAND... -- runs COMMAND (outputs named without a folder) where only KIB kibibytes can be
# written: a tmpfs if one may be mounted, else under a limit of file sizes. It must exit 3 with one line that
# gives the reason, and leave no file that is not whole. COMMAND needs more space than that.
size=$1; shift
scratch=$(mktemp -d) || exit 1
mkdir "$scratch/disk" "$scratch/whole"
(cd "$scratch/whole" && "$@" >/dev/null 2>&1) || { echo "the undisturbed run fails: $*"; exit 1; }
probe_mount='mount -t tmpfs -o size='$size'k tempolux-test "$0/disk" && cd "$0/disk"'
run='"$@" >/dev/null 2>"$0/errors"; echo $? >"$0/code"
  find . -type f | while read -r file; do cmp -s "$file" "$0/whole/$file" || echo "$file"; done >"$0/left"'
if unshare -rm sh -c "$probe_mount"' && { '"$run;}" "$scratch" "$@" 2>/dev/null; then
  how='tmpfs'
else
  how='ulimit -f'
  (cd "$scratch/disk" && ulimit -f $((size * 2)) && sh -c "$run" "$scratch" "$@")
fi
code=$(cat "$scratch/code")
failed=0
[ "$code" = 3 ] || { echo "exit $code, not 3"; failed=1; }
[ "$(wc -l <"$scratch/errors")" = 1 ] && grep -Eq 'No space left on device|File too large' "$scratch/errors" ||
  { echo "message: $(cat "$scratch/errors")"; failed=1; }
[ -s "$scratch/left" ] && { echo "left behind: $(cat "$scratch/left")"; failed=1; }
[ $failed = 0 ] && echo "$(basename "$1"): full disk ($how): exit 3, nothing wrong left: $(cat "$scratch/errors")" ||
  echo "$*: full disk ($how)"
rm -rf "$scratch"
exit $failed
