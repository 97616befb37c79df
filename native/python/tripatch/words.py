"""What users read of fills and refusals: the same words on the command line and in Blender."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

from ._native import Report
from .candidates import Candidate
from .errors import Refusal
from .messages import Message


def counted(number: int, word: str) -> str:
    """'1 hole', '2 holes' or '2 vertices'."""
    plural = f"{word[:-2]}ices" if word.endswith("vertex") else f"{word}s"
    return f"{number} {word if number == 1 else plural}"


def suggested(word: str, known: Iterable[object]) -> str:
    """'. Did you mean --rim?', or nothing."""
    near = difflib.get_close_matches(word, [str(each) for each in known], n=1)
    return f". Did you mean {near[0]}?" if near else ""


def degrees(angle: float) -> str:
    """An angle in degrees, to two digits; the smallest that is reported is 0.001."""
    return f"{angle:.0f}°" if angle >= 99.5 else f"{max(angle, 0.001):.2g}°"


def length(value: float) -> str:
    """A length in scene units, to two digits."""
    return f"{value:.2g}" if value > 1e-9 else "0"


def _candidate(candidate: Candidate) -> str:
    if candidate.expected_error is None:
        return candidate.why
    flaws = [
        "crosses itself" if candidate.crosses else "",
        counted(candidate.folds or 0, "fold") if candidate.folds else "",
        "leaves the hole" if candidate.leaves_hole else "",
    ]
    error = f"expected error {length(candidate.expected_error)}"
    return ", ".join([error, *filter(None, flaws)]) + f" ({candidate.why})"


def candidates(report: Report) -> list[str]:
    """A line for each way to fill the hole, the one that is used first: 'used     side_vertex  expected error 0.002 (...)'."""
    width = max((len(each.method) for each in report.candidates), default=0)
    return [f"{each.status:8} {each.method:{width}} {_candidate(each)}" for each in report.candidates]


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
    count = len(reports)
    if not count:
        return "No hole filled"
    holes = "Filled 1 hole" if count == 1 else f"Filled {count} holes"
    kept, others = _seams(reports)
    if cage_rim:
        seam = seam_angle(reports)
        within = max(report.cage_deviation_max for report in reports)
        moved = max(report.surroundings_moved_max for report in reports)
        seam_said = f", seam within {degrees(seam)}" if cage_rim == "exact" else ""
        return (
            f"{holes} with a cage of {counted(quads, 'quad')}{seam_said}; within {length(within)} of the patch, "
            f"surroundings moved {length(moved)} (scene units)"
        )
    said = [f"{holes}{' in ' * bool(into)}{', '.join(into)}"]
    if kept and limit:
        said.append(f"seam with the limit surface within {degrees(max(kept))}")
    elif kept:
        known = min(max(report.surroundings_error for report in reports), bend)
        coarse = known > max(kept) and degrees(known) != degrees(max(kept))
        said.append(f"seam within {degrees(max(kept))}" + coarse * f" (accuracy of the mesh: {degrees(known)})")
    if others:
        said.append(f"bends by up to {degrees(max(others))} at sides met in position only")
    if triangles:
        said.append(f"{triangles} of {counted(quads, 'new face')} {'is a triangle' if triangles == 1 else 'are triangles'}")
    return "; ".join(said)


def left_open(edges: Sequence[int], advice: str = "") -> str:
    """'2 outer borders left open (200 and 310 edges); use --outer to fill them'; of none nothing.

    Args:
        edges: how many each of them has.
        advice: what fills them, in the words of an interface.
    """
    if not edges:
        return ""
    *others, last = map(str, sorted(edges))
    sizes = f"{', '.join(others)} and {last}" if others else last
    if len(edges) > 4:
        sizes = f"{min(edges)} to {max(edges)}"
    sizes += " edges"
    if len(edges) > 1 and min(edges) == max(edges):
        sizes = f"{last} edges each"
    said = f"{counted(len(edges), 'outer border')} left open ({sizes})"
    return f"{said}; {advice} to fill {'it' if len(edges) == 1 else 'them'}" if advice else said


def joined(moved: int, splits: int) -> str:
    """'Joined borders: 12 vertices moved, 1 vertex put into an edge'."""
    said = [f"{counted(moved, 'vertex')} moved"] * (moved > 0)
    if splits:
        said.append(f"{counted(splits, 'vertex')} put into {'an edge' if splits == 1 else 'edges'}")
    return f"Joined borders: {', '.join(said)}"


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
