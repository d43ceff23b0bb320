#!/bin/sh
# Counts the files that write out the chain from light to pixels: sh tests/chains.sh [MOST]. Run at the top of the tree.
#
# Such a file names photon-trace, irradcache-build, frame-render and --irradcache, the option that hands records to
# pixels. Of a page only code counts: lines indented by four blanks. Not counted are generated pages (docs/tools), notes
# of past measurements (docs/notebook), and the programs themselves (lib, tools). Others run make, or call
# tests/support/chain.sh or chain() of tests/bench/pipeline.py. With MOST the exit code is 1 if there are more.
code() { case $1 in *.md) grep '^    ' "$1" ;; *) cat "$1" ;; esac; }
count=0
for file in $(find README.md Makefile.example docs formats pipelines tests -type f \
    \( -name '*.md' -o -name '*.sh' -o -name '*.py' -o -name '*.mk' -o -name 'Makefile*' \) | sort); do
  case $file in docs/tools/* | docs/notebook/* | tests/chains.sh) continue ;; esac
  for word in photon-trace irradcache-build frame-render --irradcache; do
    code "$file" | grep -q -e "$word" || continue 2
  done
  count=$((count + 1))
  echo "$file"
done
echo "$count files write out the chain${1:+; $1 are allowed}"
[ "$count" -le "${1:-$count}" ]
