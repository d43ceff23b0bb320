#!/bin/sh
# scene-plan writes the example of formats/plan/plan.md: sh tests/pipelines/plan_example.sh BIN [--write]
# Run at the top of the tree; BIN is the folder with the tools. Keys hash the programs, so any key is accepted at its
# place. A second run must write nothing. --write: puts what scene-plan writes onto the page instead.
bin=$1 write=$2 top=$PWD page=formats/plan/plan.md
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
keyless() { sed 's/-[0-9a-f]\{10\}/-KEY/g'; }
command=$(sed -n 's/^`\(scene-plan [^`]*\)` writes this plan.mk.*/\1/p' $page)
sed -n '/^```make$/,/^```$/p' $page | sed '1d;$d' | keyless > "$work/expected"
[ -n "$command" ] && [ -s "$work/expected" ] || { echo "FAILED: no example in $page"; exit 1; }
folder=${command##* -o }; folder=${folder%% *}

ln -s "$top/pipelines" "$work/pipelines" && cd "$work" && eval "$bin/$command --quiet" || exit 1
if [ "$write" = --write ]; then
  awk -v example="$folder/plan.mk" '/^```$/ { inside = 0 } !inside
    /^```make$/ { inside = 1; while ((getline line < example) > 0) print line }' "$top/$page" > page &&
    cat page > "$top/$page"
  exit
fi
keyless < "$folder/plan.mk" | diff -u expected - || { echo 'FAILED: plan.mk is not as on the page'; exit 1; }
python3 -m json.tool "$folder/plan.json" > /dev/null || { echo 'FAILED: plan.json is no JSON'; exit 1; }

ls -lR --time-style=full-iso "$folder" > before
eval "$bin/$command --quiet" || exit 1
ls -lR --time-style=full-iso "$folder" > after
diff before after || { echo 'FAILED: a second run wrote something'; exit 1; }
echo ok
