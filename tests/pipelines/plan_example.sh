#!/bin/sh
# The example of formats/plan/plan.md is what scene-plan writes: sh tests/pipelines/plan_example.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. A second run must leave every file as it was.
bin=$1 top=$PWD page=formats/plan/plan.md
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
command=$(sed -n 's/^`\(scene-plan [^`]*\)` writes this plan.mk.*/\1/p' $page)
sed -n '/^```make$/,/^```$/p' $page | sed '1d;$d' > "$work/expected"
[ -n "$command" ] && [ -s "$work/expected" ] || { echo "FAILED: no example in $page"; exit 1; }

ln -s "$top/pipelines" "$work/pipelines" && cd "$work" && eval "$bin/$command --quiet" || exit 1
diff -u expected plan/plan.mk || { echo 'FAILED: plan.mk is not as on the page'; exit 1; }
python3 -m json.tool plan/plan.json > /dev/null || { echo 'FAILED: plan.json is no JSON'; exit 1; }
for variable in light camera; do
  for file in $(printf 'include plan/plan.mk\nall: ; @echo $(%s_0090)\n' $variable | make -s -f -); do
    grep -qE '^[0-9a-f]{32}$' "$file" || { echo "FAILED: $file is not one hash"; exit 1; }
  done
done

ls -l --time-style=full-iso plan/state plan/plan.json > before
eval "$bin/$command --quiet" || exit 1
ls -l --time-style=full-iso plan/state plan/plan.json > after
diff before after || { echo 'FAILED: files of equal content were written again'; exit 1; }
echo ok
