#!/usr/bin/env python3
"""Vertices of animated meshes of a glTF file, worked out from the file alone: a second reader for the test.

    vertices.py FILE ANIMATION    one line per vertex and time: node, primitive, triangle, corner, time, x y z (world)

ANIMATION is the index of the animation to play. Ten corners of each primitive at ten times. Written from the
glTF 2.0 specification; plain Python, nothing shared with the library.
"""
import base64, json, math, os, struct, sys

SIZES = {5120: 'b', 5121: 'B', 5122: 'h', 5123: 'H', 5125: 'I', 5126: 'f'}
COUNTS = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4, 'MAT4': 16}
SCALES = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}


def load(path):
    data = open(path, 'rb').read()
    binary = b''
    if data[:4] == b'glTF':
        size = struct.unpack('<I', data[12:16])[0]
        binary = data[20 + size + 8:]
        data = data[20:20 + size]
    doc = json.loads(data)
    buffers = []
    for buffer in doc['buffers']:
        uri = buffer.get('uri')
        if uri is None:
            buffers.append(binary)
        elif uri.startswith('data:'):
            buffers.append(base64.b64decode(uri.split(',', 1)[1]))
        else:
            buffers.append(open(os.path.join(os.path.dirname(path), uri), 'rb').read())
    return doc, buffers


def elements(doc, buffers, view, offset, component, n, count, normalized):
    view = doc['bufferViews'][view]
    one = struct.Struct('<%d%s' % (n, SIZES[component]))
    start, stride = view.get('byteOffset', 0) + offset, view.get('byteStride', one.size)
    rows = [one.unpack_from(buffers[view['buffer']], start + i * stride) for i in range(count)]
    if normalized:
        rows = [tuple(max(v / SCALES[component], -1.0) for v in row) for row in rows]
    return rows


def accessor(doc, buffers, index):
    a = doc['accessors'][index]
    n, kind = COUNTS[a['type']], a['componentType']
    norm = a.get('normalized', False)
    if 'bufferView' in a:
        rows = elements(doc, buffers, a['bufferView'], a.get('byteOffset', 0), kind, n, a['count'], norm)
    else:
        rows = [(0.0,) * n] * a['count']
    if 'sparse' in a:
        s = a['sparse']
        at = elements(doc, buffers, s['indices']['bufferView'], s['indices'].get('byteOffset', 0),
                      s['indices']['componentType'], 1, s['count'], False)
        new = elements(doc, buffers, s['values']['bufferView'], s['values'].get('byteOffset', 0), kind, n, s['count'], norm)
        for (i,), value in zip(at, new):
            rows[i] = value
    return rows


def mul(a, b):  # column-major 4x4
    return [sum(a[k * 4 + r] * b[c * 4 + k] for k in range(4)) for c in range(4) for r in range(4)]


def trs(t, q, s):
    x, y, z, w = q
    return [(1 - 2 * y * y - 2 * z * z) * s[0], (2 * x * y + 2 * z * w) * s[0], (2 * x * z - 2 * y * w) * s[0], 0,
            (2 * x * y - 2 * z * w) * s[1], (1 - 2 * x * x - 2 * z * z) * s[1], (2 * y * z + 2 * x * w) * s[1], 0,
            (2 * x * z + 2 * y * w) * s[2], (2 * y * z - 2 * x * w) * s[2], (1 - 2 * x * x - 2 * y * y) * s[2], 0,
            t[0], t[1], t[2], 1]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def sample(times, values, how, t, rotation):
    """Appendix C of the specification."""
    spline = how == 'CUBICSPLINE'
    at = lambda k: values[3 * k + 1] if spline else values[k]
    if t <= times[0]:
        return at(0)
    if t >= times[-1]:
        return at(len(times) - 1)
    k = max(i for i in range(len(times)) if times[i] <= t)
    if how == 'STEP':
        return at(k)
    td = times[k + 1] - times[k]
    u = (t - times[k]) / td
    a, b = at(k), at(k + 1)
    if spline:
        out, into = values[3 * k + 2], values[3 * k + 3]
        v = tuple((2 * u**3 - 3 * u**2 + 1) * p + td * (u**3 - 2 * u**2 + u) * m + (-2 * u**3 + 3 * u**2) * q
                  + td * (u**3 - u**2) * n for p, m, q, n in zip(a, out, b, into))
        return unit(v) if rotation else v
    if not rotation:
        return tuple((1 - u) * p + u * q for p, q in zip(a, b))
    a, b = unit(a), unit(b)
    cosine = sum(p * q for p, q in zip(a, b))
    angle = math.acos(min(1.0, abs(cosine)))
    if angle < 1e-6:
        return unit(tuple((1 - u) * p + u * math.copysign(1, cosine) * q for p, q in zip(a, b)))
    return tuple((math.sin(angle * (1 - u)) * p + math.copysign(1, cosine) * math.sin(angle * u) * q) / math.sin(angle)
                 for p, q in zip(a, b))


def main(path, which):
    doc, buffers = load(path)
    animation = doc['animations'][which]
    tracks, end = {}, 0
    for channel in animation['channels']:
        sampler = animation['samplers'][channel['sampler']]
        times = [row[0] for row in accessor(doc, buffers, sampler['input'])]
        values = accessor(doc, buffers, sampler['output'])
        how, key = sampler.get('interpolation', 'LINEAR'), channel['target']['path']
        if key == 'weights':
            n = len(values) // (len(times) * (3 if how == 'CUBICSPLINE' else 1))
            flat = [row[0] for row in values]
            values = [tuple(flat[i:i + n]) for i in range(0, len(flat), n)]
        tracks[channel['target']['node'], key] = (times, values, how)
        end = max(end, times[-1])
    parents = {c: p for p, node in enumerate(doc['nodes']) for c in node.get('children', [])}

    def value(n, key, rest, t):
        return sample(*tracks[n, key], t, key == 'rotation') if (n, key) in tracks else rest

    def world(n, t, known):
        if n not in known:
            node = doc['nodes'][n]
            local = node.get('matrix') or trs(value(n, 'translation', node.get('translation', (0, 0, 0)), t),
                                              unit(value(n, 'rotation', node.get('rotation', (0, 0, 0, 1)), t)),
                                              value(n, 'scale', node.get('scale', (1, 1, 1)), t))
            known[n] = mul(world(parents[n], t, known), local) if n in parents else local
        return known[n]

    cache = {}
    def get(index):
        if index not in cache:
            cache[index] = accessor(doc, buffers, index)
        return cache[index]

    for step in range(10):
        t = round(end * 24 * step / 9) / 24  # a frame
        known = {}
        for n, node in enumerate(doc['nodes']):
            if 'mesh' not in node:
                continue
            mesh = doc['meshes'][node['mesh']]
            joints = None
            if 'skin' in node:
                skin = doc['skins'][node['skin']]
                bind = get(skin['inverseBindMatrices']) if 'inverseBindMatrices' in skin else None
                joints = [mul(world(j, t, known), bind[i]) if bind else world(j, t, known) for i, j in enumerate(skin['joints'])]
            for p, primitive in enumerate(mesh['primitives']):
                attributes = primitive['attributes']
                positions = get(attributes['POSITION'])
                targets = primitive.get('targets', [])
                weights = value(n, 'weights', node.get('weights', mesh.get('weights', [0] * len(targets))), t)
                order = [row[0] for row in get(primitive['indices'])] if 'indices' in primitive else range(len(positions))
                for i in range(0, len(order), max(1, len(order) // 10)):
                    v = order[i]
                    pos = list(positions[v])
                    for target, weight in zip(targets, weights):
                        if 'POSITION' in target:
                            pos = [a + weight * b for a, b in zip(pos, get(target['POSITION'])[v])]
                    m = world(n, t, known)
                    if joints and 'JOINTS_0' in attributes:
                        shares = [(j, w) for s in range(9) if 'JOINTS_%d' % s in attributes for j, w in
                                  zip(get(attributes['JOINTS_%d' % s])[v], get(attributes['WEIGHTS_%d' % s])[v])]
                        total = sum(w for _, w in shares)
                        m = [sum(w / total * joints[j][k] for j, w in shares if w) for k in range(16)]
                    x = [m[r] * pos[0] + m[4 + r] * pos[1] + m[8 + r] * pos[2] + m[12 + r] for r in range(3)]
                    print(n, p, i // 3, i % 3, repr(t), *map(repr, x))


if __name__ == '__main__':
    main(sys.argv[1], int(sys.argv[2]))
