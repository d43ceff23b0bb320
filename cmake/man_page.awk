# cmake/man_page.awk -- turns a page of docs/tools into a man page of section 1:
#
#     awk -v version=1.0 -f cmake/man_page.awk docs/tools/photon-trace.md > photon-trace.1

# Text of a Markdown line as roff: links become their names, escapes their characters.
function roff(text) {
  while (match(text, /\[[^]]*\]\([^)]*\)/)) {
    link = substr(text, RSTART + 1, RLENGTH - 1)
    text = substr(text, 1, RSTART - 1) substr(link, 1, index(link, "](") - 1) substr(text, RSTART + RLENGTH)
  }
  gsub(/\\/, "", text)
  gsub(/-/, "\\-", text)
  return text ~ /^[.']/ ? "\\&" text : text
}
# "`-o`, `--output` FILE": names are bold, the value is italic.
function option_head(text, value) {
  value = text
  sub(/^.*`/, "", value)
  text = substr(text, 1, length(text) - length(value))
  while (sub(/`/, "\\fB", text)) sub(/`/, "\\fR", text)
  return value == "" ? text : text " \\fI" substr(value, 2) "\\fR"
}
function add(text) { body[section] = body[section] text "\n" }

NR == 1 { name = substr($0, 3); section = "head"; next }
NR == 3 { what = tolower(substr($0, 1, 1)) substr($0, 2); sub(/\.$/, "", what); next }
NR == 5 { synopsis = $0; sub(/^ *[^ ]+/, "", synopsis); section = "DESCRIPTION"; next }
/^## / { section = toupper(substr($0, 4)); pending = ""; next }
/^See also: / {
  section = "SEE ALSO"
  sub(/^See also: \[/, "\\fB")
  sub(/\. Exit codes.*/, "")
  gsub(/\]\([^)]*\)/, "\\fR(1)")
  gsub(/ \[/, ",\n\\fB")
  add($0)
  next
}
/^\| `/ {
  gsub(/\\\|/, "\001")
  split($0, cell, " [|] ?")
  gsub(/\001/, "|", cell[2])
  gsub(/`/, "", cell[3])
  add(".TP\n" option_head(roff(substr(cell[1], 3))) "\n" roff(cell[2]) (cell[3] == "" ? "" : " [" roff(cell[3]) "]"))
  next
}
/^\|/ { next }
/^- / { colon = index($0, ": "); add(".TP\n\\fI" roff(substr($0, 3, colon - 3)) "\\fR\n" roff(substr($0, colon + 2))); next }
/^    / { add(".PP\n.EX\n    " roff(substr($0, 5)) "\n.EE"); next }
/^$/ { if (body[section] != "") pending = ".PP"; next }
{ add(pending == "" ? roff($0) : ".PP\n" roff($0)); pending = "" }

END {
  body["EXIT STATUS"] = ".TP\n0\ndone, all outputs complete\n.TP\n1\ndiffers or not valid: only \\fBaqm\\-compare\\fR with " \
    "\\fB\\-\\-fail\\-above\\fR and \\fBtempolux\\-info\\fR with \\fB\\-\\-check\\fR or \\fB\\-\\-diff\\fR\n.TP\n2\nusage; bad or " \
    "stale input\n.TP\n3\ncould not be done: no memory, disk full, write failed\n.TP\n128+n\nended by signal n; no output is left unfinished\n"
  body["ENVIRONMENT"] = ".TP\nTEMPOLUX_THREADS\nthreads where \\fB\\-\\-threads\\fR is not given\n"
  printf ".TH %s 1 \"\" \"tempolux %s\" \"tempolux\"\n.SH NAME\n%s \\- %s\n", name, version, roff(name), roff(what)
  printf ".SH SYNOPSIS\n\\fB%s\\fR\\fI%s\\fR\n", roff(name), roff(synopsis)
  count = split("DESCRIPTION|OPTIONS|EXIT STATUS|ENVIRONMENT|FILES|EXAMPLES|SEE ALSO", order, "|")
  for (i = 1; i <= count; ++i) if (body[order[i]] != "") printf ".SH %s\n%s", order[i], body[order[i]]
}
