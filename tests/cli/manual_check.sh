# Every option that --help shows is in the man page and in the completion of its tool; both are sound. The page in
# docs/tools has the tool's purpose, usage and options as --help says them.
failed=0
bad() { echo "$tool: $*"; failed=1; }
for path in "$BUILD"/bin/*; do
  [ -x "$path" ] || continue
  tool=$(basename "$path")
  page=$HERE/../../docs/tools/$tool.md
  awk -v version=1.0 -f "$HERE/../../cmake/man_page.awk" "$page" >page.1 2>errors.txt || bad "man page: awk exits $?"
  "$path" --help-markdown >table 2>>errors.txt || bad "--help-markdown exits $?"
  grep '^|' "$page" | cmp -s - table || bad "its options differ from docs/tools/$tool.md; run docs/make_tools.sh"
  "$path" --help | sed -n '1p; s/^Usage: /    /p' >head
  sed -n '3p; 5p' "$page" | cmp -s - head || bad "purpose or usage differ from docs/tools/$tool.md"
  "$path" --help-completion >completion 2>>errors.txt || bad "--help-completion exits $?"
  [ -s errors.txt ] && bad "writes to standard error: $(cat errors.txt)"
  sed 's/\\-/-/g' page.1 >plain
  for section in NAME SYNOPSIS DESCRIPTION OPTIONS 'EXIT STATUS' FILES EXAMPLES 'SEE ALSO'; do
    grep -A1 "^\.SH $section\$" plain | tail -1 | grep -q '^[^.]\|^\.TP\|^\.PP' || bad "man page without $section"
  done
  grep -A1 '^.SH DESCRIPTION' plain | tail -1 | grep -q '^\.SH' && bad "DESCRIPTION is empty: docs/tools/$tool.md"
  "$path" --help | sed -n '/^Options:/,$s/^  \(-[^ ]*\).*/\1/p' | tr ',' '\n' >options
  [ "$(wc -l <options)" -gt 9 ] || bad "--help shows $(wc -l <options) options"
  while read -r option; do
    grep -q -e "\\\\fB$option\\\\fR" plain || bad "$option is not in the man page"
    grep -q -e "[ ']$option[ ']" completion || bad "$option is not in the completion"
  done <options
  # A default is shown in the page as it is in --help.
  "$path" --help | sed -n '/^Options:/,$p' | grep -o '\[[0-9a-z.,]*\]' | sort -u >defaults
  while read -r default; do grep -qF "$default" plain || bad "default $default is not in the man page"; done <defaults
  if command -v groff >/dev/null; then
    groff -man -ww -z page.1 >warnings 2>&1
    [ -s warnings ] && bad "groff: $(head -3 warnings)"
  fi
  if command -v mandoc >/dev/null; then mandoc -T lint -W warning page.1 >warnings || bad "mandoc: $(head -3 warnings)"; fi
  if command -v bash >/dev/null; then
    bash -n completion || bad "completion is no bash"
    bash -c '. ./completion; f=_$(echo '"$tool"' | tr - _)
      COMP_WORDS=('"$tool"' --thr); COMP_CWORD=1; $f; [ "${COMPREPLY[*]}" = --threads ] || exit 1
      COMP_WORDS=('"$tool"' --stats a); COMP_CWORD=2; $f; [ "${#COMPREPLY[*]}" = 0 ]' || bad "completion completes wrongly"
  fi
done
tool=scene-plan
if command -v bash >/dev/null; then
  scene-plan --help-completion >completion
  words=$(bash -c '. ./completion; COMP_WORDS=(scene-plan --light-units s); COMP_CWORD=2; _scene_plan; echo "${COMPREPLY[*]}"')
  [ "$words" = spec ] || bad "--light-units s is completed to '$words'"
fi
exit $failed
