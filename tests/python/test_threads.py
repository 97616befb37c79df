"""Threads: their number changes no result, and a forked process has its own."""

import os
import subprocess
import sys
import threading

import numpy as np
import pytest
import tripatch
from shapes import octant


@pytest.fixture(autouse=True)
def as_at_first():
    yield
    tripatch.set_threads(None)


def fill_with(threads, **options):
    tripatch.set_threads(threads)
    vertices, faces, rim = octant(16)
    return tripatch.fill(vertices, faces, rim=rim, **options)


@pytest.mark.parametrize("options", [{}, {"fairing": "thin_plate", "resolution": 30}, {"method": "polyharmonic_spline"}])
def test_results_do_not_depend_on_the_number_of_threads(options):
    one = fill_with(1, **options)
    for threads in (2, 5, None):
        other = fill_with(threads, **options)
        assert np.array_equal(one.vertices, other.vertices)
        assert np.array_equal(one.normals, other.normals)
        assert np.array_equal(one.faces, other.faces)


@pytest.mark.parametrize("n", [0, -1])
def test_fewer_threads_than_one_are_a_value_error(n):
    with pytest.raises(ValueError, match="1 or more"):
        tripatch.set_threads(n)


def test_a_number_of_threads_is_whole():
    for n in (1.5, "a", True):
        with pytest.raises(TypeError, match=r"^n must be of type int \| None, not "):
            tripatch.set_threads(n)


def test_several_threads_that_fill_at_once_get_the_same():
    alone = fill_with(2)
    found = []
    others = [threading.Thread(target=lambda: found.append(fill_with(2))) for _ in range(6)]
    for thread in others:
        thread.start()
    for thread in others:
        thread.join()
    assert len(found) == 6
    assert all(np.array_equal(fill.vertices, alone.vertices) for fill in found)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system forks no processes")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_fills_as_the_one_it_comes_from():
    before = fill_with(3)
    child = os.fork()
    if child == 0:
        same = False
        try:
            same = np.array_equal(fill_with(3).vertices, before.vertices)
        finally:
            sys.stdout.flush()
            os._exit(0 if same else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert np.array_equal(fill_with(3).vertices, before.vertices)


@pytest.mark.skipif(sys.platform == "win32", reason="its programs say how large the stacks of threads are")
def test_half_a_megabyte_of_stack_is_enough_as_threads_of_macos_have():
    source = """
import threading
import test_threads

def fill_all():
    for options in ({}, {"output": "quads"}, {"fairing": "thin_plate", "resolution": 40}, {"method": "polyharmonic_spline"}):
        print(len(test_threads.fill_with(3, **options).faces))

threading.stack_size(512 * 1024)
thread = threading.Thread(target=fill_all)
thread.start()
thread.join()
"""
    command = ["sh", "-c", 'ulimit -s 512 && exec "$0" -c "$1"', sys.executable, source]  # threads of fills have the limit's size
    done = subprocess.run(command, cwd=os.path.dirname(__file__), stdout=subprocess.PIPE, text=True)
    assert (done.returncode, len(done.stdout.split())) == (0, 4)
