#!/bin/sh
# The second reader (read_meshirrad.py, written from the page) and the C++ agree: on files that the C++ wrote, on bytes when it writes
# them again, and on the folders accept and refuse.
#
#     read_meshirrad_test.sh PATH-OF-MESHIRRAD_TEST       in the folder tests
program=$1
here=$(pwd)/formats
folder=$(mktemp -d) || exit 3
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$here
trap 'rm -rf "$folder"' EXIT
bad=0
fail() { echo "read_meshirrad_test: $*"; bad=1; }
TEMPOLUX_SECOND_READER=$folder "$program" --gtest_filter='*.FilesForTheSecondReader' >"$folder/log" 2>&1 ||
  { cat "$folder/log"; fail "the C++ failed"; }
[ -e "$folder/rich.meshirrad" ] || fail "the C++ wrote nothing"
for file in "$folder"/*.meshirrad; do
  python3 "$here/read_meshirrad.py" "$file" "$folder/copy" >"$folder/json" || fail "$file not read"
  python3 -c 'import json, sys; print(json.load(sys.stdin)["elements"])' <"$folder/json" | cmp - "$file.expected" || fail "$file: other numbers"
  cmp "$file" "$folder/copy" || fail "$file: written again, other bytes"
done
python3 "$here/accept_and_refuse.py" meshirrad "$here"/meshirrad/*/*.meshirrad || fail "folders accept and refuse"
exit $bad
