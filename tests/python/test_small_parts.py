"""What is small and has no other test: bars, pixels. Each was changed by tests/mutation without a test's notice."""

from __future__ import annotations

import io

import numpy as np
import pytest
from tripatch.batch.progress import Progress, duration
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


def test_lines_where_there_is_no_terminal():
    stream = io.StringIO()
    progress = Progress(4, stream)
    progress.add(entries(4))
    progress.end()
    assert stream.getvalue() == "tripatch: 4 of 4 files, 8 holes filled\n"


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
