"""Pictures of a mesh that show its quality, made without a window: `tripatch view FILE --zebra OUT.png`."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _arrays, arguments, files, quality
from ._types import Array, ArrayLike
from .canvas import Canvas, png
from .errors import WrongValue, out_of_range, wrong_shape
from .files.writing import unwritable
from .messages import Message

_BACKGROUND = (0.22, 0.22, 0.23)
_FILL_COLOR = (1.0, 0.72, 0.4)
_FINER = 2  # pixels a side that are averaged into one
SIZE, EYE, LINES = (960, 720), (1, -1.4, 0.9), 12
#: What the picture shows, in the order in which the help says it.
KINDS = ("zebra", "highlight", "curvature", "seam", "deviation", "folds")


def _lit(normals: Array, axes: Array) -> Array:
    """Brightness of normals in a light from the upper left; both sides of a surface alike."""
    light = np.array([-0.4, 0.5, 0.77]) @ axes
    return 0.35 + 0.65 * np.abs(normals @ light)


def _colors(kind: str, vertices: Array, triangles: Array, edges: Array, settings: dict[str, Any]) -> Any:
    """Colors (n, 3) of vertices for those kinds that color them, and a sentence on the scale."""
    if kind == "curvature":
        mean, _ = quality.curvatures(vertices, triangles)
        most = settings.get("most") or quality.usual(mean)
        told = Message("curvature_shown", {"least": f"{-most:.3g}", "most": f"{most:.3g}"})
        return quality.signed_colors(mean, most), told
    if kind == "deviation":
        values = settings["deviation"]
        known = np.isfinite(values) & (values >= 0)
        largest = float(values[known].max(initial=0.0))
        most = settings.get("most") or largest
        colors = quality.known_colors(np.where(known, values, np.nan), most)
        if not largest:
            return colors, Message("deviation_not_known")
        said: dict[str, Any] = {"largest": f"{largest:.3g}", "most": f"{most:.3g}"}
        said |= {} if known.all() else {"unknown": int((~known).sum())}
        return colors, Message("deviation_shown", said)
    if len(edges):
        found, angles = edges, quality.seam_angles(vertices, triangles, edges)
    else:
        found, angles = quality.edge_angles(vertices, triangles)
    at, known = np.zeros(len(vertices)), np.isfinite(angles)
    np.maximum.at(at, found[known].ravel(), np.repeat(angles[known], 2))
    if len(edges) and not known.any():
        raise WrongValue(Message("no_such_seam"))
    largest = float(angles[known].max(initial=0.0))
    most = settings.get("most") or (1.0 if len(edges) else max(largest, 1e-9))
    told = Message("seam_shown" if len(edges) else "edges_shown", {"angle": f"{largest:.3g}°", "most": f"{most:.3g}°"})
    colors = quality.scale_colors(at, most)
    if len(edges):
        colors[np.setdiff1d(np.arange(len(vertices)), edges)] = quality.GREY
    return colors, told


def picture(
    vertices: Array,
    faces: Any,
    kind: str = "zebra",
    *,
    rims: Any = (),
    size: Sequence[int] = SIZE,
    toward: ArrayLike = EYE,
    direction: ArrayLike = (0, 0, 1),
    lines: float = LINES,
    most: float | None = None,
    deviation: ArrayLike | None = None,
    fills: ArrayLike | None = None,
) -> Any:
    """A picture (h, w, 3) of bytes, and a sentence on what it shows.

    Args:
        vertices, faces: (n, 3); index lists or an int array.
        kind: a name in `KINDS`.
        rims: closed lists of vertices, for the seam.
        toward: from where it is seen.
        direction, lines: of stripes, as `quality.stripes` has them.
        most: where the scale of colors ends; None: 95 of a hundred values are within it (seam: 1 degree, deviation: all).
        deviation: (n,) what that kind shows; below 0 or nan: unknown.
        fills: (m,) bool, the faces that are orange in the kinds that have no colors.
    """
    vertices = np.asarray(vertices, dtype=np.float64)
    triangles, of_face = quality.triangulated(faces, vertices)
    if not len(triangles):
        raise WrongValue(Message("nothing_given", {"name": "faces"}))
    edges = np.array([pair for rim in rims for pair in zip(rim, [*rim[1:], rim[0]])], dtype=np.int64).reshape(-1, 2)
    if len(edges) and not (0 <= edges.min() and edges.max() < len(vertices)):
        lowest, highest = int(edges.min()), int(edges.max())
        raise _arrays.no_such_vertex("rim", lowest if lowest < 0 else highest, len(vertices))
    known = None if deviation is None else np.asarray(deviation, dtype=np.float64)
    if kind == "deviation" and (known is None or known.shape != (len(vertices),)):
        raise wrong_shape("deviation", f"({len(vertices)},)", None if known is None else known.shape)
    width, height = (_FINER * int(n) for n in size)
    canvas = Canvas(vertices, toward, width, height)
    canvas.draw(triangles)
    seen = np.flatnonzero(canvas.triangle >= 0)
    of, weights = canvas.triangle[seen], canvas.weights[seen]
    normals = quality.unit((quality.corner_normals(vertices, triangles)[of] * weights[:, :, None]).sum(axis=1))
    if kind in ("zebra", "highlight"):
        orange = np.zeros(len(faces), bool) if fills is None else np.asarray(fills, bool)
        told = Message("stripes_shown" if kind == "zebra" else "highlight_shown", {"fills": 1} if orange.any() else {})
        normals *= np.where(normals @ canvas.axes[2] < 0, -1, 1)[:, None]  # the side that is seen
        stripe = quality.stripes(normals, direction, lines, canvas.axes[2] if kind == "zebra" else None)
        color = np.repeat((0.06 + 0.88 * np.clip(0.5 + 4 * (stripe - 0.5), 0, 1))[:, None], 3, axis=1)
        color[orange[of_face[of]]] *= _FILL_COLOR
    elif kind == "folds":
        bad = quality.folded(vertices, triangles)
        told = Message("folds_shown", {"count": int(bad.sum())}) if bad.any() else Message("no_folds_shown")
        color = np.where(bad[of][:, None], quality.FOLD_COLOR, quality.GREY) * _lit(normals, canvas.axes)[:, None]
    else:
        colors, told = _colors(kind, vertices, triangles, edges, {"most": most, "deviation": known})
        color = (colors[triangles[of]] * weights[:, :, None]).sum(axis=1) * _lit(normals, canvas.axes)[:, None]
    image = np.empty((height * width, 3))
    image[:] = _BACKGROUND
    image[seen] = color
    image = image.reshape(height // _FINER, _FINER, width // _FINER, _FINER, 3).mean(axis=(1, 3))
    return np.clip(np.rint(image * 255), 0, 255).astype(np.uint8), told


def _numbers(count: int | None = None, kind: Callable[[str], Any] = float) -> Callable[[str], list[Any]]:
    def parse(text: str) -> list[Any]:
        try:
            values = [kind(part) for part in text.split(",")]
        except ValueError:
            values = []
        if len(values) != (count or max(len(values), 1)):
            raise arguments.unreadable(text, ",".join("123"[: count or 3]))
        return values

    return parse


def add(commands: Any) -> None:
    """The command `view` of a command line."""
    view, shown = arguments.command(commands, "view"), arguments.flag_help
    view.add_argument("input", type=Path, **shown("viewed_file_in"))
    arguments.add_out(view, "picture_out")
    kinds = view.add_mutually_exclusive_group()
    for kind in KINDS:
        kinds.add_argument(f"--{kind}", dest="kind", action="store_const", const=kind, **shown(f"view_{kind}"))
    view.add_argument("--rim", type=_numbers(kind=int), action="append", default=[], **shown("view_rim_flag"))
    eye, size = arguments.listed(EYE), arguments.listed(SIZE)
    view.add_argument("--from", dest="toward", type=_numbers(3), default=EYE, **shown("from_flag", default=eye))
    view.add_argument("--direction", type=_numbers(3), default=[0, 0, 1], **shown("direction_flag", default="0,0,1"))
    view.add_argument("--lines", type=arguments.number, default=LINES, **shown("lines_flag", default=LINES))
    view.add_argument("--max", type=arguments.number, **shown("max_flag"))
    view.add_argument("--most", dest="max", type=arguments.number, help=argparse.SUPPRESS)  # its first name
    view.add_argument("--size", type=_numbers(2, int), default=SIZE, **shown("size_flag", default=size))
    arguments.add_talk(view)
    view.set_defaults(kind="zebra")


def run(args: argparse.Namespace) -> int:
    """Draws what the command line asks for; returns the exit status."""
    args.out = arguments.out_of(args)
    if args.out.suffix.lower() != ".png":
        raise WrongValue(Message("wrong_suffix", {"path": str(args.out), "suffix": ".png"}))
    mesh = files.read_faces(args.input)
    if min(args.size) < 1:
        raise out_of_range("--size", min(args.size), 1)
    for name, values in (("--from", args.toward), ("--direction", args.direction), ("--lines", [args.lines])):
        if not np.isfinite(values).all():
            raise WrongValue(Message("not_finite", {"name": name}))
        if len(values) == 3 and not any(values):
            raise WrongValue(Message("zero_vector", {"name": name}))
    if args.lines <= 0:
        raise out_of_range("--lines", args.lines, 0, is_open=True)
    if args.max is not None and not 0 < args.max < np.inf:
        raise out_of_range("--max", args.max, 0, is_open=True)
    deviation = mesh.deviation if args.kind == "deviation" else None
    if args.kind == "deviation" and deviation is None:
        raise WrongValue(Message("no_estimates_in_file", {"path": str(args.input)}))
    image, told = picture(
        mesh.vertices,
        mesh.faces,
        args.kind or "zebra",
        rims=args.rim,
        size=args.size,
        toward=args.toward,
        direction=args.direction,
        lines=args.lines,
        most=args.max,
        deviation=deviation,
        fills=mesh.fill_faces,
    )
    try:
        args.out.write_bytes(png(image))
    except OSError as error:
        raise unwritable(args.out, error) from error
    if not args.quiet:
        print(f"{args.out}: {told}")
    return 0
