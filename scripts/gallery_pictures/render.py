"""Pictures of smooth surfaces with exact normals, drawn by `tripatch.canvas`. Orthographic."""

from __future__ import annotations

import io
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image
from tripatch.canvas import Canvas

CLAY, BLUE, GREEN, RED, GREY = (0.90, 0.72, 0.48), (0.55, 0.70, 0.90), (0.60, 0.82, 0.60), (0.90, 0.58, 0.55), (0.80, 0.80, 0.82)
INK = (0.12, 0.12, 0.16)
SUPERSAMPLING = 2


def unit(v):
    v = np.asarray(v, float)
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-300)


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

    def _triangles(self):
        """Corners, normals and colors (t, 3, 3) of all triangles, and which have stripes."""
        found = []
        for points, normals, color, zebra in self.grids:
            number = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
            a, b, c, d = (each.ravel() for each in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
            faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
            colors = np.broadcast_to(color, points.shape)
            found.append((*(each.reshape(-1, 3)[faces] for each in (points, normals, colors)), np.full(len(faces), zebra)))
        found += [(*each, np.full(len(each[0]), zebra)) for *each, zebra in self.meshes]
        empty = (np.zeros((0, 3, 3)),) * 3, np.zeros(0, bool)
        return [np.concatenate(each) for each in zip(*found)] if found else [*empty[0], empty[1]]

    def _canvas(self, width, height, **shown):
        corners = self._triangles()[0].reshape(-1, 3)
        every = np.concatenate([corners, *(np.atleast_2d(points) for points, *_ in self.curves)])
        canvas = Canvas(every, np.stack([self.right, self.up, self.eye]), width, height, **shown)
        canvas.draw(np.arange(len(corners)).reshape(-1, 3))
        return canvas, np.linalg.norm(np.ptp(every @ canvas.axes.T, axis=0))

    def pixels(self, points, width, height):
        """(k, 2) where points lie in an image of this size."""
        return self._canvas(width, height, share=0.92)[0].placed(points)[:, :2]

    def image(self, width=340, height=320, center=None, span=None, margin=0.04):
        """An image (height, width, 3); center and span (of the height) in scene units, by default all that there is."""
        k = SUPERSAMPLING
        canvas, size = self._canvas(width * k, height * k, share=1 - 2 * margin, center=center, span=span)
        _, normals, colors, zebra = self._triangles()
        out = np.ones((width * k * height * k, 3))
        for stripes in (False, True):
            seen = np.flatnonzero(canvas.triangle >= 0)
            seen = seen[zebra[canvas.triangle[seen]] == stripes]
            of, weights = canvas.triangle[seen], canvas.weights[seen][:, :, None]
            normal, color = ((each[of] * weights).sum(axis=1) for each in (normals, colors))
            out[seen] = self._shade(normal, color, stripes)
        for points, color, thick, lift in self.curves:
            canvas.line(out, points, color, radius=np.hypot(thick * k / 2, 0.5), lift=lift * size)
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
