"""accept_and_refuse.py FORMAT FILE...: the second reader of a format reads what lies in a folder accept, and nothing else."""
import importlib
import sys

name = sys.argv[1]
read = getattr(importlib.import_module("read_" + name), "read_" + name)
wrong = 0
for path in sys.argv[2:]:
    try:
        read(path)
        good = True
    except (ValueError, OSError):
        good = False
    if good != ("/accept/" in path):
        print(path, "was read" if good else "was refused")
        wrong = 1
sys.exit(wrong)
