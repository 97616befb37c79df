"""The pictures of docs/holebench.md: truth, two rivals and TriPatch, in reflection lines and in colors of mean curvature."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from gallery_pictures import render

from . import metrics
from .holes import Hole, unit
from .page import OURS, TRUTH, over_ours, short

SIZE = {"width": 300, "height": 290}
COLOURS = matplotlib.colormaps["RdYlBu_r"]


def chosen(made: dict, result: dict) -> list[str]:
    """The rival whose points are nearest to the truth, and the nearest of another make."""
    left = {name: result[name]["distance"] for name in made if name not in (OURS, TRUTH)}
    order = sorted(left, key=left.get)
    return [order[0], next(name for name in order if name.split(",")[0] != order[0].split(",")[0])]


def view(hole: Hole) -> dict:
    """From outside, a little askew, turned so that the picture is as large as can be."""
    rim = hole.vertices[hole.rim]
    towards = unit(np.cross(rim, np.roll(rim, -1, axis=0)).sum(0))
    azimuth, elevation = np.degrees([np.arctan2(towards[1], towards[0]), np.arcsin(towards[2])])

    def extent(roll):
        scene = render.Scene(azimuth + 12, elevation - 9, roll=roll)
        return max(np.ptp(hole.vertices @ scene.right) / SIZE["width"], np.ptp(hole.vertices @ scene.up) / SIZE["height"])

    return {"azimuth": azimuth + 12, "elevation": elevation - 9, "roll": min(range(-90, 91, 5), key=extent)}


def draw(path: Path, hole: Hole, made: dict, result: dict) -> None:
    names = [TRUTH, *chosen(made, result), OURS]
    outside = metrics.mean_curvature(hole.vertices, hole.faces)
    inside = {name: metrics.mean_curvature(made[name].vertices, made[name].faces) for name in names}
    known = np.concatenate([outside, inside[TRUTH]])
    known = known[np.isfinite(known)]
    middle, reach = np.median(known), max(np.ptp(known) / 2, 0.1 * np.abs(known).max())
    scale = matplotlib.colors.Normalize(middle - 1.5 * reach, middle + 1.5 * reach)

    def colors(curvature):
        return COLOURS(scale(np.nan_to_num(curvature, nan=middle)))[:, :3]

    images = []
    for lines in (True, False):
        for name in names:
            filling = made[name]
            used = np.unique(filling.faces)
            normals = np.zeros_like(filling.vertices)
            normals[used] = metrics.limit_normals(filling.vertices, filling.faces, used)
            scene = render.Scene(**view(hole), stripes=17, contrast=0.45 if lines else 0.12)
            blue, orange = (render.BLUE, render.CLAY) if lines else (colors(outside), colors(inside[name]))
            scene.mesh(hole.vertices, hole.faces, hole.normals, blue, zebra=lines)
            scene.mesh(filling.vertices, filling.faces, normals, orange, zebra=lines)
            if not lines:
                rim = hole.vertices[hole.rim]
                scene.curve(np.concatenate([rim, rim[:1]]), width=0.8)
            images.append(scene.image(**SIZE))

    width, height, title, bar = SIZE["width"], SIZE["height"], 22, 70
    total = (4 * width + bar, 2 * height + title)
    figure = plt.figure(figsize=(total[0] / 100, total[1] / 100), dpi=100)
    for k, image in enumerate(images):
        row, column = divmod(k, 4)
        place = (column * width / total[0], (1 - row) * height / total[1], width / total[0], height / total[1])
        axes = figure.add_axes(place)
        axes.imshow(image, interpolation="nearest")
        axes.axis("off")
        if row == 0:
            name = names[column]
            axes.set_title(name if name == TRUTH else f"{name}: {short(result[name]['distance'])}", fontsize=9, pad=4)
    axes = figure.add_axes(((4 * width + 12) / total[0], 40 / total[1], 12 / total[0], (height - 80) / total[1]))
    figure.colorbar(matplotlib.cm.ScalarMappable(scale, COLOURS), cax=axes).ax.tick_params(labelsize=7)
    axes.set_title("mean\ncurvature", fontsize=7, loc="left")
    render.save_figure(path, figure, colors=None)


def distances(path: Path, rows: list[dict], names: list[str]) -> None:
    """For each program the distances of its fills over TriPatch's, hole by hole in order."""
    figure, axes = plt.subplots(figsize=(9, 4.5), dpi=100)
    for k, name in enumerate(names):
        ratios = sorted(ratio for row in rows if (ratio := over_ours(row, name, "vertices")) is not None)
        if ratios and name != OURS:
            axes.plot(np.linspace(0, 100, len(ratios)), ratios, label=name, color=matplotlib.colormaps["tab20"](k), linewidth=1.3)
    axes.axhline(1, color="black", linewidth=1)
    axes.set(yscale="log", xlim=(0, 100), xlabel="holes, percent", ylabel="distance over TriPatch's")
    axes.legend(fontsize=7, loc="upper left", ncols=2)
    figure.tight_layout()
    render.save_figure(path, figure, colors=None)
