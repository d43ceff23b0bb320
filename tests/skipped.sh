#!/bin/sh
# skipped.sh LOG -- how many tests of a ctest run were skipped, which, and why. LOG: Testing/Temporary/LastTest.log of the build folder.
# Single tests of a GoogleTest program are named too; "only for ..." are writers that a script calls, not tests.
awk '
  / Testing: / { program = $NF }
  reason_follows { reason = $0; reason_follows = 0 }
  /: Skipped$/ { reason_follows = 1 }
  /^\[  SKIPPED \] .* \([0-9]+ ms\)$/ { if (reason !~ /^only for/) found[++count] = program ", " $4 ": " reason; reason = "" }
  /^skipped: / { found[++count] = program ": " substr($0, 10) }
  END { print count + 0 " tests skipped" (count ? ":" : ""); for (i = 1; i <= count; i++) print "  " found[i] }
' "$1"
