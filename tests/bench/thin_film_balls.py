#!/usr/bin/env python3
"""Balls with thin films for a look: writes a scene.

    python3 tests/bench/thin_film_balls.py SCENE.gltf

Columns are the film's thickness, 100 to 1000 nm. Rows from above: a film of index 1.33 on black plastic, of index 1.8
on black plastic, of index 1.33 on steel, the same on rough steel, and a texture of the thickness, 100 nm below to
1000 nm above, on black plastic.
"""
import base64
import sys
from pathlib import Path

import layered_materials

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from open_scenes import Scene, png  # noqa: E402

ROWS = [(1.33, 0, 0.1), (1.8, 0, 0.1), (1.33, 1, 0.1), (1.33, 1, 0.5), (1.8, 0, 0.1)]
THICKNESSES = [100, 200, 300, 400, 500, 700, 1000]


def main():
    scene = Scene()
    ramp = png(64, lambda x, y: [0, 255 - 4 * y, 0])
    scene._append("images", {"uri": "data:image/png;base64," + base64.b64encode(ramp).decode()})
    scene._append("textures", {"source": 0})
    for row, (index, metallic, roughness) in enumerate(ROWS):
        for column, thickness in enumerate(THICKNESSES):
            film = {"iridescenceFactor": 1, "iridescenceIor": index, "iridescenceThicknessMaximum": thickness}
            if row == len(ROWS) - 1:
                film |= {"iridescenceThicknessTexture": {"index": 0}, "iridescenceThicknessMaximum": 1000}
            colour = 0.56 if metallic else 0.02
            material = scene._append("materials", {
                "pbrMetallicRoughness": {"baseColorFactor": [colour] * 3 + [1], "metallicFactor": metallic,
                                         "roughnessFactor": roughness},
                "extensions": {"KHR_materials_iridescence": film}})
            layered_materials.ball(scene, f"ball {row} {column}", (column - 3, 2 - row, 0), 0.45, material)
    scene.extensions.add("KHR_materials_iridescence")
    scene.camera((0, 0, 9), (0, 0, 0), fov=0.62)
    scene.save(sys.argv[1])


if __name__ == "__main__":
    main()
