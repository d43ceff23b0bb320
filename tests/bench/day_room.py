#!/usr/bin/env python3
"""A room with a window and a sun: python3 -B tests/bench/day_room.py FILE.gltf

The room fills its scene, so nearly all photons of the sun and of a sky meet its outer walls: photon-trace sends them through the opening.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
from scenes import Scene, box_mesh  # noqa: E402

scene = Scene()
wall, wood = scene.material((0.7, 0.65, 0.6)), scene.material((0.5, 0.3, 0.2), roughness=0.4, specular=1)
for corner, other in [((-2, -0.1, -2), (2, 0, 2)), ((-2, 2.4, -2), (2, 2.5, 2)), ((-2.1, 0, -2), (-2, 2.4, 2)),
                      ((-2, 0, -2.1), (2, 2.4, -2)), ((-2, 0, 2), (2, 2.4, 2.1)),
                      # beside, below and above the window
                      ((2, 0, -2), (2.1, 2.4, -0.2)), ((2, 0, 0.2), (2.1, 2.4, 2)), ((2, 0, -0.2), (2.1, 1.3, 0.2)), ((2, 1.7, -0.2), (2.1, 2.4, 0.2))]:
    scene.mesh(*box_mesh(corner, other), wood if other == (2, 0, 2) else wall)
scene.mesh(*box_mesh((0, 0, -0.4), (0.7, 0.8, 0.3)), wood)
scene.sun((-1, -0.7, 0.1), 8)
scene.camera((-1.6, 1.3, 1.6), (0.5, 0.8, 0))
scene.save(Path(sys.argv[1]))
