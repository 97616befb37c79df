# SPDX-License-Identifier: GPL-3.0-or-later
"""What became of holes: fills with their reports, refusals, and what is said of them."""

from __future__ import annotations

from dataclasses import dataclass, field

from . import selection, sentences
from .library import tripatch, words


def _of_object(name, said):
    """What is said of an object, with its name if there is one."""
    return tripatch.Message("of_object", {"name": name, "reason": said}) if name else said


@dataclass
class Refused:
    """A hole, or a part of a selection, that is not filled."""

    sentence: str
    vertices: list = field(default_factory=list)  # indices of those concerned: a BMVert ends with the Python object of its BMesh
    ob: object = None  # the object that they are of
    rim: object = None  # of a hole: its Rim, of use while its BMesh is as it was

    @classmethod
    def because(cls, reason, ob):
        """From an UnusableError or OptionsError, while its BMesh is there."""
        return cls(reason.said, [v.index for v in reason.vertices if v.is_valid], ob)

    def of(self, name):
        """The same with the name of its object, if there is one."""
        return Refused(_of_object(name, self.sentence), self.vertices, self.ob)


@dataclass
class Outcome:
    """What became of the holes of one mesh or of several."""

    reports: list = field(default_factory=list)  # tripatch.Report of each filled hole
    passages: list = field(default_factory=list)  # for each a place where it passes through the mesh, or None
    refused: list = field(default_factory=list)  # Refused
    notes: list = field(default_factory=list)  # sentences on holes that were filled
    faces: int = 0
    triangles: int = 0  # among them, where quads were to be made
    rim_edges: list = field(default_factory=list)  # of each filled hole
    diameters: list = field(default_factory=list)  # likewise, in the world
    cage_rim: str = ""  # of fills that are cages
    objects: list = field(default_factory=list)  # names of objects made
    live: list = field(default_factory=list)  # names of live fills made
    instead: bool = False  # others than were asked for
    left_out: list = field(default_factory=list)  # names of options that were set, and that cages were made without
    left_open: list = field(default_factory=list)  # how many edges each outer border has that is left open

    def add(self, other, name=""):
        self.reports += other.reports
        self.passages += other.passages
        self.refused += [refused.of(name) for refused in other.refused]
        self.notes += [_of_object(name, sentence) for sentence in other.notes]
        self.faces += other.faces
        self.triangles += other.triangles
        self.rim_edges += other.rim_edges
        self.diameters += other.diameters
        self.cage_rim = other.cage_rim or self.cage_rim
        self.objects += other.objects
        self.live += other.live
        self.instead = self.instead or other.instead
        self.left_out += other.left_out
        self.left_open += other.left_open

    def alarms(self):
        """Whether there is something that a person should look at, or can mend."""
        return (
            any(report.is_flawed for report in self.reports)
            or any(self.passages)
            or self.instead
            or any(map(sentences.can_be_mended, self.notes))
        )

    def count(self, faces, output):
        """The new faces, as lists of vertices or corners."""
        self.faces = len(faces)
        self.triangles = sum(len(face) == 3 for face in faces) if output == "quads" else 0

    def density(self, output):
        """What was computed where none was asked for: edges of new faces along a side, extra rows of quads; None: not known."""
        if output != "triangles":
            return max((report.rows for report in self.reports), default=None)
        # As many edges around as the rim has: the library counts them as three sides where the patch has no sides of its own.
        sides = [(r.method == "multi_sided" and len(r.corners)) or 3 for r in self.reports]
        return max((max(1, round(n / k)) for n, k in zip(self.rim_edges, sides, strict=True)), default=None)

    def sentence(self, option=selection.OUTER):
        """'Filled 2 holes; seam within 0.3°'"""
        said = words.filled(
            self.reports,
            cage_rim=self.cage_rim,
            quads=self.faces,
            triangles=self.triangles,
            limit=bool(self.objects),
            into=self.objects + self.live,
        )
        return "; ".join(filter(None, (said, words.left_open(self.left_open, option))))
