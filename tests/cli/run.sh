#!/bin/sh
# run.sh BUILD NAME -- runs NAME_check.sh of this folder in an empty scratch folder, the built tools first in
# PATH. It must exit 0 (77: skipped); if there is a NAME_check.expected, its output, both streams, must equal
# that byte for byte.
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
name=${2%_check}
export HERE="$here" BUILD="$build" PATH="$build/bin:$build/tests:$here:$PATH"
unset TEMPOLUX_THREADS
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch" "$scratch.out"' EXIT
(cd "$scratch" && sh "$here/${name}_check.sh") >"$scratch.out" 2>&1
code=$?
if [ -f "$here/${name}_check.expected" ]; then
  diff "$here/${name}_check.expected" "$scratch.out" || code=1
else
  cat "$scratch.out"
fi
exit $code
