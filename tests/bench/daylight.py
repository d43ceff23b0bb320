"""Furnished rooms by others, lit through their windows alone: lamps removed, sun and sky, or a window of paper."""
from pathlib import Path

from furnish import Asset

SKY = ("--environment", "0.5,0.7,1")     # W/m^2/sr
SUN = 20                                       # W/m^2 across its direction


def without_lamps(asset):
    for material in asset.gltf["materials"]:
        material.pop("emissiveFactor", None)
        material.pop("emissiveTexture", None)
    for node in asset.gltf["nodes"]:
        node.pop("extensions", None)
    return asset


def darker(asset, factor):
    """All that is reflected times `factor`."""
    for material in asset.gltf["materials"]:
        surface = material.setdefault("pbrMetallicRoughness", {})
        r, g, b, a = surface.get("baseColorFactor", (1, 1, 1, 1))
        surface["baseColorFactor"] = [r * factor, g * factor, b * factor, a]
    return asset


def sunny(asset, direction):
    asset.sun(direction)
    asset.gltf["extensions"]["KHR_lights_punctual"]["lights"][-1]["intensity"] = SUN
    return asset


def paper(asset, corners):
    """A window of paper that the day shines through: so much radiance everywhere on it, and dark walls that send little on."""
    darker(asset, 0.04).quad("Paper", corners, {"emissiveFactor": [1, 0.95, 0.85], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}})
    return asset


S8, EVENING = "made/S8_window_room.glb", "found/gltf/interiors/evening_shot.glb"
ROOMS = {                 # name: (file, frame, sky, change)
    "S8-day": (S8, 17, SKY, lambda room: sunny(room, (-0.8, -0.55, 0.25))),
    "S8-overcast": (S8, 17, SKY, lambda room: room),
    "evening-day": (EVENING, 10, SKY, lambda room: sunny(room, (0.75, -0.6, -0.25))),
    "S8-paper": (S8, 17, (), lambda room: paper(room, [(3.05, 0.8, 1.2), (3.05, 2.3, 1.2), (3.05, 2.3, -1.2), (3.05, 0.8, -1.2)])),
}


def make(shared, folder, wanted):
    """{name: (file, frame, options)} of the wanted rooms whose originals are there."""
    folder.mkdir(parents=True, exist_ok=True)
    made = {}
    for name, (file, frame, sky, change) in ROOMS.items():
        if not wanted(name) or not shared or not (shared / file).exists():
            continue
        room = change(without_lamps(Asset(shared / file)))
        room.path = Path(folder / f"{name}.glb")
        made[name] = (room.save(), frame, sky)
    return made
