#!/bin/sh
# Write the options of the pages in docs/tools as the tools define them: sh docs/make_tools.sh [BIN [FOLDER]]
# Run at the top of the tree; BIN is the folder with the tools. All other text of the pages is written by hand.
bin=${1:-build/release/bin} out=${2:-docs/tools}
{
  printf '# Tools\n\nA page each. Their options are written by `sh docs/make_tools.sh`, the man pages are made from these pages.\n\n| tool | what it does |\n|---|---|\n'
  for path in "$bin"/*; do
    tool=${path##*/}
    table=$("$path" --help-markdown) || exit 1
    TABLE=$table awk '/^\| option / { print ENVIRON["TABLE"]; old = 1 } !/^\|/ { old = 0 } !old' "$out/$tool.md" > "$out/$tool.new" &&
      mv "$out/$tool.new" "$out/$tool.md" || exit 1
    printf '| [%s](%s.md) | %s |\n' "$tool" "$tool" "$(sed -n 3p "$out/$tool.md")"
  done
  printf '\nWhat all tools share: [tools/README.md](../../tools/README.md). How they work together: [chain.md](../chain.md).\n'
} > "$out/README.md"
