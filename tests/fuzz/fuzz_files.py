"""Bytes as mesh files: each is refused in a sentence, or read, and then loses nothing when it is written, a face more or not.

python tests/fuzz/fuzz_files.py [CORPUS] [options of libFuzzer], as scripts/fuzz does
"""

from __future__ import annotations

import io
import re
import sys
import warnings
from types import SimpleNamespace

import atheris

with atheris.instrument_imports(include=["tripatch"]):
    from tripatch import files
    from tripatch.files import _BINARY, FileError
    from tripatch.files.obj import ObjFile
    from tripatch.files.off import OffFile
    from tripatch.files.off_binary import BinaryOffFile
    from tripatch.files.ply import PlyFile
    from tripatch.files.stl import StlFile

import numpy as np

OWN = (ObjFile, OffFile, PlyFile, StlFile)
warnings.simplefilter("ignore")  # of numbers too large for what they become: the file says so


class Kept(io.BytesIO):
    """A file in memory as the formats write one: `path.open("wb")`, `path.write_bytes(...)`."""

    def open(self, _mode):
        return self

    def write_bytes(self, data):
        self.write(data)

    def __exit__(self, *_):
        pass


def read(kind, data):
    return BinaryOffFile(data) if kind is OffFile and re.match(_BINARY, data) else kind(data)


def written(mesh):
    kept = Kept()
    mesh._save(kept)
    return kept.getvalue()


def same(a, b):
    return np.array_equal(a.vertices, b.vertices, equal_nan=True) and a.faces == b.faces


def a_fill(mesh):
    """A point over the first face, joined to its edges."""
    rim, n = mesh.faces[0], len(mesh.vertices)
    fill = SimpleNamespace(rim=rim, rim_normals=np.tile([0.0, 0, 1], (len(rim), 1)), normals=np.array([[0.0, 0, 1]]))
    fill.vertices = np.array([[0.5, 0.25, 2]])
    fill.faces = [[n, a, b] for a, b in zip(rim, [*rim[1:], rim[0]])]
    fill.moved = np.zeros(0, np.int64), np.zeros((0, 3))
    fill.split_edges = np.zeros((0, 2), np.int64), np.zeros(0)
    return fill


def check_added(kind, data):
    mesh = read(kind, data)
    points, faces, fill = mesh.vertices.copy(), [list(face) for face in mesh.faces], a_fill(mesh)
    try:
        mesh.append(fill)
        after = written(mesh)
    except FileError:
        return
    again = read(kind, after)
    assert again.faces == faces + fill.faces, (faces, again.faces)
    assert np.array_equal(again.vertices[:-1], points, equal_nan=True), (points, again.vertices)
    assert np.allclose(again.vertices[-1], fill.vertices[0], rtol=0, atol=1e-6)


def one(data):
    if not data:
        return
    kind, data = OWN[data[0] % len(OWN)], data[1:]
    try:
        mesh = read(kind, data)
    except FileError as error:
        assert str(error)[:1].isupper() and len(str(error)) > 10, error
        return
    assert mesh.vertices.ndim == 2 and mesh.vertices.shape[1] == 3 and mesh.vertices.dtype == np.float64
    assert all(len(face) >= 3 and 0 <= min(face) and max(face) < len(mesh.vertices) for face in mesh.faces)
    if kind is not StlFile:  # whose vertices are numbered by what is there
        assert same(read(kind, written(mesh)), mesh), "written, it is another mesh"
        if mesh.faces:
            check_added(kind, data)
    for suffix in (".obj", ".off", ".ply"):
        with np.errstate(all="ignore"):
            other = files.converted(mesh, suffix)
        assert same(read(type(other), written(other)), mesh), f"as {suffix} it is another mesh"


if __name__ == "__main__":
    atheris.Setup(sys.argv, one)
    atheris.Fuzz()
