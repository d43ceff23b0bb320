#!/bin/sh
# install.sh FOLDER -- puts the renderers of `packages` into FOLDER, each with a Python of its own (about 2 GB). Nothing of
# the product needs them; where PyPI is not reached or Python is not 3.11, they are skipped by name.
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1" || exit 3
python=$(command -v python3.11 || command -v python3)
while read -r name packages; do
  [ -f "$1/$name/done" ] && [ "$(cat "$1/$name/done")" = "$packages" ] && { echo "$name: is there"; continue; }
  # shellcheck disable=SC2086
  if "$python" -m venv "$1/$name" 2> "$1/log" && "$1/$name/bin/pip" install -q --no-input $packages 2> "$1/log"; then
    echo "$packages" > "$1/$name/done"
    echo "$name: $packages"
  else
    echo "$name: skipped: $(grep -v '^$' "$1/log" | tail -n 1)"
  fi
done < "$here/packages"
