"""Drawing triangles and lines into an image, the foremost over what is behind, without a window or a library."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np

from ._types import Array, ArrayLike

_AT_ONCE = 300_000  # pairs of a triangle and a pixel that are looked at together: some 50 MB


def png(image: Array) -> bytes:
    """The PNG file of an image (h, w, 3) of bytes."""
    height, width, _ = image.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.concatenate([np.zeros((height, 1), np.uint8), image.reshape(height, -1)], axis=1)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b"")


def view_axes(direction: ArrayLike) -> Array:
    """Rows to the right, upwards and to the eye for a view from a direction; z is upwards."""
    toward = np.asarray(direction, float)
    toward = toward / np.linalg.norm(toward)
    up = np.array([0.0, 0.0, 1.0]) if abs(toward[2]) < 0.999 else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, toward)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(toward, right), toward])


class Canvas:
    """A parallel projection onto pixels with depth.

    Attributes:
        points: (n, 3) of the vertices x and y in pixels, and how near they are to the eye.
        nearness: (h * w,) of what is seen at each pixel; -inf: nothing.
        triangle, weights: (h * w,), (h * w, 3) which triangle is seen there, -1: none, and the weights of its corners.
    """

    def __init__(
        self,
        vertices: Array,
        toward: ArrayLike,
        width: int,
        height: int,
        *,
        share: float = 0.92,
        center: ArrayLike | None = None,
        span: float | None = None,
    ) -> None:
        """toward: the direction of the eye, or rows (3, 3) to the right, upwards and to the eye.

        The picture shows all, which takes this share of the width or the height; or what is around a center, or of this height.
        """
        self.axes, self._size = view_axes(toward) if np.ndim(toward) == 1 else np.asarray(toward), (height, width)
        turned = vertices @ self.axes.T
        low, high = turned.min(axis=0), turned.max(axis=0)
        extent = np.maximum(high - low, 1e-30)
        self.scale = share * min(width / extent[0], height / extent[1]) if span is None else height / span
        self._middle = (low + high) / 2 if center is None else self.axes @ np.asarray(center, float)
        self.points = self.placed(vertices)
        self.nearness = np.full(height * width, -np.inf)
        self.triangle = np.full(height * width, -1)
        self.weights = np.zeros((height * width, 3))

    def placed(self, points: ArrayLike) -> Array:
        """Points (k, 3) as those of the vertices are."""
        turned, (height, width) = np.asarray(points, float) @ self.axes.T, self._size
        x, y = (turned[:, :2] - self._middle[:2]).T * self.scale
        return np.column_stack([x + width / 2, height / 2 - y, turned[:, 2]])

    def line(self, image: Array, ends: ArrayLike, color: ArrayLike, radius: float = 0.5, lift: float = 0.0) -> None:
        """Draws a line through points (k, 3) where nothing is before it.

        Args:
            image: (h * w, d) of any kind of numbers, which it changes.
            radius: half its width in pixels.
            lift: how much nearer to the eye it counts than it is, in scene units; inf: nothing is before it.
        """
        placed, (height, width) = self.placed(ends), self._size
        way = np.concatenate([[0], np.cumsum(np.abs(np.diff(placed[:, :2], axis=0)).max(axis=1))])
        at = np.linspace(0, way[-1], int(way[-1]) + 2)
        x, y, z = (np.interp(at, way, column) for column in placed.T)
        reach = np.arange(-int(radius + 1), int(radius + 1) + 1)
        dots = np.array([(i, j) for i in reach for j in reach if i * i + j * j <= radius * radius])
        columns, rows = (np.floor(c).astype(np.int64)[:, None] + d for c, d in ((x, dots[:, 0]), (y, dots[:, 1])))
        near = np.broadcast_to(z[:, None] + lift, columns.shape)
        seen = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
        pixel, near = (rows * width + columns)[seen], near[seen]
        seen = near >= self.nearness[pixel]
        image[pixel[seen]] = color
        np.maximum.at(self.nearness, pixel[seen], near[seen])

    def _candidates(self, corners: Array) -> Any:
        """For some triangles, every pixel of their bounding rectangles: numbers of triangle, x, y."""
        height, width = self._size
        low = np.maximum(np.floor(corners[:, :, :2].min(axis=1)).astype(np.int64), 0)
        high = np.minimum(np.ceil(corners[:, :, :2].max(axis=1)).astype(np.int64), [width - 1, height - 1])
        wide = np.maximum(high - low + 1, 0)
        count = wide.prod(axis=1)
        which = np.repeat(np.arange(len(corners)), count)
        step = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
        return which, low[which, 0] + step % wide[which, 0], low[which, 1] + step // wide[which, 0]

    def draw(self, triangles: Array) -> None:
        """Finds for every pixel the foremost triangle and the weights of its corners there."""
        corners = self.points[triangles]
        span = np.maximum(np.ceil(np.ptp(corners[:, :, :2], axis=1)) + 2, 1).prod(axis=1)
        part = (np.cumsum(span) // _AT_ONCE).astype(np.int64)
        for k in np.unique(part):
            chosen = np.flatnonzero(part == k)
            self._draw(corners[chosen], chosen)

    def _draw(self, corners: Array, numbers: Array) -> None:
        which, x, y = self._candidates(corners)
        p = corners[which]
        ab, ac = p[:, 1, :2] - p[:, 0, :2], p[:, 2, :2] - p[:, 0, :2]
        to = np.column_stack([x + 0.5, y + 0.5]) - p[:, 0, :2]
        area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
        area = np.where(np.abs(area) > 1e-12, area, np.inf)  # seen from the edge
        b = (to[:, 0] * ac[:, 1] - to[:, 1] * ac[:, 0]) / area
        c = (ab[:, 0] * to[:, 1] - ab[:, 1] * to[:, 0]) / area
        weights = np.column_stack([1 - b - c, b, c])
        inside = (weights > -1e-9).all(axis=1) & np.isfinite(area)
        which, weights, pixel = which[inside], weights[inside], (y * self._size[1] + x)[inside]
        near = (weights * p[inside][:, :, 2]).sum(axis=1)
        order = np.argsort(near, kind="stable")  # of those assigned to one pixel the last counts
        order = order[near[order] > self.nearness[pixel[order]]]
        pixel = pixel[order]
        self.nearness[pixel] = near[order]
        self.triangle[pixel], self.weights[pixel] = numbers[which[order]], weights[order]
