#!/bin/sh
# The second reader (read_photons.py, written from the page) and the C++ agree: on files that the C++ wrote, on
# bytes when it writes them again, on what it filters, and on the folders accept and refuse.
#
#     read_photons_test.sh PATH-OF-PHOTONS_TEST       in the folder tests
program=$1
. formats/second_reader.sh
numbers() {  # what FILE.expected holds, from the JSON
  python3 -c 'import json, sys
j = json.load(sys.stdin)
print(j["photons"], *("%.17g" % x for k in ("stored_flux", "emitted_flux", "escaped_flux") for x in j[k]))'
}

cpp
for file in "$folder"/*.photons; do
  python3 "$here/read_photons.py" "$file" "$folder/copy" >"$folder/json" || fail "$file not read"
  numbers <"$folder/json" | cmp - "$file.expected" || fail "$file: other numbers"
  cmp "$file" "$folder/copy" || fail "$file: written again, other bytes"
done

# A filter of a few lines; the C++ accepts what it writes and counts the same photons.
PYTHONPATH=$here python3 - "$folder/plain.photons" "$folder/caustic.photons" >"$folder/count" <<'END' || fail "filter"
import sys
from read_photons import KIND, RECORD, read_photons, split, write_photons
p = read_photons(sys.argv[1])
for block in p.blocks:
    block.records = b"".join(r for r in split(block.records) if RECORD.unpack(r)[KIND] == 1)
p.history.append("filter: caustic photons")
write_photons(sys.argv[2], p)
print(sum(len(b.records) // 32 for b in p.blocks))
END
cpp
[ "$(cut -d' ' -f1 "$folder/caustic.photons.expected")" = "$(cat "$folder/count")" ] || fail "filter: other count"
[ "$(cat "$folder/count")" = 23333 ] || fail "filter: $(cat "$folder/count") photons instead of 23333"

set --
for file in "$here"/photons/*/*.photons; do
  case $file in
    */refuse/overlay-base.photons | *-base-of-other-digest.photons) ;;   # good; needs XXH3
    *) set -- "$@" "$file" ;;
  esac
done
python3 "$here/accept_and_refuse.py" photons "$@" || fail "folders accept and refuse"
exit $bad
