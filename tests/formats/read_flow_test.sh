#!/bin/sh
# The second readers of flow and mask, written from the pages, print what the pages show; they refuse what they must; and
# tempolux-info counts a mask's causes as read_mask.py does.
#
#     read_flow_test.sh FOLDER-OF-THE-TOOLS       in the folder tests
bin=$1
folder=$(mktemp -d) || exit 3
trap 'rm -rf "$folder"' EXIT
export PYTHONDONTWRITEBYTECODE=1
bad=0
fail() { echo "read_flow_test: $*"; bad=1; }

for format in flow mask; do
  page=../formats/$format/$format.md
  python3 formats/read_$format.py formats/$format/accept/worked-example.exr | sed 's/^/    /' > "$folder/printed" || fail "$format: not read"
  sed -n '/^prints$/,/^The file\|^`tempolux/p' "$page" | grep '^    ' | cmp - "$folder/printed" || fail "$page: prints something else"
  python3 formats/accept_and_refuse.py "$format" formats/"$format"/*/* || fail "$format: folders accept and refuse"
done

"$bin/tempolux-info" --json formats/mask/accept/worked-example.exr | python3 -c '
import json, sys
causes = {c["cause"]: c for c in json.load(sys.stdin)["causes"]}
assert causes["all"] == {"cause": "all", "pixels": 3, "share": .75}, causes
assert causes["edge"]["pixels"] == 1 and causes["edge"]["share"] == 0, causes      # occlusion is its first cause
assert causes["occlusion"]["share"] == .25 and causes["slow"]["pixels"] == 0, causes' || fail "tempolux-info counts otherwise"
"$bin/tempolux-info" --png "$folder/why.png" formats/mask/accept/worked-example.exr || fail "no picture of a mask"

python3 formats/make_flow_files.py "$folder/made" || fail "make_flow_files.py"
for format in flow mask; do
  diff -r "$folder/made/$format" formats/$format || fail "make_flow_files.py makes other files"
done
exit $bad
