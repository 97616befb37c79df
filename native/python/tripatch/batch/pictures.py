"""The contact sheet: the worst seams of a batch on one picture, for a look before all is used."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .. import quality, words
from .._types import Array
from ..canvas import Canvas
from ..messages import Message
from . import record
from .keeper import Keeper
from .settings import CROP, Settings

_TILE, _TEXT, _COLUMNS, _FINER = 300, 46, 4, 2  # pixels, pixels, tiles, times
_AROUND, _FILL, _BEHIND, _INK = (200, 200, 204), (120, 168, 224), (250, 250, 250), (30, 30, 40)
#: Degrees between the faces on both sides of an edge of the seam: from green, which nobody sees, to red.
_SEEN = 30.0
_TILT = np.radians(20.0)
_LIFT = 0.003  # of the size: edges of faces are drawn over the faces


def worst(entries: Sequence[dict[str, Any]], count: int) -> list[tuple[dict[str, Any], int]]:
    """(line of a filled hole, how many fills of its object come before it): those that fold first, then by the angle between
    the faces along the rim, which says what a person sees."""
    found = []
    for entry in entries:
        before: dict[str, Any] = {}
        for line in entry["lines"][1:]:
            if line["status"] == record.FILLED and entry["lines"][0]["output"]:
                place = before.get(line["object"], 0)
                before[line["object"]] = place + 1
                bad = ((line["triangles_folded"] or 0) > 0, line["crease_max"] or 0.0)
                found.append((bad, line, place))
    found.sort(key=lambda each: (tuple(-x for x in each[0]), each[1]["input"], each[1]["hole"]))
    return [(line, place) for _, line, place in found[:count]]


def gathered(holes: list[tuple[dict[str, Any], int]], settings: Settings) -> list[dict[str, Any] | None]:
    """What each picture needs, from the files as they are now; None where a file has changed or gone meanwhile."""
    by_file: dict[str, list[int]] = {}
    for k, (line, _) in enumerate(holes):
        by_file.setdefault(line["input"], []).append(k)
    asked = Settings(**{**vars(settings), "mode": CROP, "retries": 0})
    made: list[dict[str, Any] | None] = [None] * len(holes)
    with Keeper(asked) as keeper:
        for name, places in by_file.items():
            wanted = tuple((holes[k][0]["object"], holes[k][0]["hole"], holes[k][1]) for k in places)
            try:
                answer = keeper.call("tripatch.batch.job", "work", str(Path(settings.root, name)), asked, None, wanted)
            except Exception:  # the sheet is not worth a run
                continue
            for k, crop in zip(places, answer.get("crops") or [None] * len(places), strict=False):
                made[k] = crop
    return made


def _seen_from(crop: dict[str, Any], normals: Array) -> Array:
    """Rows to the right, upwards and to the eye: a little askew above the fill, whose longer way goes to the right."""
    points = np.asarray(crop["vertices"], float)
    toward = normals[len(crop["around"]) :].sum(axis=0)
    toward = toward / max(np.linalg.norm(toward), 1e-300) if np.linalg.norm(toward) > 0 else np.array([0.0, 0, 1])
    rim = points[sorted({v for face in crop["fill"] for v in face})]
    _, axes = np.linalg.eigh(np.cov((rim - rim.mean(axis=0)).T))
    right = axes[:, 2] - (axes[:, 2] @ toward) * toward
    right /= max(np.linalg.norm(right), 1e-300)
    right *= np.sign(right[np.argmax(np.abs(right))]) or 1.0  # an axis has no direction of its own
    tilt = np.array([[1, 0, 0], [0, np.cos(_TILT), np.sin(_TILT)], [0, -np.sin(_TILT), np.cos(_TILT)]])
    turned: Array = tilt @ np.stack([right, np.cross(toward, right), toward])
    return turned


def _normal(corners: Array) -> Array:
    """Twice the area vector of a polygon."""
    doubled: Array = np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0)
    return doubled


def _seam(crop: dict[str, Any], normals: Array) -> list[tuple[int, int, float]]:
    """Edges between fill and surroundings, and the degrees between the faces there."""
    owner: dict[frozenset[Any], list[int]] = {}
    for f, face in enumerate([*crop["around"], *crop["fill"]]):
        for a, b in zip(face, [*face[1:], face[0]], strict=True):
            owner.setdefault(frozenset((a, b)), []).append(f)
    first, edges = len(crop["around"]), []
    for edge, faces in owner.items():
        if len(faces) == 2 and len(edge) == 2 and (faces[0] < first) != (faces[1] < first):
            n0, n1 = normals[faces[0]], normals[faces[1]]
            edges.append((*sorted(edge), float(np.degrees(np.arctan2(np.linalg.norm(np.cross(n0, n1)), n0 @ n1)))))
    return edges


def tile(crop: dict[str, Any], size: int) -> Array:
    """A picture (size, size, 3) of a hole: what is nearer to the eye over what is behind, the seam over all."""
    points, faces = np.asarray(crop["vertices"], float), [*crop["around"], *crop["fill"]]
    normals = np.array([_normal(points[face]) for face in faces])
    axes = _seen_from(crop, normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    canvas = Canvas(points, axes, size, size)
    triangles, of_face = quality.triangulated(faces, points)
    canvas.draw(triangles)
    light = np.array([-0.35, 0.45, 0.82]) / np.linalg.norm([-0.35, 0.45, 0.82]) @ axes
    shade = 0.35 + 0.65 * np.abs(normals @ light)
    colors = np.where((np.arange(len(faces)) >= len(crop["around"]))[:, None], _FILL, _AROUND) * shade[:, None]
    image = np.empty((size * size, 3))
    image[:] = _BEHIND
    seen = canvas.triangle >= 0
    image[seen] = colors[of_face[canvas.triangle[seen]]]
    lift = _LIFT * float(np.ptp(points, axis=0).max(initial=0))
    for face, color in zip(faces, colors, strict=True):
        canvas.line(image, points[[*face, face[0]]], 0.82 * color, lift=lift)
    for a, b, degrees in _seam(crop, normals):
        bad = min(degrees / _SEEN, 1.0)
        color = np.array([40 + 190 * bad, 150 - 110 * bad, 60 - 20 * bad])
        canvas.line(image, points[[a, b]], color, radius=_FINER, lift=np.inf)
    return image.reshape(size, size, 3).astype(np.uint8)


def _caption(place: int, line: dict[str, Any]) -> list[str]:
    name = line["input"] if len(line["input"]) <= 40 else "..." + line["input"][-37:]
    where = {key: line[key] for key in ("object", "vertex", "edges") if line[key] is not None}
    if "vertex" not in where:
        where["hole"] = line["hole"]
    angle = line["crease_max"]
    said = {"method": line["method"]} if angle is None else {"angle": words.degrees(angle)}
    said |= {"folded": line["triangles_folded"]} if line["triangles_folded"] else {}
    return [f"{place}. {name}", Message("seam_place", where), Message("seam_measured", said)]


def sheet(path: Path, holes: list[tuple[dict[str, Any], int]], settings: Settings, total: int) -> bool:
    """Writes the picture; False where there is nothing to see."""
    if not holes:
        return False
    from PIL import Image, ImageDraw, ImageFont

    columns = min(_COLUMNS, len(holes))
    rows = -(-len(holes) // columns)
    head, size = 34, (columns * _TILE, 34 + rows * (_TILE + _TEXT))
    big = Image.new("RGB", (size[0] * _FINER, size[1] * _FINER), _BEHIND)
    crops = gathered(holes, settings)
    for k, crop in enumerate(crops):
        left, top = k % columns * _TILE * _FINER, (head + k // columns * (_TILE + _TEXT)) * _FINER
        if crop:
            big.paste(Image.fromarray(tile(crop, _TILE * _FINER)), (left, top))
    image = big.resize(size, Image.Resampling.LANCZOS)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(12)
    draw.text((8, 8), Message("sheet_title", {"count": len(holes), "total": total}), fill=_INK, font=ImageFont.load_default(15))
    for k, (line, _) in enumerate(holes):
        left, top = k % columns * _TILE + 8, head + k // columns * (_TILE + _TEXT) + _TILE + 1
        if not crops[k]:
            draw.text((left + _TILE / 2 - 8, top - _TILE / 2), Message("picture_missing"), fill=_INK, font=font, anchor="mm")
        for row, text in enumerate(_caption(k + 1, line)):
            draw.text((left, top + 14 * row), text, fill=_INK, font=font)
    data = io.BytesIO()
    image.save(data, "PNG", optimize=True)
    path.write_bytes(data.getvalue())
    return True
