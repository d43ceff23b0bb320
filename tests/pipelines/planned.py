"""What a plan says: python3 planned.py OUT indirect | moving | ...      a decision of the first segment, as in plan.json
                    python3 planned.py OUT name STAGE FRAME           the file that the stage (its folder) makes for a frame"""
import json
import re
import sys

out, what, *more = sys.argv[1:]
if what == "name":
    folder, frame = more
    names = re.findall(rf"^({folder}/{frame}-[^ :]*)[^:]*: words", open(f"{out}/plan.mk").read(), re.M)
    print("\n".join(names))
else:
    value = json.load(open(f"{out}/plan.json"))["segments"][0]["decisions"][what]
    print(str(value).lower() if isinstance(value, bool) else value)
