#!/usr/bin/env python3
"""Leave out the photons of one kind: drop_kind.py caustic < in.photons > out.photons

Written from formats/photons/photons.md; numbers at the right are its sections."""
import math
import struct
import sys
import zlib

drop = ["direct", "caustic", "indirect", "volume"].index(sys.argv[1])             # 4
file, out = sys.stdin.buffer, sys.stdout.buffer.write
fixed = file.read(16)                                                             # 2
text = file.read(struct.unpack("<I", fixed[12:])[0]) + f"history: drop_kind.py {sys.argv[1]}\n".encode()
if not fixed.startswith(b"\x89TPHOT\r\n\1\0") or b"\nbase: " in text:
    sys.exit("drop_kind.py: not .photons version 1, or an overlay; give it a whole map")
head = fixed[:12] + struct.pack("<I", len(text)) + text
chain = struct.pack("<I", zlib.crc32(head))
out(head + chain)
file.read(4)
names = text.split(b"columns: ")[1].split(b"\n")[0]                               # 5
sizes = [32] + [4] * (0 if names == b"none" else len(names.split(b",")))
fluxes = [(0.0, 0.0, 0.0)]
while (mark := file.read(4)) == b"PHOT":                                          # 3
    group, count, _ = struct.unpack("<III", file.read(12))
    columns = [file.read(size * count) for size in sizes]
    kept = [i for i in range(count) if columns[0][32 * i + 30] != drop]
    fluxes += [struct.unpack_from("<3f", columns[0], 32 * i + 12) for i in kept]
    body = b"".join(column[i * size:i * size + size] for column, size in zip(columns, sizes) for i in kept)
    head = mark + struct.pack("<II", group, len(kept))
    chain += struct.pack("<I", zlib.crc32(head + body))
    out(head + chain[-4:] + body)
if mark in (b"LEDG", b"LEDU", b"LEDP"):                                           # 6, as it was
    pilots = int(text.split(b"\npilots: ")[1].split(b"\n")[0]) if mark == b"LEDP" else 0
    entry = 76 if mark == b"LEDG" else 88 + 32 * pilots
    head = file.read(8)
    chain += head[4:]
    out(mark + head + file.read(entry * struct.unpack("<I", head[:4])[0]))
    mark = file.read(4)
end = mark + struct.pack("<Q3d", len(fluxes) - 1, *map(math.fsum, zip(*fluxes))) + file.read(108)[32:104]
out(end + struct.pack("<I", zlib.crc32(end, zlib.crc32(chain))))                  # 7
