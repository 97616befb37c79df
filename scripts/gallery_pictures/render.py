"""Pictures of smooth surfaces: dense points with exact normals, the nearest to the eye wins a pixel. Orthographic."""

from __future__ import annotations

import io
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

CLAY, BLUE, GREEN, RED, GREY = (0.90, 0.72, 0.48), (0.55, 0.70, 0.90), (0.60, 0.82, 0.60), (0.90, 0.58, 0.55), (0.80, 0.80, 0.82)
INK = (0.12, 0.12, 0.16)
SUPERSAMPLING = 2


def unit(v):
    v = np.asarray(v, float)
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-300)


def between(grid, count):
    """The grid (m, n, d) read linearly at count[0] x count[1] places."""
    for axis, k in enumerate(count):
        at = np.linspace(0, grid.shape[axis] - 1, k)
        low = np.minimum(at.astype(int), grid.shape[axis] - 2)
        f = (at - low).reshape([-1, 1, 1] if axis == 0 else [1, -1, 1])
        grid = np.take(grid, low, axis) * (1 - f) + np.take(grid, low + 1, axis) * f
    return grid


def triangle_grid(m=48):
    """(m + 1, m + 1, 3) barycentric coordinates on the paper's lines: u = t - st, v = st, w = 1 - t; a hair off the border."""
    t, s = np.meshgrid(np.linspace(0, 1, m + 1), np.linspace(0, 1, m + 1), indexing="ij")
    return (1 - 3e-6) * np.stack([t - s * t, s * t, 1 - t], -1) + 1e-6


def of_patch(patch, m=48):
    """Grids of points and exact unit normals of a triangular patch."""
    b = triangle_grid(m)
    points, normals = patch.positions_and_normals(b.reshape(-1, 3))
    return points.reshape(b.shape), normals.reshape(b.shape)


def of_rectangle(rectangle, m=40, u=(0, 1), v=(0, 1)):
    """Grids of points and exact unit normals of a rectangular surface."""
    at = np.stack(np.meshgrid(np.linspace(*u, m + 1), np.linspace(*v, m + 1), indexing="ij"), -1)
    p, d = rectangle.evaluate(at.reshape(-1, 2), derivatives=1)[:2]
    return p.reshape(m + 1, m + 1, 3), unit(np.cross(d[:, 0], d[:, 1])).reshape(m + 1, m + 1, 3)


def normals_of(points):
    """Unit normals of a grid of points by central differences, for surfaces that have no exact ones at hand."""
    return unit(np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1)))


class Scene:
    """Surfaces and curves seen from a direction (degrees), the picture turned by `roll`."""

    def __init__(self, azimuth=-60, elevation=30, stripes=9, contrast=0.58, roll=0):
        a, e, r = np.radians([azimuth, elevation, roll])
        self.eye = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        self.right = np.array([-np.sin(a), np.cos(a), 0])
        self.right = np.cos(r) * self.right + np.sin(r) * np.cross(self.eye, self.right)
        self.up = np.cross(self.eye, self.right)
        self.stripes, self.contrast = stripes, contrast
        self.grids, self.meshes, self.curves = [], [], []

    def surface(self, points, normals, color=CLAY, zebra=False):
        self.grids.append((points, normals, color, zebra))
        return self

    def patch(self, patch, color=CLAY, zebra=False, lines=0, m=48, lift=0.006):
        points, normals = of_patch(patch, m)
        self.surface(points, normals, color, zebra)
        if lines:
            self.lines(points, lines, lift=lift)
        return self

    def mesh(self, vertices, faces, normals, color=CLAY, zebra=False):
        """A triangle mesh; normals (n, 3), or (m, 3) of flat faces; one color, or colors (n, 3)."""
        corners = normals[faces] if len(normals) == len(vertices) else np.repeat(normals[:, None], 3, axis=1)
        color = color[faces] if np.ndim(color) > 1 else np.broadcast_to(color, corners.shape)
        self.meshes.append((vertices[faces], corners, color, zebra))
        return self

    def lines(self, points, count=10, color=(0.25, 0.2, 0.2), width=0.9, lift=0.006):
        """The (s, t) lines of a grid, `count` cells each way."""
        steps = np.linspace(0, len(points) - 1, count + 1).round().astype(int)
        for k in steps:
            self.curve(points[k], color, width, lift)
            self.curve(points[:, k], color, width, lift)
        return self

    def curve(self, points, color=INK, width=2.0, lift=0.006):
        self.curves.append((np.asarray(points, float), color, width, lift))
        return self

    def dots(self, points, color=INK, width=7.0, lift=0.02):
        for p in np.atleast_2d(points):
            self.curve([p, p], color, width, lift)
        return self

    def _shade(self, n, color, zebra):
        n = unit(n)
        n = n * np.where(n @ self.eye < 0, -1, 1)[:, None]
        key = unit(self.eye + 0.7 * self.up - 0.6 * self.right)
        light = 1 - self.contrast + self.contrast * np.clip(n @ key, 0, 1) ** 1.1
        out = np.asarray(color) * light[:, None] + 0.31 * self.contrast * np.clip(n @ unit(key + self.eye), 0, 1)[:, None] ** 40
        if zebra:
            mirrored = 2 * (n @ self.eye)[:, None] * n - self.eye
            angle = np.arcsin(np.clip(mirrored @ unit(self.up + 0.35 * self.right), -1, 1))
            dark = 0.5 + 0.5 * np.tanh(9 * np.sin(self.stripes * angle))
            out = out * (1 - 0.62 * dark[:, None])
        return np.clip(out, 0, 1)

    def _frame(self, w, h, center=None, span=None, margin=0.04):
        """Points to (x, y, depth) on w x h pixels, pixels a scene unit, and the size of all that there is."""
        every = (
            [g[0].reshape(-1, 3) for g in self.grids] + [m[0].reshape(-1, 3) for m in self.meshes] + [c[0] for c in self.curves]
        )
        flat = np.concatenate(every) @ np.stack([self.right, self.up, self.eye]).T
        low, high = flat.min(0), flat.max(0)
        middle = (low + high)[:2] / 2 if center is None else np.array([center @ self.right, center @ self.up])
        size = high - low
        scale = (1 - 2 * margin) * min(w / size[0], h / size[1]) if span is None else h / span

        def to_pixels(p):
            return (p @ self.right - middle[0]) * scale + w / 2, h / 2 - (p @ self.up - middle[1]) * scale, p @ self.eye

        return to_pixels, scale, np.linalg.norm(size)

    def pixels(self, points, width, height):
        """(k, 2) where points lie in an image of this size."""
        return np.stack(self._frame(width, height)[0](np.asarray(points, float))[:2], -1)

    def image(self, width=340, height=320, center=None, span=None, margin=0.04):
        """An image (height, width, 3); center and span (of the height) in scene units, by default all that there is."""
        k = SUPERSAMPLING
        w, h = width * k, height * k
        to_pixels, scale, depth_unit = self._frame(w, h, center, span, margin)
        seen = [[], [], [], []]

        def put(x, y, z, colors):
            x, y = x.astype(int), y.astype(int)
            inside = (x >= 0) & (x < w) & (y >= 0) & (y < h)
            for store, values in zip(seen, (x, y, z, colors), strict=True):
                store.append(values[inside])

        for points, normals, color, zebra in self.grids:
            steps = [np.linalg.norm(np.diff(points, axis=a), axis=-1).max() * scale * (points.shape[a] - 1) for a in (0, 1)]
            count = [int(min(max(1.5 * s, points.shape[a]), 1800)) for a, s in enumerate(steps)]
            p, n = between(points, count).reshape(-1, 3), between(normals, count).reshape(-1, 3)
            x, y, z = to_pixels(p)
            put(x, y, z, self._shade(n, between(color, count).reshape(-1, 3) if np.ndim(color) > 1 else color, zebra))
        for corners, normals, color, zebra in self.meshes:
            longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1).max(1) * scale
            for part in np.array_split(np.argsort(longest), max(1, len(corners) // 50)):
                m = int(np.clip(1.5 * longest[part].max(), 2, 900))
                b = np.array([(i, j, m - i - j) for i in range(m + 1) for j in range(m + 1 - i)]) / m
                p, n, c = (np.einsum("kc,mcd->mkd", b, v[part]).reshape(-1, 3) for v in (corners, normals, color))
                x, y, z = to_pixels(p)
                put(x, y, z, self._shade(n, c, zebra))
        for points, color, thick, lift in self.curves:
            length = np.linalg.norm(np.diff(points, axis=0), axis=1)
            along = np.concatenate([[0], np.cumsum(length)])
            at = np.linspace(0, along[-1], int(along[-1] * scale) + 2)
            p = np.stack([np.interp(at, along, points[:, d]) for d in range(3)], -1)
            radius = thick * k / 2
            reach = np.arange(-int(radius + 1), int(radius + 1) + 1)
            disc = np.array([(i, j) for i in reach for j in reach if i * i + j * j <= radius**2 + 0.3])
            x, y, z = to_pixels(p)
            x, y = (a[:, None] + d for a, d in ((x, disc[:, 0]), (y, disc[:, 1])))
            z = np.broadcast_to((z + lift * depth_unit)[:, None], x.shape)
            put(x.ravel(), y.ravel(), z.ravel(), np.broadcast_to(color, (x.size, 3)))
        x, y, z, colors = (np.concatenate(s) for s in seen)
        order = np.argsort(z, kind="stable")
        out = np.ones((h, w, 3))
        out[y[order], x[order]] = colors[order]  # the last, nearest, stays
        return out.reshape(height, k, width, k, 3).mean((1, 3))


def save(path: pathlib.Path, images, titles=None, columns=None):
    """Images side by side with titles, as a small PNG of 256 colors."""
    columns = columns or len(images)
    rows = -(-len(images) // columns)
    height, width = images[0].shape[:2]
    title = 22 if titles else 0
    figure = plt.figure(figsize=(columns * width / 100, rows * (height + title) / 100), dpi=100)
    for k, image in enumerate(images):
        row, column = divmod(k, columns)
        bottom = 1 - ((row + 1) * (height + title)) / (rows * (height + title))
        axes = figure.add_axes([column / columns, bottom, 1 / columns, height / (rows * (height + title))])
        axes.imshow(image, interpolation="nearest")
        axes.axis("off")
        if titles:
            axes.set_title(titles[k], fontsize=9, pad=4)
    save_figure(path, figure)


def save_figure(path: pathlib.Path, figure, colors=256):
    """As a PNG of so many colors, None: of all."""
    memory = io.BytesIO()
    figure.savefig(memory, format="png", dpi=100)
    plt.close(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    image = Image.open(memory).convert("RGB")
    if colors:
        image = image.quantize(colors, dither=Image.Dither.NONE)
    image.save(path, optimize=True)
    print(f"{path.name}: {path.stat().st_size // 1000} kB", flush=True)
