#!/bin/sh
# Write the pages of docs/tools from the tools' own definitions: sh docs/make_tools.sh [BIN [FOLDER]]
# Run at the top of the tree; BIN is the folder with the tools.
bin=${1:-build/release/bin} out=${2:-docs/tools}
mkdir -p "$out" || exit 3
{
  printf '# Tools\n\nA page each, made by `sh docs/make_tools.sh` from the definitions that `--help` and the man pages are made from.\n\n| tool | what it does |\n|---|---|\n'
  for path in "$bin"/*; do
    tool=${path##*/}
    "$path" --help-markdown > "$out/$tool.md" || exit 1
    printf '| [%s](%s.md) | %s |\n' "$tool" "$tool" "$(sed -n 3p "$out/$tool.md")"
  done
  printf '\nWhat all tools share: [tools/README.md](../../tools/README.md). How they work together: [chain.md](../chain.md).\n'
} > "$out/README.md"
