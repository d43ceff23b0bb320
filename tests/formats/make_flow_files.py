#!/usr/bin/env python3
"""Make {flow,mask}/{accept,refuse} in a folder: small files, each named for what is right or wrong with it.

    make_flow_files.py FOLDER          FOLDER is tests/formats
"""
import os
import struct
import sys

from exr_files import exr

folder = sys.argv[1]
NAN, INF = float("nan"), float("inf")
FRAME = [("framesPerSecond", "rational", struct.pack("<iI", 24, 1)),
         ("tempolux:frame", "double", struct.pack("<d", 12)),
         ("tempolux:history", "string", b"0.1.0 ibr-warp 8.exr 16.exr --scene wall.glb --frame 12\n")]


def save(name, data):
    path = os.path.join(folder, name + ".exr")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)


def flow(**changed):
    """The worked example, some channels changed or (None) left out."""
    channels = {"forward.u": ("float", [1.5, 1.5, 0, 0]), "forward.v": ("float", [.5, .5, 0, 0]),
                "backward.u": ("float", [-1.5, 0, 0, 0]), "backward.v": ("float", [-.5, 0, 0, 0]),
                "speed": ("float", [12, 12, 0, 0]), "valid": ("uint", [3, 1, 3, 0])}
    for name, value in changed.items():
        channels[name.replace("_", ".")] = value
    return {name: value for name, value in channels.items() if value}


def save_flow(name, attributes=FRAME, **changed):
    save("flow/" + name, exr(2, 2, flow(**changed), attributes))


save_flow("accept/worked-example")
save_flow("accept/no-attributes", attributes=[])
save_flow("accept/further-channel", Z=("float", [1, 2, 3, INF]))
save_flow("accept/speed-as-half", speed=("half", [12, 12, 0, 0]))
save_flow("accept/motion-of-ten-thousand-pixels", forward_u=("float", [1e4, -1e4, 0, 0]))
for channel in flow():
    save_flow("refuse/no-" + channel.replace(".", "-"), **{channel: None})
save_flow("refuse/valid-as-float", valid=("float", [3, 1, 3, 0]))
save_flow("refuse/valid-4", valid=("uint", [3, 1, 4, 0]))
save_flow("refuse/speed-as-uint", speed=("uint", [12, 12, 0, 0]))
save_flow("refuse/speed-negative", speed=("float", [12, -1, 0, 0]))
save_flow("refuse/speed-infinite", speed=("float", [12, INF, 0, 0]))
save_flow("refuse/forward-nan", forward_v=("float", [.5, NAN, 0, 0]))
save_flow("refuse/backward-infinite", backward_u=("float", [-INF, 0, 0, 0]))


def save_mask(name, values, kind="uint", channel="why", attributes=FRAME, **more):
    save("mask/" + name, exr(len(values), 1, {channel: (kind, values), **more}, attributes))


save_mask("accept/worked-example", [0, 1, 2 + 64, 32])
save_mask("accept/no-attributes", [0, 1, 66, 32], attributes=[])
save_mask("accept/nothing-to-trace", [0, 0])
save_mask("accept/bit-without-a-name", [0, 256, 257])
save_mask("accept/further-channel", [0, 1], Z=("float", [1, 2]))
save_mask("refuse/no-why", [0, 1], channel="mask")
save_mask("refuse/why-as-float", [0, 1], kind="float")
save_mask("refuse/why-as-half", [0, 1], kind="half")
