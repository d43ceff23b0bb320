#!/usr/bin/env python3
"""A ball of rough glass and one of smooth glass in a room with a lamp, a camera that moves by half a metre in 24 frames: writes a scene.

    python3 -B tests/bench/glass_film.py SCENE.glb
    make -f Makefile.example SCENE=SCENE.glb FRAMES=0-23 SIZE=320x180 QUALITY=final OUT=...
"""
import sys

from layered_materials import Scene, ball, walls  # adds tests/support to the path


def main():
    scene = Scene()
    grey, red, blue = (scene.material(c, one_sided=True) for c in (0.6, (0.7, 0.3, 0.2), (0.2, 0.4, 0.7)))
    walls(scene, 1.6, 2, 1.5, grey, left=red, right=blue)
    lamp, y = scene.material(0, 10, one_sided=True), 1.99
    scene.quad((-0.4, y, -0.3), (0.4, y, -0.3), (0.4, y, 0.3), (-0.4, y, 0.3), lamp, name="lamp")
    ball(scene, "rough glass", (-0.55, 0.4, -0.3), 0.4, scene.glass(0.2), rings=64, sectors=128)
    ball(scene, "smooth glass", (0.55, 0.4, -0.3), 0.4, scene.glass(0), rings=64, sectors=128)
    camera = scene.camera((-0.25, 0.9, 1.4), (0, 0.5, -0.5), fov=0.9)
    scene.animate(camera, "translation", [0, 23 / 24], [(-0.25, 0.9, 1.4), (0.25, 0.9, 1.4)])
    scene.save(sys.argv[1])


if __name__ == "__main__":
    main()
