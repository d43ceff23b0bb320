"""Nodes of the file and their keys."""
import numpy

from . import gltf

FEW = 4                  # as many equal instances become one node with EXT_mesh_gpu_instancing


class Nodes:
    """The part of Shot that adds nodes."""

    def node(self, item, places, weights=None, extras=None, **more):
        """A node with its keys; `places` of glTF by frame, not at all frames where the item is not always there."""
        frames, there = list(self.frames()), sorted(places)
        held = [
            places[max([f for f in there if f <= frame], default=there[0])] if frame not in places else places[frame]
            for frame in frames
        ]
        parts = (
            [gltf.decomposed(m) for m in held]
            if len(distinct(dict(enumerate(held)))) > 1
            else [gltf.decomposed(held[0])] * len(held)
        )
        where = numpy.array([p[0] for p in parts])
        turned = numpy.array(gltf.steady([p[1].copy() for p in parts]))
        scale = numpy.array([p[2] for p in parts])
        visible = numpy.array([frame in places for frame in frames])
        node = {"name": item.name, **{k: v for k, v in more.items() if v is not None}}
        for key, rows, rest in (
            ("translation", where, (0, 0, 0)),
            ("rotation", turned, (0, 0, 0, 1)),
            ("scale", scale, (1, 1, 1)),
        ):
            if (abs(rows[0] - rest) > 1e-9).any():
                node[key] = [float(v) for v in rows[0]]
        if extras or item.extras:
            node["extras"] = {**item.extras, **(extras or {})}
        index = self.document.append("nodes", node)
        self.document.json["scenes"][0]["nodes"].append(index)
        times, moved = self.times(frames), False
        for path, rows in (("translation", where), ("rotation", turned)):
            if moves(rows):
                self.document.channel(times, rows, node=index, path=path)
                moved = True
        if not visible.all():
            self.document.channel(self.step_times(frames), scale * visible[:, None], "STEP", node=index, path="scale")
            self.notes.keep("objects that appear or vanish")
        elif moves(scale):
            self.document.channel(times, scale, node=index, path="scale")
            moved = True
        if weights and len(next(iter(weights.values()))):
            rows = numpy.array([weights.get(f, weights[min(weights, key=lambda k: abs(k - f))]) for f in frames])
            self.document.channel(times, rows, node=index, path="weights")
            self.notes.keep("objects that deform")
        if moved:
            self.notes.keep("things that move")
        return index

    def add_groups(self):
        """Instances that stand still: many of one mesh are one node."""
        for (mesh, _, name), found in self.groups.items():
            if len(found) < FEW:
                for item, place in found:
                    self.node(item, {self.first: place, **{f: place for f in self.frames()}}, mesh=mesh)
                continue
            parts = [gltf.decomposed(place) for _, place in found]
            make, attributes = self.document.accessor, {}
            for word, k in (("TRANSLATION", 0), ("ROTATION", 1), ("SCALE", 2)):
                attributes[word] = make(numpy.array([p[k] for p in parts], "f4"))
            self.document.use("EXT_mesh_gpu_instancing")
            node = {
                "name": f"{name} (instances)",
                "mesh": mesh,
                "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}},
            }
            self.document.json["scenes"][0]["nodes"].append(self.document.append("nodes", node))
            self.notes.keep("instances", len(found))


def distinct(places):
    return list({place.tobytes(): place for place in places.values()}.values())


def moves(rows):
    return bool((abs(rows - rows[0]) > 1e-6 * numpy.maximum(1e-3, abs(rows[0]))).any())


def unscaled(matrix):
    """Cameras and lamps have no scale; a mirrored one keeps its view axis."""
    result = matrix.copy()
    scale = numpy.linalg.norm(matrix[:3, :3], axis=0)
    result[:3, :3] = matrix[:3, :3] / numpy.where(scale > 0, scale, 1)
    if numpy.linalg.det(result[:3, :3]) < 0:
        result[:3, 0] *= -1
    return result


def unturned(matrix):
    result = numpy.eye(4)
    result[:3, 3] = matrix[:3, 3]
    return result
