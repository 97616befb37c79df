"""Holes whose truth is known: regions cut out of irregular triangles of surfaces with a formula. Any seed makes other ones."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import tripatch
from scipy.spatial import Delaunay, cKDTree

#: Errors below this share of a hole's diameter look the same: they count as this.
NEGLIGIBLE = 1e-5
#: Kinds of holes: their names and numbers of smooth sides; 0: round, -1: jagged.
KINDS = {"3 sides": 3, "4 sides": 4, "5 sides": 5, "6 sides": 6, "round": 0, "jagged": -1}
EXTENT = 1.1  # parameters reach from -EXTENT to EXTENT


@dataclass(frozen=True)
class Surface:
    """place: of parameters (n, 2); distance: of points (n, 3) to it."""

    place: Callable[[np.ndarray], np.ndarray]
    distance: Callable[[np.ndarray], np.ndarray]


def graph(height: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Surface:
    """Over the plane. The distance is the height over it, times the cosine of the slope: right to its square."""

    def distance(p):
        x, y, step = p[:, 0], p[:, 1], 1e-20
        slopes = [np.imag(height(x + 1j * step, y + 0j)) / step, np.imag(height(x + 0j, y + 1j * step)) / step]
        return np.abs(p[:, 2] - np.real(height(x, y))) / np.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)

    return Surface(lambda q: np.column_stack([q, np.real(height(q[:, 0], q[:, 1]))]), distance)


def sphere_at(q):
    u, v = q.T
    return np.column_stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)])


def torus_at(q):
    u, v = q.T
    return np.column_stack([(2 + 0.7 * np.cos(v)) * np.cos(u), (2 + 0.7 * np.cos(v)) * np.sin(u), 0.7 * np.sin(v)])


SURFACES = {
    "sphere": Surface(sphere_at, lambda p: np.abs(np.linalg.norm(p, axis=1) - 1)),
    "torus": Surface(torus_at, lambda p: np.abs(np.hypot(np.hypot(p[:, 0], p[:, 1]) - 2, p[:, 2]) - 0.7)),
    "cylinder": Surface(
        lambda q: np.column_stack([np.cos(q[:, 0]), np.sin(q[:, 0]), q[:, 1]]),
        lambda p: np.abs(np.hypot(p[:, 0], p[:, 1]) - 1),
    ),
    "saddle": graph(lambda x, y: 0.5 * (x * x - y * y)),
    "wave": graph(lambda x, y: 0.15 * np.sin(3 * x + 1) * np.cos(2.5 * y)),
    "hill": graph(lambda x, y: 0.5 * np.exp(-1.2 * (x * x + y * y))),
    "cubic": graph(lambda x, y: 0.3 * x**3 - 0.4 * x * y * y + 0.2 * x * y),
    "ripple": graph(lambda x, y: 0.06 * np.cos(4 * x) + 0.08 * np.sin(3 * y + x)),
}


@dataclass(frozen=True)
class KnownHole:
    """A mesh around a hole, and the surface that was there."""

    name: str
    kind: str
    surface: Surface
    vertices: np.ndarray
    faces: np.ndarray
    rim: list[int]

    @property
    def diameter(self) -> float:
        points = self.vertices[self.rim]
        return float(np.linalg.norm(points[:, None] - points[None], axis=-1).max())

    def error(self, fill: tripatch.Fill) -> float:
        """Root mean square distance of the new vertices from the surface, over the hole's diameter."""
        off = self.surface.distance(fill.vertices)
        return float(np.sqrt(np.mean(off**2))) / self.diameter

    def fills(self) -> dict[str, tripatch.Fill]:
        """The fill of `auto`, and every candidate by the name of its method."""
        methods = ["auto", "polyharmonic_spline"]
        methods += ["side_vertex" if self.kind == "3 sides" else "multi_sided"] * (self.kind != "jagged")
        made = {}
        for method in methods:
            try:
                fill = tripatch.fill(self.vertices, self.faces, rim=self.rim, method=method)
            except tripatch.Refusal:
                continue
            if len(fill.vertices):
                made[method] = fill
        return made


def outline(sides: int, spacing: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the region in parameters, and the vertices along its border."""
    if sides == 0:
        t = 2 * np.pi * np.arange(max(8, int(3.3 / spacing))) / max(8, int(3.3 / spacing))
        ring = np.column_stack([0.55 * np.cos(t), 0.45 * np.sin(t)])
        return ring, ring
    n = sides if sides > 0 else 5
    t = rng.uniform(0, 2 * np.pi) + 2 * np.pi * np.arange(n) / n + rng.uniform(-0.25, 0.25, n)
    corners = 0.55 * rng.uniform(0.75, 1.15, (n, 1)) * np.column_stack([np.cos(t), np.sin(t)])
    pieces = []
    for a, b in zip(corners, np.roll(corners, -1, 0), strict=True):
        m = max(2, round(float(np.linalg.norm(b - a)) / spacing))
        pieces.append(a + (b - a) * (np.arange(m) / m)[:, None])
    return corners, np.concatenate(pieces)


def inside(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    within = np.zeros(len(points), bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, 0), strict=True):
        x = (bx - ax) * (points[:, 1] - ay) / (by - ay + 1e-300) + ax
        within ^= ((ay > points[:, 1]) != (by > points[:, 1])) & (points[:, 0] < x)
    return within


def scattered(spacing: float, rng: np.random.Generator) -> np.ndarray:
    """Points of a grid of equal triangles, moved at random by up to a third of its edges."""
    row = np.arange(-EXTENT, EXTENT, spacing * np.sqrt(3) / 2)
    along = np.arange(-EXTENT, EXTENT, spacing)
    grid = np.array([[x + spacing / 2 * (k % 2), y] for k, y in enumerate(row) for x in along])
    return grid + spacing * rng.uniform(-0.3, 0.3, grid.shape)


def border_of(faces: np.ndarray, within: np.ndarray) -> list[int] | None:
    """The one border loop whose vertices are `within`, in the direction of new faces; None if there are several, or none."""
    inner = [loop.tolist() for loop in tripatch.find_holes(faces) if within[loop].all()]
    return inner[0] if len(inner) == 1 else None


def known_hole(name: str, kind: str, spacing: float, noise: float, rng: np.random.Generator) -> KnownHole | None:
    """None where the cut leaves no single rim. noise: of the vertices, over the length of edges."""
    corners, rim = outline(KINDS[kind], spacing, rng)
    points = scattered(spacing, rng)
    if kind != "jagged":
        dense = np.concatenate([rim + f * (np.roll(rim, -1, 0) - rim) for f in (0, 0.25, 0.5, 0.75)])
        points = np.concatenate([rim, points[cKDTree(dense).query(points)[0] > 0.6 * spacing]])
    triangles = Delaunay(points).simplices
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    triangles = np.where(area[:, None] > 0, triangles, triangles[:, ::-1])
    middle = points[triangles].mean(1)
    left = triangles[~inside(corners, middle) & (np.abs(area) > 1e-9)]
    used, faces = np.unique(left, return_inverse=True)
    faces, places = faces.reshape(-1, 3), points[used]
    loop = border_of(faces, np.abs(places).max(1) < 0.9)
    if loop is None:
        return None
    vertices = SURFACES[name].place(places)
    edges = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1)
    vertices = vertices + noise * np.median(edges) * rng.normal(size=vertices.shape)
    return KnownHole(name, kind, SURFACES[name], vertices, faces, loop)


def known_holes(seed: int, spacings=(0.09, 0.16), noises=(0, 0.03), surfaces=tuple(SURFACES)) -> Iterator[KnownHole]:
    rng = np.random.default_rng(seed)
    for name in surfaces:
        for kind in KINDS:
            for spacing in spacings:
                for noise in noises:
                    hole = known_hole(name, kind, spacing, noise, rng)
                    if hole:
                        yield hole


def regret(errors: dict[str, float]) -> float | None:
    """Error of what auto chose over that of the best candidate; None without another."""
    known = {method: max(error, NEGLIGIBLE) for method, error in errors.items()}
    return known["auto"] / min(known.values()) if "auto" in known and len(known) > 1 else None


def summary(regrets: list[float]) -> tuple[float, float]:
    """Geometric mean, and the worst."""
    return float(np.exp(np.mean(np.log(regrets)))), float(max(regrets))
