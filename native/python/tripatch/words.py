"""What users read of fills and refusals: the same words on the command line and in Blender."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ._native import Report
from .errors import Refusal
from .messages import Message


def counted(number: int, word: str) -> str:
    """'1 hole', '2 holes' or '2 vertices'."""
    plural = f"{word[:-2]}ices" if word.endswith("vertex") else f"{word}s"
    return f"{number} {word if number == 1 else plural}"


def degrees(angle: float) -> str:
    """An angle in degrees, to two digits; the smallest that is reported is 0.001."""
    return f"{angle:.0f}°" if angle >= 99.5 else f"{max(angle, 0.001):.2g}°"


def length(value: float) -> str:
    """A length in scene units, to two digits."""
    return f"{value:.2g}" if value > 1e-9 else "0"


def candidates(report: Report, *, aligned: bool = True) -> list[Message]:
    """A line for each way to fill the hole, the one that is used first: 'used     side_vertex: expected error 0.002 (...)'.
    aligned: in columns, for letters of one width."""
    width, lines = max((len(each.method) for each in report.candidates if aligned), default=0), list[Message]()
    for each in report.candidates:
        status = f"{each.status:8}" if aligned else each.status
        gap = " " * (width - len(each.method))
        said: dict[str, Any] = {"status": status, "method": each.method, "gap": gap, "reason": each.why}
        if each.expected_error is not None:
            flaws = {"crosses": each.crosses, "folds": each.folds, "leaves": each.exceeds_hole_bounds}
            said |= {"error": length(each.expected_error)} | {name: int(value) for name, value in flaws.items() if value}
        lines.append(Message("candidate_skipped" if each.expected_error is None else "candidate_made", said))
    return lines


def _seams(reports: Sequence[Report]) -> tuple[list[float], list[float]]:
    """The seam angles of sides that are tangent to their surroundings, and of the others."""
    kept: list[float] = []
    others: list[float] = []
    for report in reports:
        for angle, continuity in zip(report.seam_angle_max_by_side, report.continuity, strict=True):
            (kept if continuity in ("G1", "G2") else others).append(angle)
    return kept, others


def seam_angle(reports: Sequence[Report]) -> float:
    """The seam angle of some fills, in degrees: the one number that messages, reports and pictures give."""
    return max(report.seam_angle_max for report in reports)


def filled(
    reports: Sequence[Report],
    *,
    cage_rim: str = "",
    quads: int = 0,
    triangles: int = 0,
    limit: bool = False,
    into: Sequence[str] = (),
    bend: float = float("inf"),
) -> str:
    """What became of holes: 'Filled 2 holes; seam within 0.3°'.

    A coarse mesh hardly defines its own tangent planes. If it defines them worse than the fill meets them, that is said too:
    'seam within 0.001° (accuracy of the mesh: 4°)'.

    Args:
        reports: of the filled holes.
        cage_rim: of fills that are cages.
        quads: how many faces cages, or fills with quads, have; triangles: how many of these are none.
        limit: the surroundings are a limit surface, which is known exactly.
        into: names of the objects that the fills became.
        bend: the largest angle, in degrees, between new faces and their neighbors across the rim: no seam bends by more.
    """
    if not reports:
        return Message("none_filled")
    said: dict[str, Any] = {"count": len(reports)}
    if cage_rim:
        said["quads"] = quads
        off = max(report.cage_deviation_max for report in reports)  # 0: none was fitted to a patch
        moved = max(report.surroundings_moved_max for report in reports)
        if off:
            said["distance"] = length(off)
        if off or moved:
            said["moved"] = length(moved)
        if cage_rim == "exact":
            said["seam"] = degrees(seam_angle(reports))
        return Message("cages_filled", said)
    kept, others = _seams(reports)
    if into:
        said["into"] = list(into)
    if kept:
        said["limit" if limit else "seam"] = degrees(max(kept))
        known = min(max(report.surroundings_error for report in reports), bend)
        if not limit and known > max(kept) and degrees(known) != degrees(max(kept)):
            said["accuracy"] = degrees(known)
    if others:
        said["bend"] = degrees(max(others))
    loose = max((report.seam_angle_max for report in reports if not report.continuity), default=0.0)
    if loose:  # triangles that are tangent to nothing
        said["angle"] = degrees(loose)
    if triangles:
        said |= {"triangles": triangles, "faces": quads}
    return Message("holes_filled", said)


def left_open(edges: Sequence[int], option: str = "") -> str:
    """'2 outer borders left open (200 and 310 edges); use --outer to fill them'; of none nothing.

    Args:
        edges: how many each of them has.
        option: the option of an interface that fills them.
    """
    if not edges:
        return ""
    said: dict[str, Any] = {"count": len(edges)} | ({"option": option} if option else {})
    if len(edges) > 1 and min(edges) == max(edges):
        return Message("borders_open_alike", said | {"edges": edges[0]})
    if len(edges) > 4:
        return Message("borders_open_many", said | {"fewest": min(edges), "most": max(edges)})
    return Message("borders_open", said | {"edges": sorted(edges)})


def nothing_to_fill(edges: Sequence[int], option: str = "") -> Message:
    """Why nothing is filled: the mesh has outer borders at most. Arguments as of `left_open`."""
    return Message("only_open_borders", {"reason": left_open(edges, option)}) if edges else Message("closed_mesh")


def joined(moved: int, splits: int) -> str:
    """'Joined borders: 12 vertices moved, 1 vertex put into an edge'."""
    counts = {name: count for name, count in (("moved", moved), ("splits", splits)) if count}
    return Message("borders_joined", counts | ({"both": 1} if len(counts) > 1 else {}))


def place(where: Sequence[float]) -> str:
    """'(0.5, 1, 2.25)', to four digits."""
    return f"({', '.join(f'{x:.4g}' for x in where)})"


def refused(refusal: Refusal) -> str:
    """The reason, with the vertices concerned if it does not name them itself: a `Message` if it has a code."""
    said = refusal.said
    if not refusal.where or (isinstance(said, Message) and said.names_vertices):
        return said
    return Message("at_vertices", {"reason": said}, refusal.where)


def gathered(told: Sequence[tuple[int, Sequence[str]]]) -> list[str]:
    """What is said of holes, of several ones each sentence once, with those that it is said of: 'Hole at vertex 4: ...',
    '2 holes at vertices 4 and 19: ...'.

    Args:
        told: of each hole a vertex of its rim, and sentences; of one that is not filled none.
    """
    holes: dict[str, list[int]] = {}
    for vertex, sentences in told:
        for sentence in sentences:
            holes.setdefault(sentence, []).append(vertex)
    if len(told) < 2:
        return list(holes)
    return [Message("of_holes", {"count": len(where), "reason": said}, where) for said, where in holes.items()]
