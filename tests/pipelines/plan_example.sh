#!/bin/sh
# scene-plan writes the examples of formats/plan/plan.md, and its table of stages: sh tests/pipelines/plan_example.sh
# BIN [--write]
# Run at the top of the tree; BIN is the folder with the tools. Keys hash the programs, so any key is accepted at its
# place. A second run must write nothing. --write: puts what scene-plan writes onto the page instead.
bin=$1 write=$2 top=$PWD page=formats/plan/plan.md
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
keyless() { sed 's/-[0-9a-f]\{10\}/-KEY/g'; }
command=$(sed -n 's/^`\(scene-plan [^`]*\)` writes this plan.mk.*/\1/p' $page)
[ -n "$command" ] || { echo "FAILED: no example in $page"; exit 1; }
folder=${command##* -o }; folder=${folder%% *}

ln -s "$top/pipelines" "$work/pipelines" && cd "$work" && eval "$bin/$command --quiet" || exit 1
# The page with what scene-plan writes: the block of make, the block of text, the rows of the table of stages.
python3 - "$top/$page" "$folder" > page << 'END' || { echo 'FAILED: plan.json or the page'; exit 1; }
import json, re, sys
page, out = open(sys.argv[1]).read(), sys.argv[2]
plan = json.load(open(f"{out}/plan.json"))
line = next(line for line in open(f"{out}/plan.json") if line.startswith('  {"file": "cache/0000-'))
entry = re.sub(r'"/[^"]*/pipelines/', '"/home/me/tempolux/pipelines/', line.strip().rstrip(","))
rows = "".join(f"| {s['folder']} | {s['extensions'].replace(' ', ', ')} | {s['stage']} | {s['tool']} | {s['words']} |\n"
               for s in plan["stages"])
for start, text, end in (("```make\n", open(f"{out}/plan.mk").read(), "```\n"), ("```text\n", entry + "\n", "```\n"),
                         ("| folder | files | stage | program | what it makes |\n|---|---|---|---|---|\n", rows, "\n")):
    before, found, rest = page.partition(start)
    assert found, start
    page = before + found + text + rest[rest.index(end) if rest.startswith(end) else rest.index("\n" + end) + 1:]
sys.stdout.write(page)
END
if [ "$write" = --write ]; then cat page > "$top/$page"; exit; fi
keyless < "$top/$page" > expected
keyless < page | diff -u expected - ||
  { echo "FAILED: $page has something else; plan_example.sh BIN --write corrects it"; exit 1; }

ls -lR --time-style=full-iso "$folder" > before
eval "$bin/$command --quiet" || exit 1
ls -lR --time-style=full-iso "$folder" > after
diff before after || { echo 'FAILED: a second run wrote something'; exit 1; }
echo ok
