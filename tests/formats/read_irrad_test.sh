#!/bin/sh
# The second readers (read_irradpoints.py, read_irradcache.py, written from the pages) and the C++ agree: on files that the C++
# wrote, on bytes when they write them again, on what a filter makes of them, and on the folders accept and refuse.
#
#     read_irrad_test.sh FORMAT PATH-OF-ITS-TEST       in the folder tests; FORMAT: irradpoints or irradcache
format=$1 program=$2
. formats/second_reader.sh
numbers() {  # what FILE.expected holds, from the JSON
  python3 -c 'import json, sys
j = json.load(sys.stdin)
e = j["irradiance"]
sums = sum(e.values(), []) if isinstance(e, dict) else e
print(j.get("points", j.get("records")), *("%.17g" % x for x in sums))'
}

cpp
for file in "$folder"/*."$format"; do
  python3 "$here/read_$format.py" "$file" "$folder/copy" >"$folder/json" || fail "$file not read"
  numbers <"$folder/json" | cmp - "$file.expected" || fail "$file: other numbers"
  cmp "$file" "$folder/copy" || fail "$file: written again, other bytes"
done

# Half of the records dropped in Python; the C++ accepts what is left and counts the same.
python3 - "$format" "$folder/rich.$format" "$folder/static.$format" >"$folder/count" <<'END' || fail "filter"
import importlib
import sys
name, source, target = sys.argv[1:]
module = importlib.import_module("read_" + name)
file = getattr(module, "read_" + name)(source)
field = "points" if name == "irradpoints" else "records"
setattr(file, field, [r for r in getattr(file, field) if r.set == 0])
file.history.append("filter: static only")
getattr(module, "write_" + name)(target, file)
print(len(getattr(file, field)))
END
cpp
[ "$(cut -d' ' -f1 "$folder/static.$format.expected")" = "$(cat "$folder/count")" ] || fail "filter: other count"
half=$(($(cut -d' ' -f1 "$folder/rich.$format.expected") / 2))
[ "$(cat "$folder/count")" = "$half" ] || fail "filter: $(cat "$folder/count") instead of $half"

python3 "$here/accept_and_refuse.py" "$format" "$here/$format"/*/* || fail "folders accept and refuse"

# The files in the repository are those that make_irrad_files.py makes.
python3 "$here/make_irrad_files.py" "$folder/made" || fail "make_irrad_files.py"
diff -r "$folder/made/$format" "$here/$format" && diff -r "$folder/made/paths" "$here/paths" || fail "make_irrad_files.py makes other files"
exit $bad
