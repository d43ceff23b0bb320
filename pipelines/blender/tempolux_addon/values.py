"""Values of shader nodes: constants, or expressions of sockets that can be baked. Follows links through groups, reroutes, muted nodes."""

import math


class Source:
    """An output of a node, inside of the group nodes `stack`."""

    def __init__(self, node, socket, stack):
        self.node, self.socket, self.stack = node, socket, stack

    def key(self):
        return tuple(n.name for n in self.stack), self.node.name, self.socket.identifier

    def __eq__(self, other):
        return isinstance(other, Source) and self.key() == other.key()

    def __hash__(self):
        return hash(self.key())


class Blend:
    """a where factor is 0, b where it is 1."""

    def __init__(self, factor, a, b):
        self.factor, self.a, self.b = factor, a, b


class Times:
    def __init__(self, a, b):
        self.a, self.b = a, b


def is_constant(value):
    return isinstance(value, (int, float, tuple))


def as_tuple(value):
    return value if isinstance(value, tuple) else (float(value),) * 3


def as_number(value):
    return .2126 * value[0] + .7152 * value[1] + .0722 * value[2] if isinstance(value, tuple) else float(value)


def blend(factor, a, b):
    if is_constant(factor):
        t = min(1.0, max(0.0, as_number(factor)))
        if t == 0 or t == 1:
            return b if t else a
        if is_constant(a) and is_constant(b):
            if isinstance(a, tuple) or isinstance(b, tuple):
                return tuple(x * (1 - t) + y * t for x, y in zip(as_tuple(a), as_tuple(b)))
            return a * (1 - t) + b * t
        factor = t
    return a if a is b or is_constant(a) and is_constant(b) and a == b else Blend(factor, a, b)


def times(a, b):
    if is_constant(a) and is_constant(b):
        if isinstance(a, tuple) or isinstance(b, tuple):
            return tuple(x * y for x, y in zip(as_tuple(a), as_tuple(b)))
        return a * b
    if is_constant(b) and not isinstance(b, tuple) and b == 1:
        return a
    if is_constant(a) and not isinstance(a, tuple) and a == 1:
        return b
    return Times(a, b)


def sources(value):
    """All sources of an expression."""
    if isinstance(value, Source):
        return [value]
    if isinstance(value, Blend):
        return sources(value.factor) + sources(value.a) + sources(value.b)
    return sources(value.a) + sources(value.b) if isinstance(value, Times) else []


# ---- links ---------------------------------------------------------------------------------------------------

def finite(value):
    return float(value) if math.isfinite(value) else 0.0


def plain(socket):
    """The value that an input has without a link."""
    value = getattr(socket, "default_value", 0.0)
    if isinstance(value, (int, float)):
        return finite(value)
    try:
        return tuple(finite(v) for v in value)[:3]
    except TypeError:
        return 0.0


def pick(sockets, *names):
    """The first of these sockets that a node has; None without."""
    return next((s for name in names for s in sockets if s.name == name and s.enabled), None)


def group_output(tree):
    outputs = [n for n in tree.nodes if n.type == "GROUP_OUTPUT"]
    if not outputs:
        raise ValueError(f"the node group {tree.name} has no output")
    return next((n for n in outputs if n.is_active_output), outputs[0])


def by_identifier(sockets, identifier):
    return next((s for s in sockets if s.identifier == identifier), None)


def follow(socket, stack):
    """(socket, node, output, stack) of what an input gets; node None where it has its plain value."""
    for _ in range(1000):
        links = [link for link in socket.links if link.is_valid and not link.is_muted] if socket.is_linked else []
        if not links:
            return socket, None, None, stack
        node, output = links[0].from_node, links[0].from_socket
        if node.mute:
            inner = next((link.from_socket for link in node.internal_links if link.to_socket == output), None)
            if inner is None:
                return socket, None, None, stack
            socket = inner
        elif node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "GROUP" and node.node_tree:
            inner = by_identifier(group_output(node.node_tree).inputs, output.identifier)
            if inner is None:
                return socket, None, None, stack
            socket, stack = inner, (*stack, node)
        elif node.type == "GROUP_INPUT" and stack:
            outer = by_identifier(stack[-1].inputs, output.identifier)
            if outer is None:
                return socket, None, None, stack
            socket, stack = outer, stack[:-1]
        else:
            return socket, node, output, stack
    raise ValueError("its nodes go in a circle")


def resolve(socket, stack=()):
    """The value of an input: a number, three numbers, or a Source."""
    if socket is None:
        return 0.0
    socket, node, output, stack = follow(socket, stack)
    if node is None:
        return plain(socket)
    if node.type in ("RGB", "VALUE"):
        return plain(node.outputs[0])
    return Source(node, output, stack)
