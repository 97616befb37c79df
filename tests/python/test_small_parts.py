"""What is small and has no other test: bars, pixels. Each was changed by tests/mutation without a test's notice."""

from __future__ import annotations

import argparse
import io

import numpy as np
import pytest
import tripatch
from tripatch import between
from tripatch.arguments import reader
from tripatch.batch import pictures
from tripatch.batch.progress import Progress, duration
from tripatch.batch.settings import Settings
from tripatch.options import OPTIONS
from tripatch.view import Canvas


class Terminal(io.StringIO):
    def isatty(self):
        return True


def entries(count, **more):
    return [{"lines": [{"filled": 2, "status": "filled"}], **more} for _ in range(count)]


@pytest.mark.parametrize("columns", [30, 60, 80, 200])
def test_a_bar_is_as_full_as_the_run_and_fits_the_terminal(columns, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(columns))
    stream = Terminal()
    progress = Progress(4, stream)
    progress.add(entries(3, again=True))
    progress.end()
    said = stream.getvalue().rstrip("\n").split("\r")[-1]
    assert len(said) == columns - 1
    assert "3 of 4 files, 6 holes filled, 3 done before"[: columns - 1] in said
    if "[" in said:
        bar = said[said.index("[") + 1 : said.index("]")]
        assert 5 <= len(bar) <= 30
        assert bar == "#" * (len(bar) * 3 // 4) + "." * (len(bar) - len(bar) * 3 // 4)
    else:
        assert columns < 60


class Lines(io.StringIO):
    """What is written is there for others once it is flushed."""

    there = ""

    def flush(self):
        self.there = self.getvalue()


def test_lines_where_there_is_no_terminal():
    stream = Lines()
    progress = Progress(4, stream)
    progress.add(entries(4))
    progress.end()
    assert stream.there == "tripatch: 4 of 4 files, 8 holes filled\n"


@pytest.mark.parametrize(
    ("seconds", "text"), [(12.4, "12 s"), (59.6, "1 min 00 s"), (200, "3 min 20 s"), (3600, "1 h 00 min"), (7500, "2 h 05 min")]
)
def test_durations(seconds, text):
    assert duration(seconds) == text


def test_a_pixel_is_a_triangles_where_its_middle_is():
    """A square that is seen from above and fills 0.92 of the picture: 92 of 100 pixels each way, the same on all sides."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    canvas = Canvas(square, [0, 0, 1], 100, 100)
    canvas.draw(np.array([[0, 1, 2], [0, 2, 3]]))
    seen = canvas.triangle.reshape(100, 100) >= 0
    assert seen[4:96, 4:96].all() and seen.sum() == 92 * 92
    assert np.allclose(canvas.weights[canvas.triangle >= 0].sum(axis=1), 1)


def test_what_is_nearer_hides_what_lies_behind():
    """Two squares, one above the other and smaller, however they are ordered."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    points = np.concatenate([square, 0.25 + 0.5 * square + [0, 0, 1]])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    for order in ([0, 1, 2, 3], [2, 3, 0, 1]):
        canvas = Canvas(points, [0, 0, 1], 100, 100)
        canvas.draw(triangles[order])
        upper = np.isin(canvas.triangle.reshape(100, 100), np.flatnonzero(np.array(order) >= 2))
        assert upper[27:73, 27:73].all() and upper.sum() == 46 * 46


def test_the_seam_of_a_picture_is_what_fill_and_surroundings_share():
    """Two triangles around a fill of two: one edge of each with the fill, and that between the fill's own faces is none."""
    up, over = [0.0, 0, 1], [0.0, np.sin(np.radians(30)), np.cos(np.radians(30))]
    crop = {"around": [[0, 1, 4], [2, 3, 5]], "fill": [[1, 0, 2], [0, 3, 2]]}
    (a, b, degrees), second = pictures._seam(crop, np.array([up, up, over, up]))
    assert (a, b) == (0, 1) and abs(degrees - 30) < 1e-9
    assert second[:2] == (2, 3) and second[2] == 0


def test_each_hole_has_a_place_of_its_own_on_the_sheet(tmp_path, monkeypatch):
    """Six holes in two rows, each in one color: what is seen in each place, from corner to corner."""
    image = pytest.importorskip("PIL.Image")
    colors = [(40 * k + 20, 0, 200 - 30 * k) for k in range(6)]
    monkeypatch.setattr(pictures, "gathered", lambda holes, settings: list(colors))
    monkeypatch.setattr(pictures, "tile", lambda color, size: np.full((size, size, 3), color, np.uint8))
    line = {
        "input": "a.obj",
        "object": "",
        "vertex": 1,
        "edges": 3,
        "hole": 0,
        "crease_max": 1.0,
        "method": "",
        "triangles_folded": 0,
    }
    assert pictures.sheet(tmp_path / "a.png", [(line, 0)] * 6, Settings("", "", {}, ""), 9)
    picture = image.open(tmp_path / "a.png")
    assert picture.size == (1200, 34 + 2 * 346)
    for k, color in enumerate(colors):
        for inside in (5, 150, 294):
            seen = picture.getpixel((k % 4 * 300 + inside, 34 + k // 4 * 346 + inside))
            assert np.abs(np.subtract(seen, color)).max() <= 2


def test_pieces_of_one_curve_follow_each_other_only_apart_and_in_one_direction():
    assert between._follow((0.0, 0.4), (0.4, 1.0)) and between._follow((0.9, 0.5), (0.5, 0.1))
    assert not between._follow((0.0, 0.4), (1.0, 0.4))
    assert not between._follow((0.0, 0.7), (0.3, 1.0))


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("pole_offset", "1", "'1' cannot be read. Write, for example, 0.1,0"),
        ("center", "1,2", "'1,2' cannot be read. Write, for example, 0,0.5,1"),
    ],
)
def test_how_many_numbers_an_option_wants_is_said(name, text, said):
    with pytest.raises(argparse.ArgumentTypeError) as caught:
        reader(OPTIONS[name])(text)
    assert str(caught.value) == said


SHEET = tripatch.BezierRectangle([[[u, v, u * v] for v in (0.0, 1.0)] for u in (0.0, 1.0)])
SIDE = tripatch.Side(SHEET, 0)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: tripatch.Side.from_functions(1, 2, 3), "must be of type Callable"),
        (lambda: SIDE.evaluate([[0.5]]), r"t must have shape \(k,\), not \(1, 1\)"),
        (lambda: SIDE.evaluate([1.5]), "t must be from 0 to 1, not 1.5"),
        (lambda: tripatch.BezierRectangle([[[0, 0, 0]], [[0, 0, 0], [1, 1, 1]]]), "its rows differ in length"),
        (lambda: tripatch.fill([[0, 0, 0], [1, 0]], [[0, 1, 2]]), "its rows differ in length"),
        (
            lambda: tripatch.fill(np.zeros((4, 3)), np.zeros((2, 3, 3), int)),
            r"must have shape \(m, 3\) or \(m, 4\), not \(2, 3, 3\)",
        ),
    ],
)
def test_arguments_of_another_shape_are_refused_by_name(call, said):
    with pytest.raises((TypeError, ValueError), match=said):
        call()


@pytest.mark.parametrize("first", [0, 1, 2, 5])
def test_corners_of_a_border_are_where_it_turns(first):
    """A rectangle of four edges by three, begun anywhere."""
    around = (
        [(k, 0) for k in range(4)] + [(4, k) for k in range(3)] + [(4 - k, 3) for k in range(4)] + [(0, 3 - k) for k in range(3)]
    )
    inner = np.array([(x, y, 0) for x, y in around], float)
    n = len(inner)
    outer = inner + 0.5 * np.sign(inner - [2, 1.5, 0])
    faces = [[(k + 1) % n, k, n + k, n + (k + 1) % n] for k in range(n)]
    loop = np.roll(np.arange(n), -first)
    border = between.MeshBorder("Plate", np.concatenate([inner, outer]), faces, loop)
    turned = {tuple(p) for p in border.at(border.corners())[:, :2]}
    assert turned == {(0, 0), (4, 0), (4, 3), (0, 3)}
