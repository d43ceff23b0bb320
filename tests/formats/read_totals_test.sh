#!/bin/sh
# A second reader (read_FORMAT.py, written from the page) and the C++ agree: on files that the C++ wrote, on bytes when it writes
# them again, and on the folders accept and refuse.
#
#     read_totals_test.sh FORMAT PATH-OF-ITS-TEST       in the folder tests; FORMAT: paths or meshirrad
format=$1 program=$2
. formats/second_reader.sh
cpp
[ -e "$folder/rich.$format" ] || fail "the C++ wrote nothing"
for file in "$folder"/*."$format"; do
  python3 "$here/read_$format.py" "$file" "$folder/copy" >"$folder/json" || fail "$file not read"
  python3 -c 'import json, sys
j = json.load(sys.stdin)
print(j.get("paths", j.get("elements", j.get("cells"))))' <"$folder/json" | cmp - "$file.expected" ||
    fail "$file: other numbers"
  cmp "$file" "$folder/copy" || fail "$file: written again, other bytes"
done
python3 "$here/accept_and_refuse.py" "$format" "$here/$format"/*/*."$format" || fail "folders accept and refuse"
exit $bad
