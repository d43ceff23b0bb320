#!/bin/sh
# The second reader (read_paths.py, written from the page) and the C++ agree: on files that the C++ wrote, on bytes when it writes
# them again, and on the folders accept and refuse.
#
#     read_paths_test.sh PATH-OF-PATHS_TEST       in the folder tests
program=$1
here=$(pwd)/formats
folder=$(mktemp -d) || exit 3
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$here
trap 'rm -rf "$folder"' EXIT
bad=0
fail() { echo "read_paths_test: $*"; bad=1; }
TEMPOLUX_SECOND_READER=$folder "$program" --gtest_filter='*.FilesForTheSecondReader' >"$folder/log" 2>&1 ||
  { cat "$folder/log"; fail "the C++ failed"; }
[ -e "$folder/rich.paths" ] || fail "the C++ wrote nothing"
for file in "$folder"/*.paths; do
  python3 "$here/read_paths.py" "$file" "$folder/copy" >"$folder/json" || fail "$file not read"
  python3 -c 'import json, sys; print(json.load(sys.stdin)["paths"])' <"$folder/json" | cmp - "$file.expected" || fail "$file: other numbers"
  cmp "$file" "$folder/copy" || fail "$file: written again, other bytes"
done
python3 - "$here"/paths/*/*.paths <<'END_OF_PYTHON' || fail "folders accept and refuse"
import sys
from read_paths import read_paths
wrong = 0
for path in sys.argv[1:]:
    try:
        read_paths(path)
        good = True
    except (ValueError, OSError):
        good = False
    if good != ("/accept/" in path):
        print(path, "was read" if good else "was refused")
        wrong = 1
sys.exit(wrong)
END_OF_PYTHON
exit $bad
