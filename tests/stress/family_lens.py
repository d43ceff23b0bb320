"""Shutter and lens at their ends: a block that flies through the camera, jumps far away, vanishes.

Room and block shine with radiance 1 and reflect nothing, so each sample of each moment and each point of the lens brings 1.
"""
from scenes import Scene, box_mesh
from session import case

KEYS = [f / 24 for f in range(5)]
MOVES = {
    "through the camera": ("translation", [(0, 0, z) for z in (-1.5, -0.5, 0.5, 1.5, 2.5)], "LINEAR"),
    "jumps far away": ("translation", [(0, 0, -1), (1e6, 0, -1), (0, 0, -1), (0, 1e6, 0), (0, 0, -1)], "LINEAR"),
    "teleports": ("translation", [(0, 0, -1), (0.3, 0, -1), (0, 0.3, -1), (-0.3, 0, -1), (0, 0, -1)], "STEP"),
    "vanishes": ("scale", [(1, 1, 1), (0, 0, 0), (1, 1, 1), (1e-20, 1e-20, 1e-20), (0, 0, 0)], "LINEAR"),
}
LOOKS = {
    "180 degrees": ["--shutter", 180],
    "3600 degrees, f/.5": ["--shutter", 3600, "--f-stop", 0.5, "--focus", 0.4],
    "360 degrees, lens of 1 m, focus at infinity": ["--shutter", 360, "--lens-radius", 1, "--focus", "inf"],
    "focus at 1e-6 m": ["--shutter", 180, "--shutter-open", "begin", "--f-stop", 1, "--focus", 1e-6],
}


def scene_of(s, path, values, interpolation):
    scene = Scene()
    shines = scene.material(0.0, 1.0)
    scene.room((-4, -4, -4), (4, 4, 4), shines)
    block = scene.mesh(*box_mesh((-0.3, -0.3, -0.3), (0.3, 0.3, 0.3)), shines)
    scene.animate(block, path, KEYS, values, interpolation)
    scene.camera((0, 0, 0.5), (0, 0, -1))
    return scene.save(s.path(".gltf"))


def add(move, values):
    @case("lens", f"a block {move}")
    def run(s):
        scene = scene_of(s, *values)
        for look, options in LOOKS.items():
            for frame in (0, 1, 2):
                image = s.render(scene, (16, 9), 16, "--integrator", "path", "--frame", frame, *options)
                green = image.channels["G"]
                s.near(f"{look}, frame {frame}: not finite", 0, len(image.not_finite()), 0)
                s.near(f"{look}, frame {frame}: least and largest radiance", 1, max(green, key=lambda v: abs(v - 1)), 1e-6)


for name, values in MOVES.items():
    add(name, values)
