"""The table of docs/mathematics/n-sides.md: holes of four sides and more in known surfaces, by TriPatch and by the baselines."""

from __future__ import annotations

import subprocess

import numpy as np
import tripatch

from . import baselines, holes, metrics
from .fairness import rows, short
from .page import Setting, write_table

N = 32
SIDES = (4, 5, 6, 8)


def of_baselines(setting: Setting, sides: int) -> dict:
    """libigl takes TriPatch's triangles and knows no planes; a surface of OpenCASCADE has four sides."""
    return {
        name: call
        for name, call in baselines.available(setting.cgal, setting.pmp).items()
        if not name.startswith("libigl") and (sides == 4 or not name.startswith("OpenCASCADE"))
    }


def measure(hole: holes.Hole, others: dict) -> tuple[float, str, dict[str, float]]:
    """Of the fill, no corners given: rms distance of the vertices over the diameter, and its method; that of the baselines."""
    fill = tripatch.fill(hole.vertices, hole.faces, rim=hole.rim)
    vertices = np.concatenate([hole.vertices, fill.vertices])
    mine = metrics.distance(hole, vertices[np.unique(np.array(fill.faces))])
    theirs = {}
    for name, call in others.items():
        try:
            made = call(hole, fill)
        except (RuntimeError, KeyError, subprocess.SubprocessError):
            continue
        theirs[name] = metrics.distance(hole, made.vertices[np.unique(made.faces)])
    return mine, fill.report.method, theirs


def table(setting: Setting) -> str:
    lines = [["hole", *(f"{sides} sides" for sides in SIDES)]]
    ratios, makers = {}, set()
    for name in holes.MANY_SIDED[:1] if setting.quick else holes.MANY_SIDED:
        for regular in (True, False):
            kind = f"{name}, {'regular' if regular else 'irregular'}"
            lines.append([kind])
            for sides in SIDES:
                hole = holes.many_sided(name, sides, 8 if setting.quick else N, regular)
                mine, method, theirs = measure(hole, of_baselines(setting, sides))
                mark = " *" if method == "polyharmonic_spline" else ""
                if not theirs:
                    lines[-1].append(short(mine) + mark)
                    continue
                best = min(theirs, key=theirs.get)
                makers |= {maker.split(",")[0] for maker in theirs}
                ratios[kind, sides] = mine / theirs[best]
                lines[-1].append(f"{short(mine)}{mark} / {short(theirs[best])} ({best})")
                print(kind, sides, lines[-1][-1], flush=True)
    text = "\n".join(rows(lines)) + "\n* the spline was chosen.\n"
    if ratios:
        worst = max(ratios, key=ratios.get)
        mean = np.exp(np.mean(np.log(list(ratios.values()))))
        text += f"\nOver the best of {', '.join(sorted(makers))} on each hole: geometric mean {short(mean)}, "
        text += f"at most {short(ratios[worst])} ({worst[0]}, {worst[1]} sides).\n"
    return text


def write(setting: Setting) -> None:
    write_table(setting, "mathematics/n-sides.md", "all at their defaults, no corners given", table(setting))
