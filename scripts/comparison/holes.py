"""Holes in surfaces with a formula: twenty between three sides (ANALYTIC, FURTHER), and such of more sides (many_sided).

Every case is a `Hole`: four rings of triangles around an open hole with n edges a side (case `irregular`: 40/10/5 at n = 16).
Sides run from corner 0 to 1, 1 to 2 and so on, in the direction in which new faces traverse the rim.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

RINGS = 4


@dataclass
class Hole:
    """A mesh with a hole, and all that is known of the surface that was there."""

    name: str
    vertices: np.ndarray  # (n, 3) of the surroundings
    faces: np.ndarray  # (m, 3)
    rim: np.ndarray  # vertex indices, in the direction of new faces
    normals: np.ndarray | None = None  # (n, 3) true unit normals of the vertices; None: the surface has edges or facets
    nearest: Callable | None = None  # (k, 3) -> nearest points of the true surface; None: no truth inside
    distance: Callable | None = None  # (k, 3) -> distances (k,) to it, if `nearest` is not known
    facets: Callable | None = None  # (k, 3) -> unit normals of the truth's facets that are nearest, if it is a mesh
    off: float = 0.0  # how far the mesh itself is from that truth, root mean square along the rim
    beyond: np.ndarray | None = None  # (k, 3) unit normals of the truth's facets inside along the edges of the rim
    strip: Callable | None = None  # (i, s, d) -> points and normals at a distance d, in its own measure, outside side i
    counts: tuple = ()  # edges of the sides, where they are known
    group: str = ""  # the set that it belongs to
    mesh: str = ""  # the mesh that it was cut out of

    def __post_init__(self) -> None:
        if self.nearest and not self.distance:
            nearest = self.nearest
            self.distance = lambda points: np.linalg.norm(nearest(points) - points, axis=1)

    @property
    def diameter(self) -> float:
        rim = self.vertices[self.rim]
        return float(np.linalg.norm(rim[:, None] - rim[None], axis=-1).max())


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


# ------------------------------------------------------------------------------------------------------- meshing the strips


def _mesh(name, counts, strip, step, *, gap=False, spacing=lambda i, t: t, nearest=None) -> Hole:
    """The surroundings as three strips.

    strip(i, s, d) -> points and true normals at distance d (in its own measure) outside side i, in rings of `step`. gap: the
    strips leave each other at the corners, and a flat quadrant joins them; else they share their ends.
    """
    points, normals, names, faces = [], [], {}, []

    def vertex(key, point, normal):
        if key not in names:
            names[key] = len(points)
            points.append(point)
            normals.append(normal)
        return names[key]

    grids = []
    for i, m in enumerate(counts):
        s = spacing(i, np.arange(m + 1) / m)
        rows = [strip(i, s, np.full(m + 1, j * step)) for j in range(RINGS + 1)]
        grid = np.empty((m + 1, RINGS + 1), int)
        for k in range(m + 1):
            for j in range(RINGS + 1):
                corner = (i + (k == m)) % len(counts)
                shared = k in (0, m) and (j == 0 or not gap)
                grid[k, j] = vertex(("corner", corner, j) if shared else ("side", i, k, j), rows[j][0][k], rows[j][1][k])
        for k in range(m):
            middle = strip(i, np.array([(s[k] + s[k + 1]) / 2]), np.array([RINGS * step]))
            for j in range(RINGS):
                a, b, c, d = grid[k, j], grid[k + 1, j], grid[k + 1, j + 1], grid[k, j + 1]
                if j < RINGS - 1:
                    faces += [(b, a, c), (a, d, c)]
                else:  # the outer border has edges half as long
                    e = vertex(("outer", i, k), middle[0][0], middle[1][0])
                    faces += [(b, a, e), (c, b, e), (a, d, e)]
        grids.append(grid)
    if gap:
        for i in range(3):
            here, there = grids[i][-1], grids[(i + 1) % 3][0]
            quadrant = np.empty((RINGS + 1, RINGS + 1), int)
            for a in range(RINGS + 1):
                for b in range(RINGS + 1):
                    if b == 0 or a == 0:
                        quadrant[a, b] = here[a] if b == 0 else there[b]
                    else:
                        point = points[here[a]] + points[there[b]] - points[here[0]]
                        quadrant[a, b] = vertex(("quadrant", i, a, b), point, normals[here[0]])
            for a in range(RINGS):
                for b in range(RINGS):
                    p, q, r, t = quadrant[a, b], quadrant[a + 1, b], quadrant[a, b + 1], quadrant[a + 1, b + 1]
                    faces += [(p, q, r), (r, q, t)]
    rim = np.concatenate([grid[:-1, 0] for grid in grids])
    known = {"strip": strip, "counts": tuple(counts)}
    return Hole(name, np.array(points), np.array(faces), rim, np.array(normals), nearest, **known)


# ------------------------------------------------------------------------------------------- holes in one parametric surface


def _with_derivatives(surface, u, v, step=1e-20):
    """Complex step: exact derivatives of a real analytic surface."""
    return surface(u, v).real, surface(u + 1j * step, v).imag / step, surface(u, v + 1j * step).imag / step


def _nearest_on(surface, guess):
    """Nearest points by damped Gauss-Newton from guess(points) -> u, v."""

    def nearest(points):
        u, v = guess(points)
        left = np.arange(len(points))  # those that still move
        for _ in range(60):
            to, a, b = points[left], u[left], v[left]
            at, du, dv = _with_derivatives(surface, a, b)
            away = to - at
            uu, uv, vv = (du * du).sum(1), (du * dv).sum(1), (dv * dv).sum(1)
            p, q = (du * away).sum(1), (dv * away).sum(1)
            det = np.maximum(uu * vv - uv * uv, 1e-30)
            step_u, step_v = (vv * p - uv * q) / det, (uu * q - uv * p) / det
            damping, best = np.ones(len(left)), (away * away).sum(1)
            for _ in range(8):
                worse = ((to - surface(a + damping * step_u, b + damping * step_v).real) ** 2).sum(1) > best
                if not worse.any():
                    break
                damping[worse] /= 2
            damping[worse] = 0
            u[left], v[left] = a + damping * step_u, b + damping * step_v
            left = left[damping * np.hypot(step_u, step_v) > 1e-15]
            if not len(left):
                break
        return surface(u, v).real

    return nearest


def _in_chart(name, n, surface, corners, nearest, *, counts=None, step, along=None, **options) -> Hole:
    """A triangle, or another polygon, of the parameter plane; its sides straight there, or along(i, s) -> (u, v)."""
    corners = np.array(corners, float)
    along = along or (lambda i, s: corners[i] + (corners[(i + 1) % len(corners)] - corners[i]) * s[:, None])

    def strip(i, s, d):
        center = corners.mean(0)
        at = (center + (along(i, s) - center) * (1 + d)[:, None]).T
        _, du, dv = _with_derivatives(surface, *at.real)
        return surface(*at), unit(np.cross(du, dv))

    return _mesh(name, counts or (n,) * len(corners), strip, step, nearest=nearest, **options)


def _stack(*components):
    return np.stack(np.broadcast_arrays(*components), -1)


def _on_sphere(name, n, corners) -> Hole:
    """Great-circle sides, uniform in arc length; the chart is the central projection."""
    corners = unit(np.array(corners, float))
    z = unit(corners.sum(0))
    x = unit(np.cross([0.3, -0.2, 1.0], z))
    y = np.cross(z, x)

    def surface(u, v):
        p = z + np.asarray(u)[..., None] * x + np.asarray(v)[..., None] * y
        return p / np.sqrt((p * p).sum(-1))[..., None]

    def chart(p):
        return np.stack([p @ x, p @ y], -1) / (p @ z)[..., None]

    def along(i, s):
        a, b = corners[i], corners[(i + 1) % 3]
        angle = np.arccos(a @ b)
        return chart((np.sin((1 - s) * angle)[:, None] * a + np.sin(s * angle)[:, None] * b) / np.sin(angle))

    return _in_chart(name, n, surface, chart(corners), unit, step=2 / n, along=along)


def sphere(n):
    """An octant of the unit sphere."""
    return _on_sphere("sphere", n, np.eye(3))


def sphere10(n):
    """A triangle of 10 degrees of the unit sphere."""
    polar, turn = np.radians(10) / np.sqrt(3), 2 * np.pi * np.arange(3) / 3
    return _on_sphere("sphere10", n, _stack(np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)))


def torus(n):
    """Radii 2 and 0.8, crossing from positive to negative curvature."""

    def surface(u, v):
        return _stack((2 + 0.8 * np.cos(v)) * np.cos(u), (2 + 0.8 * np.cos(v)) * np.sin(u), 0.8 * np.sin(v))

    def nearest(points):
        circle = 2 * unit(points * [1, 1, 0])
        return circle + 0.8 * unit(points - circle)

    return _in_chart("torus", n, surface, [(-0.5, -0.6), (0.9, 0.1), (-0.1, 1.9)], nearest, step=1.5 / n)


def saddle(n):
    """z = x^2 - y^2."""

    def surface(u, v):
        return _stack(u, v, u * u - v * v)

    turn = 2 * np.pi * np.arange(3) / 3 + 0.4
    corners = 0.8 * np.stack([np.cos(turn), np.sin(turn)], 1)
    return _in_chart("saddle", n, surface, corners, _nearest_on(surface, lambda p: p[:, :2].T.copy()), step=2 / n)


def _franke(x, y):
    """The graph of Franke's first function."""
    z = 0.75 * np.exp(-((9 * x - 2) ** 2 + (9 * y - 2) ** 2) / 4)
    z = z + 0.75 * np.exp(-((9 * x + 1) ** 2) / 49 - (9 * y + 1) / 10)
    z = z + 0.5 * np.exp(-((9 * x - 7) ** 2 + (9 * y - 3) ** 2) / 4)
    return _stack(x, y, z - 0.2 * np.exp(-((9 * x - 4) ** 2) - (9 * y - 7) ** 2))


def franke(n):
    """A hole as large as the hills of Franke's first function, which the rim cannot know."""
    nearest = _nearest_on(_franke, lambda p: p[:, :2].T.copy())
    return _in_chart("franke", n, _franke, [(0.1, 0.1), (0.9, 0.15), (0.35, 0.9)], nearest, step=1 / n)


def irregular(n):
    """A twisted helicoid with 40/10/5 edges (at n = 16) of graded length."""

    def surface(u, v):
        return _stack(u, v * np.cos(1.2 * u), v * np.sin(1.2 * u))

    def guess(p):
        return p[:, 0].copy(), p[:, 1] * np.cos(1.2 * p[:, 0]) + p[:, 2] * np.sin(1.2 * p[:, 0])

    return _in_chart(
        "irregular",
        n,
        surface,
        [(0, -0.5), (4.0, -0.2), (1.2, 1.0)],
        _nearest_on(surface, guess),
        counts=tuple(max(2, round(edges * n / 16)) for edges in (40, 10, 5)),
        spacing=lambda i, t: t ** (1.6, 1, 0.7)[i],
        step=1 / n,
    )


# ----------------------------------------------------------------------------------------------------------------- further ones


def _further(name, n, surface, corners) -> Hole:
    """A hole whose nearest points start from those of a fine grid of the chart."""
    corners = np.array(corners, float)
    low, high = corners.min(0), corners.max(0)
    reach = 0.2 * (high - low)
    u, v = (a.ravel() for a in np.meshgrid(*np.linspace(low - reach, high + reach, 200).T))
    tree = cKDTree(surface(u, v))

    def guess(points):
        k = tree.query(points)[1]
        return u[k], v[k]

    return _in_chart(name, n, surface, corners, _nearest_on(surface, guess), step=1.5 / n)


def _turned(size, middle=(0, 0)):
    turn = 2 * np.pi * np.arange(3) / 3 + 0.4
    return size * np.stack([np.cos(turn), np.sin(turn)], 1) + middle


def _ellipsoid(a, b, c):
    return lambda u, v: _stack(a * np.sin(v) * np.cos(u), b * np.sin(v) * np.sin(u), c * np.cos(v))


def _wavy(u, v):
    """A sphere with six waves of other directions, phases and heights."""
    rng = np.random.default_rng(1)
    waves, phases, heights = 1.6 * rng.normal(size=(6, 3)), rng.uniform(0, 2 * np.pi, 6), 0.125 * rng.normal(size=6)
    at = _ellipsoid(1, 1, 1)(u, v)
    return at * (1 + (heights * np.sin(at @ waves.T + phases)).sum(-1))[..., None]


def _bent(u, v):
    """A tube whose radius varies along an arc that rises."""
    radius = 0.5 + 0.1 * np.sin(1.3 * u)
    across = 2 + radius * np.cos(v)
    return _stack(across * np.sin(0.7 * u), radius * np.sin(v) + 0.1 * u * u, across * np.cos(0.7 * u))


#: name -> (surface, corners in its chart)
_FURTHER = {
    "ellipsoid": (_ellipsoid(1, 1.5, 0.7), [(0, 0.8), (1.2, 0.9), (0.5, 1.9)]),
    "ellipsoid2": (_ellipsoid(1, 0.5, 2), [(0.2, 0.5), (1.3, 1.2), (-0.2, 1.5)]),
    "cone": (lambda u, v: _stack(v * np.cos(u), v * np.sin(u), 1.3 * v), [(0, 0.6), (1.3, 0.9), (0.5, 1.8)]),
    "monkey_saddle": (lambda x, y: _stack(x, y, x**3 - 3 * x * y * y), _turned(0.7)),
    "hill": (lambda x, y: _stack(x, y, np.exp(-2 * ((x - 0.1) ** 2 + (y + 0.1) ** 2))), _turned(0.7, (0.3, 0))),
    "wavy_sphere": (_wavy, [(1.3, 1.0), (2.1, 1.2), (1.5, 1.9)]),
    "waves": (lambda x, y: _stack(x, y, 0.25 * np.sin(2 * x + 0.5) * np.cos(1.7 * y - 0.3)), _turned(0.8)),
    "bent_tube": (_bent, [(0, -0.4), (1.0, 0.2), (0.3, 1.3)]),
    "paraboloid": (lambda x, y: _stack(x, y, 0.8 * x * x - 0.5 * x * y - 0.4 * y * y), _turned(0.9, (0.3, 0.1))),
    "franke_small": (_franke, [(0.15, 0.15), (0.55, 0.2), (0.3, 0.6)]),
}
FURTHER = {name: functools.partial(lambda n, name: _further(name, n, *_FURTHER[name]), name=name) for name in _FURTHER}


# ------------------------------------------------------------------------------------------------------------- many sides


def _egg(u, v):
    """Of revolution about z, blunt above and pointed below."""
    radius = 0.8 * np.sin(v) * (1 + 0.25 * np.cos(v))
    return _stack(radius * np.cos(u), radius * np.sin(u), 1.2 * np.cos(v))


def _stereographic(u, v):
    square = u * u + v * v
    return _stack(2 * u, 2 * v, 1 - square) / (1 + square)[..., None]


#: surface -> (its chart, middle and radius of the polygon there)
_MANY_SIDED = {
    "sphere": (_stereographic, (0.1, 0.05), 0.5),
    "torus": (
        lambda u, v: _stack((2 + 0.8 * np.cos(v)) * np.cos(u), (2 + 0.8 * np.cos(v)) * np.sin(u), 0.8 * np.sin(v)),
        (0, 0.8),
        0.7,
    ),
    "saddle": (lambda u, v: _stack(u, v, u * u - v * v), (0.1, 0), 0.7),
    "egg": (_egg, (0.4, 1.2), 0.7),
}
MANY_SIDED = tuple(_MANY_SIDED)


def many_sided(name, sides, n, regular=True) -> Hole:
    """A hole between straight lines of a chart, n edges a side; an irregular one has corners that are turned and moved by a
    quarter, and edges of about one length."""
    surface, middle, radius = _MANY_SIDED[name]
    rng = np.random.default_rng(sides)
    turn, far = (0, 1) if regular else (rng.uniform(-0.25, 0.25, sides), rng.uniform(0.8, 1.2, sides))
    angle = 2 * np.pi * (np.arange(sides) + turn) / sides + 0.4
    corners = np.array(middle) + radius * (far * _stack(np.cos(angle), np.sin(angle)).T).T
    lengths = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    counts = tuple(np.maximum(2, np.rint(n * lengths / lengths.mean()).astype(int)).tolist())
    low, high = corners.min(0) - 0.2, corners.max(0) + 0.2
    u, v = (a.ravel() for a in np.meshgrid(*np.linspace(low, high, 200).T))
    tree = cKDTree(surface(u, v))

    def guess(points):
        k = tree.query(points)[1]
        return u[k], v[k]

    return _in_chart(name, n, surface, corners, _nearest_on(surface, guess), counts=counts, step=1.5 / n)


# ------------------------------------------------------------------------------------- holes between surfaces of their own


def _fillets(name, n, radii, nearest=None) -> Hole:
    """Three cylinders of these radii along the edges of a cube meet at its corner.

    The fillet along axis a starts tangent to one plane of the cube and ends tangent to another; the hole's corners lie where two
    fillets end on the same plane.
    """
    r = np.array(radii, float)
    order = [(0, 2, 1), (2, 1, 0), (1, 0, 2)]  # axis, plane at the start, plane at the end

    def strip(i, s, d):
        axis, start, end = order[i]
        angle = s * np.pi / 2
        at, normal = np.zeros((len(s), 3)), np.zeros((len(s), 3))
        at[:, end], at[:, start] = r[axis] * (1 - np.sin(angle)), r[axis] * (1 - np.cos(angle))
        at[:, axis] = r[end] + (r[start] - r[end]) * s * s * (3 - 2 * s)
        normal[:, end], normal[:, start] = -np.sin(angle), -np.cos(angle)
        return at + d[:, None] * np.eye(3)[axis], normal

    return _mesh(name, (n, n, n), strip, 1.3 * r.mean() / n, gap=True, nearest=nearest)


def suitcase(n):
    """Three fillets of radius 1: the corner is a sphere octant."""
    return _fillets("suitcase", n, (1, 1, 1), lambda points: 1 + unit(points - 1))


def fillets3(n):
    """Fillets of radius 1, 0.7 and 0.5."""
    return _fillets("fillets3", n, (1, 0.7, 0.5))


def bezier3(n):
    """Three bicubic Bezier patches whose planes agree at the corners only."""
    turn = 2 * np.pi * np.arange(3) / 3
    corners = _stack(np.cos(turn), np.sin(turn), np.array([0, 0.25, -0.1]))
    normals = unit(np.array([[-0.35, 0.15, 1], [0.3, 0.25, 1], [-0.1, -0.45, 1]]))
    outward = corners - corners.mean(0)
    outward = 1.2 * unit(outward - (outward * normals).sum(1)[:, None] * normals)
    shared = []  # the curve between neighboring patches at each corner
    for p, normal, o, bump in zip(corners, normals, outward, (0.25, -0.15, 0.1)):
        second = p + 2 * o / 3 - 0.15 * normal
        shared.append(np.array([p, p + o / 3, second, second + o / 3 + bump * normal]))
    nets = []
    for i, tilts in enumerate([(0.35, 0.10), (-0.30, 0.05), (0.05, -0.40)]):
        a, b = i, (i + 1) % 3
        chord = corners[b] - corners[a]

        def tangent(k, chord=chord):
            return unit(chord - (chord @ normals[k]) * normals[k]) * np.linalg.norm(chord) / 3

        net = np.zeros((4, 4, 3))
        net[0] = corners[a], corners[a] + tangent(a), corners[b] - tangent(b), corners[b]
        net[:, 0], net[:, 3] = shared[a], shared[b]
        out = 1.2 * unit(np.array([chord[1], -chord[0], 0])) / 3
        for k, tilt in zip((1, 2), tilts):
            for row, height in zip((1, 2, 3), (0.5, -0.3, 0.2)):
                net[row, k] = net[row - 1, k] + out + [0, 0, tilt * height]
        nets.append(net)

    def bernstein(t):
        return np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3], -1)

    def slope(t):
        return 3 * np.stack([-((1 - t) ** 2), (1 - t) * (1 - 3 * t), t * (2 - 3 * t), t * t], -1)

    def strip(i, s, d):
        at, across, along = (
            np.einsum("ka,kb,abx->kx", of_d(d), of_s(s), nets[i])
            for of_d, of_s in ((bernstein, bernstein), (slope, bernstein), (bernstein, slope))
        )
        return at, unit(np.cross(across, along).real)

    return _mesh("bezier3", (n, n, n), strip, min(1.5 / n, 0.24))


ANALYTIC = {f.__name__: f for f in (sphere, sphere10, torus, saddle, franke, suitcase, fillets3, bezier3, irregular)}
