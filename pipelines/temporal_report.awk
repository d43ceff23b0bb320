# Prints a table of what gathering over time did in each frame, from the statistics of gather-temporal:
#     awk -f temporal_report.awk OUT/kept/*.json
# A row for each frame: its records, those born and those removed, rays, the share of the cells that were traced again,
# their mean age, CPU seconds.
function row() {
  if (frame == "") return
  printf "| %s | %d | %d | %d | %d | %s | %.2f | %.2f |\n", frame, v["records"], v["records_born"],
    v["records_removed"], v["birth_rays"] + v["update_rays"],
    "retraced_share" in v ? sprintf("%.1f %%", 100 * v["retraced_share"]) : "first", v["mean_age"], cpu
}
BEGIN {
  print "| frame | records | born | removed | rays | cells traced again | mean age | CPU s |"
  print "|---|---|---|---|---|---|---|---|"
}
FNR == 1 { row(); split("", v); frame = "" }
/^  "cpu_s"/ { split($0, part, ": "); cpu = part[2] + 0 }
{
  split($0, quoted, "\"")
  if (match(quoted[2], /\.-?[0-9]+$/)) {
    frame = substr(quoted[2], RSTART + 1)
    value = quoted[3]
    sub(/^: */, "", value)
    v[substr(quoted[2], 1, RSTART - 1)] = value + 0
  }
}
END { row() }
