#!/bin/sh
# Hostile input for every reader: builds the fuzzers with clang and runs each for FUZZ_SECONDS (60), as many at a time as
# there are processors, from the top of the tree. FUZZ_TARGETS='gltf report' runs these only; FUZZ_RUNS=1000000 counts
# executions instead of seconds. Ends with 1 if one of them found something; its input is then in build/fuzz/found/TARGET,
# and `build/fuzz/tests/TARGET_fuzz FILE` shows what it does.
if [ "$1" = --one ]; then   # one target, built already
  target=$2
  limit=-max_total_time=${FUZZ_SECONDS:-60}
  [ -n "$FUZZ_RUNS" ] && limit=-runs=$FUZZ_RUNS
  found=build/fuzz/found/$target known=build/fuzz/known/$target
  mkdir -p "$found" "$known"
  folders="tests/fuzz/corpus/$target tests/formats/$target"
  case $target in
    gltf) folders="$folders tests/data/packed/scenes" ;;
    pictures) folders="$folders tests/data/packed/webp tests/data/packed/avif" ;;
  esac
  set --
  for folder in $folders; do [ -d "$folder" ] && set -- "$@" "$folder"; done
  # Memory: 2 GB in all, no single piece above 512 MB. A run of more than 10 seconds counts as hanging.
  build/fuzz/tests/"${target}_fuzz" "$limit" -max_len=8192 -timeout=10 -rss_limit_mb=2048 \
    -malloc_limit_mb=512 -print_final_stats=1 -artifact_prefix="$found/" "$known" "$@" > "$found/log" 2>&1
  code=$?
  echo "$target: $(sed -n 's/.*number_of_executed_units: *//p' "$found/log") runs, exit $code"
  [ $code = 0 ] || grep -E '^(SUMMARY|not as promised|.*Test unit written)' "$found/log"
  exit $code
fi
targets=${FUZZ_TARGETS:-$(cd tests/fuzz && printf '%s\n' *_fuzz.cpp | sed 's/_fuzz[.]cpp$//')}
command -v clang++ > /dev/null || { echo 'fuzz: needs clang++ (Debian: apt-get install clang)' >&2; exit 2; }
test -f build/fuzz/build.ninja || cmake --preset fuzz > /dev/null || exit 2
# shellcheck disable=SC2046
cmake --build build/fuzz --target tempolux-decode $(printf '%s_fuzz ' $targets) || exit 2
# shellcheck disable=SC2086
printf '%s\n' $targets | xargs -n 1 -P "$(nproc)" sh tests/fuzz/run.sh --one || exit 1
