"""Numbers whose extremes no scene reaches in minutes: unit tests hold them. The rows run the tests where they are built
(beside the folder of the tools), and fail in any case if one is no longer there."""
import pathlib
import subprocess

from session import case

TESTS = pathlib.Path(__file__).resolve().parents[1]
ROWS = [
    ("Halton index beyond 2^40", "lib/core/halton_test.cpp", "RadicalInverse", "IsExactToOneRoundingForEveryIndexSize"),
    ("Halton value below 1", "lib/core/halton_test.cpp", "RadicalInverse", "NeverReachesOneAtTheWorstIndices"),
    ("sums of tiny and huge terms", "formats/exact_sum_test.cpp", "ExactSum", "LosesNothingBetweenLargeAndSmall"),
    ("sums of 10^8 tiny terms", "formats/exact_sum_test.cpp", "ExactSum", "OfHundredMillionTinyTermsBesideALargeOneIsExact"),
    ("sums of many huge terms", "formats/exact_sum_test.cpp", "ExactSum", "OfManyHugeValuesIsFinite"),
    ("sums have no order", "formats/exact_sum_test.cpp", "ExactSum", "HasNoOrderAndJoins"),
    ("half floats at the upper end", "lib/image/exr_io_test.cpp", "Exr", "ValuesAboveHalfAreRefusedWithTheirPlace"),
    ("RGBE of kept samples, from end to end", "formats/radsamples_test.cpp", "RadianceSample", "RgbeComesBackWithinAStepFromEndToEnd"),
    ("half distances of kept samples, from end to end", "formats/radsamples_test.cpp", "RadianceSample", "HalvesComeBackAndStayInTheirRange"),
]


@case("numbers", "by unit tests")
def unit_tests(s):
    for quantity, file, group, name in ROWS:
        path = TESTS / file
        there = path.exists() and f"TEST({group}, {name})" in path.read_text(encoding="utf-8")
        program = s.tools.parent / "tests" / path.stem
        if there and program.exists():
            done = subprocess.run([program, f"--gtest_filter={group}.{name}"], capture_output=True, text=True, timeout=300)
            there = done.returncode == 0 and "[  PASSED  ] 1 test." in done.stdout
        s.row(quantity, f"{file}", f"{group}.{name}", "", "ok" if there else "FAIL")
