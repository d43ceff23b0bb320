#!/bin/sh
# No file of the tree holds a marker of a merge conflict. Run at the top of the tree.
# The patterns are written with {7}, so that this file is not found.
if grep -rnIE '^(<{7}|={7}|>{7}|[|]{7})( |$)' .ci CHANGES.md CMakeLists.txt Makefile.example README.md RESULTS.md \
  cmake docs formats lib modules pipelines tests tools; then
  echo '^ a merge left its marker'; exit 1
fi
