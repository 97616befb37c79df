"""Whatever takes long obeys Ctrl-C. How soon is not measured, but each of these takes many seconds where it does not obey."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap

import pytest

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")


@pytest.fixture(scope="module")
def octahedron():
    return (
        "vertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]\n"
        "faces = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]\n"
    )


@pytest.mark.parametrize(
    "work",
    [
        "tripatch.fill(vertices, faces, method='side_vertex', resolution=5000)",
        "tripatch.fill_all(vertices, faces, [[0, 1, 2]], method='side_vertex', resolution=5000)",
        "tripatch.fill(vertices, faces, method='side_vertex').patch.evaluate(np.full((20_000_000, 3), 1 / 3), 3)",
    ],
)
def test_ctrl_c_ends_it(work, octahedron):
    """SIGINT a little after the start; a program that does not look up continues for a minute and more."""
    script = "import os, signal, threading\nimport numpy as np\nimport tripatch\n" + octahedron
    script += "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # which jobs in the background have not
    script += "threading.Timer(0.7, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
    script += textwrap.dedent(f"""
        try:
            {work}
            print("it was done before")
        except KeyboardInterrupt:
            print("ended")
    """)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == "ended", done.stdout + done.stderr


def test_what_progress_raises_ends_a_fill_in_its_middle(octahedron):
    script = (
        "import tripatch\n"
        + octahedron
        + textwrap.dedent("""
        class Enough(Exception):
            pass
        def enough(done, total):
            raise Enough
        try:
            tripatch.fill_all(vertices, faces, [[0, 1, 2]], method="side_vertex", resolution=5000, progress=enough)
        except Enough:
            print("ended")
    """)
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == "ended", done.stdout + done.stderr
