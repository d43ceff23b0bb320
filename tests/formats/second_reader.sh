# For the tests of second readers, which source it in the folder tests with $program, the C++ test of their format: a folder that goes at
# the end, `fail REASON`, and `cpp`, which has the C++ write its files there. Exit with $bad.
here=$(pwd)/formats
folder=$(mktemp -d) || exit 3
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$here
trap 'rm -rf "$folder"' EXIT
bad=0
fail() { echo "$(basename "$0" .sh)${format:+ $format}: $*"; bad=1; }
cpp() {  # writes its files into the folder, and FILE.expected for each one there
  TEMPOLUX_SECOND_READER=$folder "$program" --gtest_filter='*.FilesForTheSecondReader' >"$folder/log" 2>&1 ||
    { cat "$folder/log"; fail "the C++ failed"; }
}
