#!/bin/sh
# The second reader (read_radsamples.py, written from the page) and the C++ agree: on files that the C++ wrote, on bytes when it writes them
# again, and on the folders accept and refuse.
#
#     read_radsamples_test.sh PATH-OF-THE-TEST       in the folder tests
program=$1
. formats/second_reader.sh
cpp
for name in example many empty overlay low; do
  file=$folder/$name.radsamples
  python3 "$here/read_radsamples.py" "$file" "$folder/copy" >"$folder/json" || fail "$name not read"
  python3 -c 'import json, sys
j, e = json.load(open(sys.argv[1])), list(map(float, open(sys.argv[2]).read().split()))
found = [j["points"], j["records"], j["samples"], j["radiance"], j["mean_age"] * j["samples"]]
sys.exit(any(abs(a - b) > 1e-9 * abs(b) for a, b in zip(found, e)))' "$folder/json" "$file.expected" || fail "$name: other numbers"
  cmp "$file" "$folder/copy" || fail "$name: written again, other bytes"
done
python3 "$here/accept_and_refuse.py" radsamples "$here"/radsamples/*/* || fail "folders accept and refuse"
# The files in the repository are those that make_radsamples_files.py makes.
python3 "$here/make_radsamples_files.py" "$folder/made" || fail "make_radsamples_files.py"
diff -r "$folder/made/radsamples" "$here/radsamples" || fail "make_radsamples_files.py makes other files"
exit $bad
