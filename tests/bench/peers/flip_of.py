"""FLIP (Andersson et al. 2020, its authors' package) of pictures, in the Python of build/peers/oidn: flip_of.py EXPOSURE REFERENCE.pfm TEST.pfm ..."""

import sys

import numpy
from flip_evaluator import evaluate


def read(path):
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        linear = numpy.frombuffer(file.read(), "<f4").reshape(height, width, 3) * float(sys.argv[1])
    linear = numpy.clip(linear, 0, 1)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055).astype(numpy.float32)


reference = read(sys.argv[2])
for test in sys.argv[3:]:
    print(evaluate(reference, read(test), "LDR")[1])
