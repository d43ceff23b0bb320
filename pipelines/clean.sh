#!/bin/sh
# clean.sh -- removes what was built in this tree and what the pipeline made in OUT. Other files in these folders stay.
for preset in release debug asan tsan no-oiio fuzz; do
  grep -qs '^CMAKE_PROJECT_NAME:STATIC=tempolux$' "$TOP/build/$preset/CMakeCache.txt" && rm -rf "$TOP/build/$preset"
done
rmdir "$TOP/build" 2> /dev/null
cd "$OUT" 2> /dev/null || exit 0
[ -f plan.mk ] && [ -f plan.json ] || exit 0
ours='[0-9+]+-[0-9a-f]{10}[._a-z]*|[a-z]+-[0-9a-f]{10}|inputs|planned.json|costs.json|warnings|files[.0-9]*'
ours="$ours|.*[.](csv|md|html|svg|png|gp)"
for folder in state shown report $(sed -n 's/^   "folder": "\([a-z_]*\)",$/\1/p' plan.json); do   # of all stages
  [ -d "$folder" ] || continue
  find "$folder" -maxdepth 1 -type f -regextype egrep -regex "[a-z_]+/($ours)" -delete
  rm -rf "$folder/.lock" "$folder/.makes" "$folder/.planning" "$folder"/.*.tmp.* "$folder"/.*.claim
  rmdir "$folder" 2> /dev/null
done
rm -rf state/slurm-* state/.slurm-*
rmdir state 2> /dev/null
rm -rf report/files   # what `make report` measures
rmdir report 2> /dev/null
find frames -maxdepth 1 -type f -regextype egrep -regex 'frames/-?[0-9]+[.](exr|png)' -delete 2> /dev/null
rm -f plan.mk plan.json sheet.png walk.log film.mp4 compare.html timeline.json
rmdir frames "$OUT" 2> /dev/null
exit 0
