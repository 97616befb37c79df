"""Mesh files: what is in them stays in them, and the fills are added."""

from __future__ import annotations

import re
import struct
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from systems import missing_file
from tripatch import files
from tripatch.files import FileError

# A square frame in the plane: outer vertices 0-3, inner 4-7, and four quads around the hole 4, 5, 6, 7.
FRAME = np.array([[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [1, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]], float)
QUADS = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
TRIANGLES = [t for a, b, c, d in QUADS for t in ([a, b, c], [a, c, d])]


def fan(rim, n, place=(1.5, 1.25, 0.1), moved=(), split=()):
    """A fill of triangles around one new vertex, nearest to the first two of the rim; moved: pairs of vertex and place; split: an
    edge and where, which takes that vertex."""
    up = np.array([[0.0, 0.0, 1.0]])
    return SimpleNamespace(
        vertices=np.array([place]),
        normals=up,
        faces=[[a, b, n] for a, b in zip(rim, rim[1:] + rim[:1])],
        rim=np.array(rim),
        rim_normals=np.repeat(up, len(rim), axis=0),
        split_edges=([edge for edge, _ in split], [t for _, t in split]),
        moved=([v for v, _ in moved], np.array([p for _, p in moved], float).reshape(-1, 3)),
    )


def filled(data: bytes, name: str, tmp_path, fills=None) -> bytes:
    path, out = tmp_path / name, tmp_path / ("out_" + name)
    path.write_bytes(data)
    mesh = files.read(path)
    for fill in fills or [fan([4, 5, 6, 7], 8)]:
        mesh.append(fill)
    mesh.write(out)
    return out.read_bytes()


def reread(data: bytes, name: str, tmp_path):
    path = tmp_path / name
    path.write_bytes(data)
    return files.read(path)


def refused(data: bytes, name: str, tmp_path) -> str:
    with pytest.raises(FileError) as error:
        reread(data, name, tmp_path)
    return str(error.value)


# ---------------------------------------------------------------------------------------------------- OBJ


def test_a_backslash_before_a_space_continues_no_line_of_a_new_vertex(tmp_path):
    """Found by fuzzing: a new vertex repeats what the file says of the nearest, and its line swallowed the face after it."""
    data = b"v 0 0 0\nv 1 0 0 beside \\ \nv 0 1 0\nf 1 2 3\n"
    after = filled(data, "a.obj", tmp_path, [fan([0, 1, 2], 3, (0.9, 0.1, 1))])
    assert b"v 0.9 0.1 1.0 beside \\ \n" in after
    assert reread(after, "b.obj", tmp_path).faces == [[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


OBJ_V = b"".join(b"v %d %d %d\n" % tuple(p) for p in FRAME.astype(int))
OBJ = OBJ_V + b"".join(b"f " + b" ".join(b"%d" % (v + 1) for v in q) + b"\n" for q in QUADS)


def test_obj_plain(tmp_path):
    out = filled(OBJ, "a.obj", tmp_path)
    assert out == OBJ + b"v 1.5 1.25 0.1\nf 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n"


def test_obj_keeps_comments_groups_materials_texture_coordinates(tmp_path):
    data = (
        b"# made by hand \xff\xfe\nmtllib a.mtl\no Thing\n" + OBJ_V + b"vt 0 0\nvt 1 0\nvt 0.5 1\nvn 0 0 1\n"
        b"g frame\nusemtl red\ns 1\nf 1/1/1 2/2/1 6/3/1 5/1/1\nf 2//1 3//1 7//1 6//1\nl 1 2\nf -6/1/-1 -5/2/-1 -1/3/-1 -2/1/-1\n"
        b"f 4/1/1 \\\n 1/2/1 5/3/1 8/1/1 # the last\nusemtl blue\ng other\nv 9 9 9\nf 1 2 3\nunknown 1 2 3"
    )
    mesh = reread(data, "a.obj", tmp_path)
    assert mesh.faces == [*QUADS, [0, 1, 2]]
    assert len(mesh.vertices) == 9
    out = filled(data, "a.obj", tmp_path, [fan([4, 5, 6, 7], 9)])
    assert out.startswith(data + b"\n")
    added = out[len(data) + 1 :].decode().splitlines()
    assert added[0] == "v 1.5 1.25 0.1"
    assert added[1:6] == ["vn 0.0 0.0 1.0"] * 5  # four at the rim, one inside
    assert added[6:8] == ["g frame", "usemtl red"]  # those of the faces around
    assert added[8:] == ["f 5//2 6//3 10//6", "f 6//3 7//4 10//6", "f 7//4 8//5 10//6", "f 8//5 5//2 10//6"]


def test_obj_line_ends_and_a_missing_last_one(tmp_path):
    data = OBJ.replace(b"\n", b"\r\n")[:-2]
    out = filled(data, "a.obj", tmp_path)
    assert out.startswith(data + b"\r\nv 1.5 ")
    assert out.count(b"\n") == out.count(b"\r\n") == 12 + 5
    assert reread(out, "b.obj", tmp_path).faces[-1] == [7, 4, 8]


def test_obj_vertex_colors_are_blended(tmp_path):
    data = re.sub(rb"(?m)^(v 2 1 0)$", rb"\1 0.25 0.5 1", OBJ)
    data = re.sub(rb"(?m)^(v \d \d \d)$", rb"\1 1 1 1", data)
    out = filled(data, "a.obj", tmp_path, [fan([4, 5, 6, 7], 8, (1.9, 1.2, 0))])
    (red, green, blue) = re.search(rb"(?m)^v 1.9 1.2 0.0 (\S+) (\S+) (\S+)$", out).groups()
    assert 0.25 < float(red) < 0.6 and 0.5 < float(green) < 0.8 and blue == b"1"  # vertex 5 is the nearest


MOVED = fan([4, 5, 6, 7], 8, moved=[(5, (2.5, 1, 0.125)), (6, (2, -0.5, 1e-3))])


def test_obj_moved_vertices(tmp_path):
    data = OBJ.replace(b"v 2 1 0\n", b"v  2 \\\n\t1 0 0.25 0.5 1 # red\n")
    out = filled(data, "a.obj", tmp_path, [MOVED])
    expected = data.replace(b"v  2 \\\n\t1 0 0.25", b"v  2.5 \\\n\t1.0 0.125 0.25").replace(b"v 2 2 0\n", b"v 2.0 -0.5 0.001\n")
    assert out.startswith(expected + b"v 1.5 1.25 0.1")


def test_off_moved_vertices(tmp_path):
    data = b"COFF\n8 4 0 # a comment\n" + b"".join(b"%d %d %d  9 8 7 # %d\n" % (*p, k) for k, p in enumerate(FRAME.astype(int)))
    data += b"".join(b"4 %d %d %d %d\n" % tuple(q) for q in QUADS)
    out = filled(data, "a.off", tmp_path, [MOVED])
    assert b"\n2.5 1.0 0.125  9 8 7 # 5\n2.0 -0.5 0.001  9 8 7 # 6\n1 2 0  9 8 7 # 7\n" in out


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_moved_vertices(form, tmp_path):
    head = f"ply\nformat {form} 1.0\nelement vertex 8\nproperty uchar red\nproperty list uchar int tags\nproperty double x\n"
    head += "property double y\nproperty float z\nproperty float w\nelement face 4\n"
    head += "property list uchar int vertex_indices\nend_header\n"
    if form == "ascii":
        body = b"".join(b"%d 2 5 6   %d %d %d 0.10\n" % (k, *p) for k, p in enumerate(FRAME.astype(int)))
        body += b"".join(b"4 %d %d %d %d\n" % tuple(q) for q in QUADS)
    else:
        order = "<" if "little" in form else ">"
        body = b"".join(struct.pack(f"{order}BB2i2d2f", k, 2, 5, 6, *p, 0.1) for k, p in enumerate(FRAME))
        body += b"".join(struct.pack(f"{order}B4i", 4, *q) for q in QUADS)
    data = head.encode() + body
    out = filled(data, "a.ply", tmp_path, [MOVED])
    wanted = FRAME.copy()
    wanted[5], wanted[6] = MOVED.moved[1]
    assert np.abs(reread(out, "b.ply", tmp_path).vertices[:8] - wanted).max() < 1e-9
    if form == "ascii":
        assert b"\n5 2 5 6   2.5 1.0 0.125 0.10\n6 2 5 6   2.0 -0.5 0.001 0.10\n7 2 5 6   1 2 0 0.10\n" in out
    else:
        size = struct.calcsize("<BB2i2d2f")
        given_body, found = data[len(head) :], out[out.index(b"end_header\n") + 11 :]
        for k in (0, 1, 2, 3, 4, 7):
            assert found[k * size : (k + 1) * size] == given_body[k * size : (k + 1) * size]
        assert found[5 * size : 5 * size + 10] == given_body[5 * size : 5 * size + 10]


SPLIT = fan([4, 5, 6, 7], 8, split=[((6, 5), 0.25)])  # of the second quad


def test_obj_split_face(tmp_path):
    data = OBJ_V + b"vt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 1\nvn 0 0 1\nusemtl red\nf 1 2 6 5\nusemtl blue\n"
    data += b"f -7/-4/1 \\\n -6/-3/1 -2/-2/1 -3/-1/1 # mine\nusemtl red\n"
    data += b"".join(b"f " + b" ".join(b"%d" % (v + 1) for v in q) + b"\n" for q in QUADS[2:])
    out = filled(data, "a.obj", tmp_path, [SPLIT])
    kept, added = out[: out.index(b"v 1.5")], out[out.index(b"v 1.5") :].splitlines()
    assert kept == data.replace(b"f -7/-4/1 \\\n -6/-3/1 -2/-2/1 -3/-1/1 # mine", b"# mine")
    assert b"vt 0.875 1.0" in added  # a quarter of the way from the third corner to the fourth
    at = added.index(b"f 2/1/1 3/2/1 7/3/1 9/5/1 6/4/1")
    assert b"usemtl blue" in added[:at] and added[at - 1] == b"vt 0.875 1.0"
    assert reread(out, "b.obj", tmp_path).faces[-1] == [1, 2, 6, 8, 5]


def test_obj_texture_coordinates_where_faces_are_split(tmp_path):
    """Of an edge that is named against the face's direction, in faces without normals, one of which is written over two lines."""
    data = OBJ_V + b"vt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 1\nf 1 2 6 5\nf 2/1 3/2\\\n7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4 1\\\n5 8\n"
    second = fan([4, 5, 6, 7], 8, split=[((7, 6), 0.5)])  # of the third quad
    out = filled(data, "a.obj", tmp_path, [fan([4, 5, 6, 7], 8, split=[((5, 6), 0.25)]), second])
    kept, added = out[: out.index(b"v 1.5")], out[out.index(b"v 1.5") :].splitlines()
    assert kept.split() == data.replace(b"f 2/1 3/2\\\n7/3 6/4\nf 3/1 4/2 8/3 7/4", b"").split()
    assert (
        b"vt 0.625 1.0" in added and b"f 2/1 3/2 7/3 9/5 6/4" in added
    )  # three quarters of the way from the third to the fourth
    assert b"vt 0.75 1.0" in added and b"f 3/1 4/2 8/3 10/6 7/4" in added
    assert reread(out, "b.obj", tmp_path).faces[1] == [3, 0, 4, 7]


@pytest.mark.parametrize("third", [b"vt 1 1/31", b"vt 1 1 0", b""])
def test_obj_face_split_between_texture_coordinates_that_are_none_or_differ_in_kind(tmp_path, third):
    """The new corner has those of the one before it."""
    data = OBJ_V + b"vt 0 0\nvt 1 0\nvt 1 1\n" + third + b"\nf 1 2 6 5\nf 2/1 3/2 7/3 6/4\nf 3 4 8 7\nf 4 1 5 8\n"
    out = filled(data, "a.obj", tmp_path, [SPLIT])
    assert b"f 2/1 3/2 7/3 9/3 6/4" in out.splitlines()
    assert out.count(b"vt ") == data.count(b"vt ")


def test_off_split_face(tmp_path):
    data = b"OFF\n8 4 0\n" + b"".join(b"%d %d %d\n" % tuple(p) for p in FRAME.astype(int))
    data += b"".join(b" 4  %d %d %d %d  255 0 %d # c\n" % (*q, k) for k, q in enumerate(QUADS))
    out = filled(data, "a.off", tmp_path, [SPLIT])
    assert b"\n 5  1 2 6 8 5  255 0 1 # c\n 4  2 3 7 6  255 0 2 # c\n" in out
    assert reread(out, "b.off", tmp_path).faces[1] == [1, 2, 6, 8, 5]


@pytest.mark.parametrize("order,colors", [(">", True), ("<", False)])
def test_off_binary_without_faces_is_of_the_documented_form_or_of_pmp(order, colors, tmp_path):
    body = struct.pack(order + "3i", 8, 0, 0) + FRAME.astype(order + "f4").tobytes()
    mesh = reread(b"OFF BINARY\n" + body, "a.off", tmp_path)
    assert np.array_equal(mesh.vertices, FRAME) and not mesh.faces
    assert (mesh._order, mesh._colors) == (order, colors)
    many = struct.pack(order + "3i", 1000, 1, 0) + body[12:]
    assert "damaged" in refused(b"OFF BINARY\n" + many, "a.off", tmp_path)


@pytest.mark.parametrize("kind", [b"4OFF", b"nOFF", b"4nOFF"])
def test_off_binary_of_other_dimensions_is_refused(kind, tmp_path):
    assert "damaged" in refused(kind + b" BINARY\n" + bytes(12), "a.off", tmp_path)


def test_the_face_that_names_no_vertex_is_named(tmp_path):
    data = b"OFF\n8 3 0\n" + b"".join(b"%d %d %d\n" % tuple(p) for p in FRAME.astype(int))
    for wrong in (b"8", b"-1"):
        assert "Face 1 names" in refused(data + b"3 0 1 2\n4 0 1 2 " + wrong + b"\n3 0 1 2\n", "a.off", tmp_path)


@pytest.mark.parametrize("colors", [False, True])
def test_off_binary_moved_vertices_and_split_face(colors, tmp_path):
    order = ">" if colors else "<"  # Geomview's form, and pmp's
    data = b"NOFF BINARY\n" + struct.pack(order + "3i", 8, 4, 0)
    data += b"".join(struct.pack(order + "6f", *p, 0, 0, -1) for p in FRAME)
    for k, q in enumerate(QUADS):
        data += struct.pack(order + "5i", 4, *q) + (struct.pack(order + "i2f", 2, 0.5, k) if colors else b"")
    moved = reread(filled(data, "a.off", tmp_path, [MOVED]), "b.off", tmp_path)
    assert moved.vertices[5].tolist() == [2.5, 1, 0.125] and (moved.vertices[:5] == FRAME[:5]).all()
    split = filled(data, "c.off", tmp_path, [SPLIT])
    assert reread(split, "d.off", tmp_path).faces[1] == [1, 2, 6, 8, 5]
    assert struct.pack(order + "6i", 5, 1, 2, 6, 8, 5) + (struct.pack(order + "i2f", 2, 0.5, 1) if colors else b"") in split
    assert struct.pack(order + "3f", 0, 0, 1) in split  # the new vertex's normal


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_split_face(form, tmp_path):
    head = f"ply\nformat {form} 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\nelement face 4\n"
    head += "property uchar red\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
    uv = [0, 0, 1, 0, 1, 1, 0.5, 1]
    if form == "ascii":
        body = b"".join(b"%d %d %d\n" % tuple(p) for p in FRAME.astype(int))
        body += b"".join(b"7 4 %d %d %d %d 8 0 0 1 0 1 1 0.5 1\n" % tuple(q) for q in QUADS)
    else:
        order = "<" if "little" in form else ">"
        body = FRAME.astype(order + "f8").tobytes()
        body += b"".join(struct.pack(f"{order}BB4iB8f", 7, 4, *q, 8, *uv) for q in QUADS)
    out = filled(head.encode() + body, "a.ply", tmp_path, [SPLIT])
    mesh = reread(out, "b.ply", tmp_path)
    assert mesh.faces[:4] == [QUADS[0], [1, 2, 6, 8, 5], *QUADS[2:]]
    row = mesh._row(mesh._face, 1)
    assert row[0] == 7 and np.allclose(row[2], [0, 0, 1, 0, 1, 1, 0.875, 1, 0.5, 1])
    assert mesh._row(mesh._face, 2)[2] == pytest.approx(uv)


@pytest.mark.parametrize("suffix", [".vtk", ".vtu"])
def test_meshio_split_face(suffix, tmp_path):
    meshio = pytest.importorskip("meshio")
    path = tmp_path / f"a{suffix}"
    cells = [("quad", np.array(QUADS))]
    meshio.Mesh(FRAME, cells, cell_data={"kind": [np.array([1, 2, 3, 4])]}).write(path)
    mesh = files.read(path)
    mesh.append(SPLIT)
    mesh.write(tmp_path / f"b{suffix}")
    back = meshio.read(tmp_path / f"b{suffix}")
    kinds = {
        tuple(sorted(face)): int(kind)
        for b, k in zip(back.cells, back.cell_data["kind"])
        for face, kind in zip(b.data.tolist(), k)
    }
    assert kinds[1, 2, 5, 6, 8] == 2 and kinds[0, 1, 4, 5] == 1 and kinds[2, 3, 6, 7] == 3
    assert files.read(tmp_path / f"b{suffix}").faces.count([1, 2, 6, 8, 5]) == 1


def test_obj_several_fills(tmp_path):
    out = filled(OBJ, "a.obj", tmp_path, [fan([4, 5, 6, 7], 8), fan([4, 5, 6, 7], 8)])
    assert reread(out, "b.obj", tmp_path).faces[-8:] == fan([4, 5, 6, 7], 8).faces + fan([4, 5, 6, 7], 9).faces


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (b"v 1 2\n", "Line 1 of the file cannot be read: v 1 2"),
        (b"v 1 2 x\n", "Line 1 of the file cannot be read"),
        (b"v 0 0 0\nf 1 1 0\n", "Line 2 of the file cannot be read"),
        (b"v 0 0 0\nf 1 1 2\n", "Face 0 names a vertex that does not exist"),
        (b"v 0 0 0\nf -1 -1 -2\n", "Face 0 names a vertex that does not exist"),
        (b"v 0 0 0\nf 1 a 1\n", "Line 2 of the file cannot be read"),
    ],
)
def test_obj_errors(line, said, tmp_path):
    assert said in refused(line, "a.obj", tmp_path)


coordinate = st.floats(allow_nan=False, allow_infinity=False).map(lambda x: repr(x))
space = st.sampled_from([" ", "  ", "\t"])
line_ends = "\r\n\\\x0b\x0c\x1c\x1d\x1e\x85\u2028\u2029"
junk = st.one_of(
    st.text(st.characters(codec="utf-8", exclude_characters=line_ends), max_size=20).map("# {}".format),
    st.sampled_from(["", "   ", "vt 0.5 0.5", "vp 1 2", "l 1 2", "p 1", "g a b", "s off", "s 3", "usemtl m", "o thing", "end"]),
)


@st.composite
def obj_files(draw):
    """Lines of an OBJ, with the vertices and faces that are in it."""
    lines, vertices, faces = [], [], []
    for _ in range(draw(st.integers(0, 25))):
        kind = draw(st.sampled_from("vvfj"))
        if kind == "v":
            p = [draw(coordinate) for _ in range(3)]
            vertices.append([float(x) for x in p])
            lines.append(draw(space).join(["v", *p]) + draw(st.sampled_from(["", " ", " 1 0 0"])))
        elif kind == "f" and vertices:
            face = draw(st.lists(st.integers(0, len(vertices) - 1), min_size=3, max_size=6))
            faces.append(face)
            suffix = draw(st.sampled_from(["", "/7", "//8", "/7/8", "/"]))
            words = [str(v + 1 if draw(st.booleans()) else v - len(vertices)) + suffix for v in face]
            gap = draw(st.sampled_from([" ", "\t", " \\\n "]))
            lines.append(gap.join(["f", *words]))
        else:
            lines.append(draw(junk))
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    data = end.join(lines).replace("\n", end if end != "\r" else "\n") if end != "\r" else "\n".join(lines)
    return (data + draw(st.sampled_from(["", "\n"]))).encode(), vertices, faces


@settings(max_examples=200, deadline=None)
@given(obj_files())
def test_obj_round_trip(tmp_path_factory, case):
    data, vertices, faces = case
    folder = tmp_path_factory.mktemp("obj")
    mesh = reread(data, "a.obj", folder)
    assert mesh.vertices.tolist() == vertices
    assert mesh.faces == faces
    mesh.write(folder / "same.obj")
    assert (folder / "same.obj").read_bytes() == data
    if len(vertices) < 3:
        return
    fill = fan([0, 1, 2], len(vertices))
    mesh.append(fill)
    mesh.write(folder / "out.obj")
    out = (folder / "out.obj").read_bytes()
    assert out.startswith(data)
    again = files.read(folder / "out.obj")
    assert again.vertices.tolist() == [*vertices, list(fill.vertices[0])]
    # by group
    assert again.faces[: len(faces)] == faces and sorted(again.faces[len(faces) :]) == sorted(fill.faces)


# ---------------------------------------------------------------------------------------------------- OFF


@pytest.mark.parametrize("one", ["+1", "0_1", "01"])
def test_counts_of_an_off_file_go_up_however_they_are_written(one, tmp_path):
    """Found by fuzzing: a count with a sign stayed, and the new faces were not read again."""
    data = f"OFF 3 {one} 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".encode()
    after = filled(data, "a.off", tmp_path, [fan([0, 1, 2], 3)])
    assert len(reread(after, "b.off", tmp_path).faces) == 4


OFF = (
    b"OFF # a frame\n# counts follow\n8 4 12\n\n"
    + b"".join(b"%d %d %d\n" % tuple(p) for p in FRAME.astype(int))
    + b"# faces\n"
    + b"".join(b"4 %d %d %d %d 255 0 0\n" % tuple(q) for q in QUADS)
    + b"# end\n"
)


def test_off_keeps_all_lines_but_the_counts(tmp_path):
    out = filled(OFF, "a.off", tmp_path)
    expected = OFF.replace(b"8 4 12\n", b"9 8 16\n").replace(b"# faces", b"1.5 1.25 0.1\n# faces")
    new = b"".join(b"3 %d %d %d 255 0 0\n" % tuple(f) for f in fan([4, 5, 6, 7], 8).faces)
    assert out == expected.replace(b"# end", new + b"# end")
    mesh = reread(out, "b.off", tmp_path)
    assert mesh.faces == QUADS + fan([4, 5, 6, 7], 8).faces
    assert (mesh.vertices[:8] == FRAME).all()


def test_off_colors_and_normals(tmp_path):
    rows = b"".join(b"%d %d %d 0 0 -1 %d 0 0 255\n" % (*p, k) for k, p in enumerate(FRAME.astype(int)))
    data = b"CNOFF 8 4 0\r\n" + rows + b"".join(b"4 %d %d %d %d\n" % tuple(q) for q in QUADS)[:-1]
    out = filled(data, "a.off", tmp_path)
    assert b"CNOFF 9 8 0\r\n" in out  # edges were not counted
    assert b"\n1.5 1.25 0.1 0.0 0.0 1.0 5 0 0 255\r\n" in out  # 4 and 5 are the nearest, 6 and 7 the others
    assert len(reread(out, "b.off", tmp_path).faces) == 8


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "The OFF file is damaged"),
        (b"PLY\n", "The OFF file is damaged"),
        (b"OFF BINARY\n\0\0", "binary OFF"),
        (b"4OFF\n0 0 0\n", "OFF 4OFF files cannot be read"),
        (b"OFF\n9 4 0\n0 0 0\n", "announces 13 entries"),
        (b"OFF\n1 1 0\n0 0 0\n3 0 0\n", "The OFF file is damaged"),
        (b"OFF\n1 1 0\n0 0 x\n3 0 0 0\n", "The OFF file is damaged"),
        (b"OFF\n1 1 0\n0 0 0\n3 0 0 7\n", "names a vertex that does not exist"),
    ],
)
def test_off_errors(data, said, tmp_path):
    assert said in refused(data, "a.off", tmp_path)


# ---------------------------------------------------------------------------------------------------- PLY


def ply(form: str, index: str = "vertex_indices", triangles: bool = False) -> bytes:
    """A frame with normals, colors, face flags, another element and comments."""
    faces = (
        [[a, b, c] for a, b, c, d in QUADS for a, b, c in ([a, b, c], [a, c, d])]
        if triangles
        else [*QUADS[:3], [3, 0, 4], [3, 4, 7]]
    )
    head = f"ply\nformat {form} 1.0\ncomment keep me\nobj_info and me\nelement vertex 8\n"
    head += "".join(f"property float {c}\n" for c in ("x", "y", "z", "nx", "ny", "nz"))
    head += "property uchar red\nproperty double weight\n"
    head += f"element face {len(faces)}\nproperty uchar flag\nproperty list uchar int {index}\n"
    head += "property list uchar float texcoord\n"
    head += "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    if form == "ascii":
        rows = [f"{x:g} {y:g} {z:g} 0 0 1 {200 + k} 0.1" for k, (x, y, z) in enumerate(FRAME)]
        rows += [f"7 {len(f)} {' '.join(map(str, f))} 2 0.5 0.5" for f in faces] + ["0 1"]
        return (head + "\n".join(rows) + "\n").encode()
    o = "<" if "little" in form else ">"
    body = b"".join(struct.pack(o + "6fBd", *p, 0, 0, 1, 200 + k, 0.1) for k, p in enumerate(FRAME))
    body += b"".join(struct.pack(f"{o}BB{len(f)}iBff", 7, len(f), *f, 2, 0.5, 0.5) for f in faces)
    return head.encode() + body + struct.pack(o + "ii", 0, 1)


@pytest.mark.parametrize("triangles", [False, True])
@pytest.mark.parametrize("index", ["vertex_indices", "vertex_index"])
@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_keeps_everything(form, index, triangles, tmp_path):
    data = ply(form, index, triangles)
    count = 8 if triangles else 5
    old = reread(data, "a.ply", tmp_path)
    assert (old.vertices == FRAME).all()
    assert len(old.faces) == count
    out = filled(data, "a.ply", tmp_path)
    head, body = data.split(b"end_header\n")
    new_head, new_body = out.split(b"end_header\n")
    assert new_head == head.replace(b"vertex 8", b"vertex 9").replace(b"face %d" % count, b"face %d" % (count + 4))
    fill = fan([4, 5, 6, 7], 8)
    o = "<" if "little" in form else ">"
    if form == "ascii":
        lines = body.splitlines()
        expected = lines[:8] + [b"1.5 1.25 0.1 0.0 0.0 1.0 205 0.1"] + lines[8 : 8 + count]
        expected += [b"7 3 %d %d %d 0" % tuple(f) for f in fill.faces] + lines[8 + count :]
        assert new_body.splitlines() == expected
    else:
        cut = 8 * 33
        vertex = struct.pack(o + "6fBd", 1.5, 1.25, 0.1, 0, 0, 1, 205, 0.1)
        faces = b"".join(struct.pack(o + "BB3iB", 7, 3, *f, 0) for f in fill.faces)
        assert new_body == body[:cut] + vertex + body[cut:-8] + faces + body[-8:]
    again = reread(out, "b.ply", tmp_path)
    assert again.faces == old.faces + fill.faces
    assert np.allclose(again.vertices[8], [1.5, 1.25, 0.1], atol=1e-7)


@pytest.mark.parametrize("there", [False, True])
@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_deviation(form, there, tmp_path):
    data = ply(form)
    if there:
        data = data.replace(b"double weight", b"double deviation")
    path = tmp_path / "a.ply"
    path.write_bytes(data)
    plain = files.read(path)
    assert (plain.deviation is None) == (not there)
    mesh = plain.with_deviation()
    old = [0.1 if there else 0.0] * 8
    assert mesh.deviation.tolist() == old and (mesh.vertices == FRAME).all()
    fills = [fan([4, 5, 6, 7], 8), fan([4, 5, 6, 7], 8)]
    fills[0].deviation, fills[1].deviation = np.array([0.25]), None
    for fill in fills:
        mesh.append(fill)
    mesh.write(tmp_path / "b.ply")
    again = files.read(tmp_path / "b.ply")
    assert again.deviation.tolist() == [*old, 0.25, -1.0]
    assert again.faces == plain.faces + [*fills[0].faces, *([a, b, 9] for a, b, _ in fills[1].faces)]
    if not there:  # else as it was
        head, before = (tmp_path / "b.ply").read_bytes().split(b"end_header\n")[0], data.split(b"end_header\n")[0]
        assert head.replace(b"property float deviation\n", b"").replace(b"vertex 10", b"vertex 8") == before.replace(
            b"face 5", b"face 13"
        )


def test_ply_deviation_that_is_no_float(tmp_path):
    data = ply("ascii").replace(b"uchar red", b"uchar deviation")
    with pytest.raises(FileError, match="vertex property deviation has another type"):
        reread(data, "a.ply", tmp_path).with_deviation()


def test_only_ply_files_say_how_well_vertices_are_known(tmp_path):
    mesh = reread(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj", tmp_path)
    assert mesh.deviation is None
    with pytest.raises(FileError, match="--deviation needs OUT.ply"):
        mesh.with_deviation()


def test_ply_index_type_too_small(tmp_path):
    data = ply("ascii").replace(b"list uchar int vertex", b"list uchar uchar vertex")
    fill = fan([4, 5, 6, 7], 8)
    fill.faces, fill.vertices, fill.normals = [[4, 5, 300]], np.repeat(fill.vertices, 300, 0), np.repeat(fill.normals, 300, 0)
    with pytest.raises(FileError, match="new face rows do not fit"):
        filled(data, "a.ply", tmp_path, [fill])


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_ply_errors(form, tmp_path):
    data = ply(form)
    assert "damaged" in refused(data[:-30] if form != "ascii" else data[:-60], "a.ply", tmp_path)
    assert "no faces, only 8 points" in refused(data.replace(b"element face", b"element fate"), "a.ply", tmp_path)
    assert "no vertices with x, y and z" in refused(data.replace(b"float x", b"float u"), "a.ply", tmp_path)
    assert "A line of the header cannot be read" in refused(
        data.replace(b"property float x", b"property half x"), "a.ply", tmp_path
    )
    assert "files cannot be read" in refused(data.replace(b"format ", b"format x"), "a.ply", tmp_path)
    assert "The PLY file is damaged" in refused(b"plx", "a.ply", tmp_path)


# ---------------------------------------------------------------------------------------------------- STL


def stl_binary(header=b"solid of my own"):
    records = b"".join(struct.pack("<12fH", 0, 0, 1, *FRAME[t].reshape(-1), 77) for t in TRIANGLES)
    return header.ljust(80, b"\0") + struct.pack("<I", 8) + records


def test_stl_binary(tmp_path):
    data = stl_binary()
    mesh = reread(data, "a.stl", tmp_path)
    assert len(mesh.vertices) == 8  # by place
    rim = [int(np.nonzero((mesh.vertices == p).all(axis=1))[0][0]) for p in FRAME[4:]]
    out = filled(data, "a.stl", tmp_path, [fan(rim, 8)])
    assert out[:80] == data[:80]
    assert out[80:84] == struct.pack("<I", 12)
    assert out[84 : len(data)] == data[84:]
    again = reread(out, "b.stl", tmp_path)
    assert len(again.vertices) == 9  # the rim's places are met to the bit
    assert again.faces == mesh.faces + fan(rim, 8).faces
    assert struct.unpack_from("<3f", out, len(data))[2] > 0.8  # the normal of the new triangle


def test_stl_text(tmp_path):
    text = "solid  my part\n"
    for t in TRIANGLES:
        text += (
            "facet normal 0 0 1\nouter loop\n"
            + "".join("vertex {:.1e} {:g} {:g}\n".format(*FRAME[v]) for v in t)
            + "endloop\nendfacet\n"
        )
    data = (text + "endsolid my part\n").encode()
    mesh = reread(data, "a.stl", tmp_path)
    rim = [int(np.nonzero((mesh.vertices == p).all(axis=1))[0][0]) for p in FRAME[4:]]
    out = filled(data, "a.stl", tmp_path, [fan(rim, 8)])
    assert out.startswith(text.encode())
    assert out.endswith(b"  endfacet\nendsolid my part\n")
    again = reread(out, "b.stl", tmp_path)
    assert len(again.vertices) == 9
    assert again.faces == mesh.faces + fan(rim, 8).faces


def test_stl_errors(tmp_path):
    assert "The STL file is damaged" in refused(b"hello", "a.stl", tmp_path)
    assert "The STL file is damaged" in refused(
        bytes(80) + b"\x02" + bytes(500), "a.stl", tmp_path
    )  # two triangles, and much else
    assert "STL file" in refused(stl_binary()[:-3], "a.stl", tmp_path)
    solid = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
    assert "ends early" in refused(solid.replace(b"endsolid", b""), "a.stl", tmp_path)
    assert "damaged" in refused(solid.replace(b"vertex 1 0 0", b""), "a.stl", tmp_path)
    assert "damaged" in refused(solid.replace(b"vertex 1 0 0", b"vertex 1 a 0"), "a.stl", tmp_path)


# ---------------------------------------------------------------------------------------------------- meshio


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("version", ["vtk42", "vtk"])
def test_vtk_keeps_points_cells_and_data(version, binary, tmp_path):
    meshio = pytest.importorskip("meshio")
    path, out = tmp_path / "a.vtk", tmp_path / "b.vtk"
    mesh = meshio.Mesh(
        FRAME,
        [("quad", np.array(QUADS[:3])), ("line", np.array([[0, 1]])), ("triangle", np.array([[3, 0, 4], [3, 4, 7]]))],
        point_data={"heat": np.arange(8.0), "Normals": np.repeat([[0.0, 0, -1]], 8, axis=0)},
        cell_data={"id": [np.array([5, 5, 5]), np.array([9]), np.array([6, 6])]},
    )
    meshio.write(path, mesh, file_format=version, binary=binary)
    before = files.read(path)
    assert len(before.faces) == 5
    before.append(fan([4, 5, 6, 7], 8))
    before.append(fan([4, 5, 6, 7], 8))
    before.write(out)
    assert out.read_bytes().splitlines()[0] == path.read_bytes().splitlines()[0]
    assert out.read_bytes().splitlines()[2] == (b"BINARY" if binary else b"ASCII")
    after = meshio.read(out)
    assert (after.points[:8] == FRAME).all()
    assert after.points.shape == (10, 3)
    assert after.point_data["heat"][:8].tolist() == [*range(8)]
    assert (np.abs(after.point_data["heat"][8:] - 5) < 0.2).all()  # 4 and 5 are the nearest
    assert after.point_data["Normals"][8:].tolist() == [[0, 0, 1], [0, 0, 1]]
    assert after.cells_dict["line"].tolist() == [[0, 1]]
    assert len(after.cells_dict["triangle"]) == 2 + 8
    assert np.concatenate(after.cell_data["id"]).tolist()[:6] == [5, 5, 5, 9, 6, 6]
    assert set(np.concatenate(after.cell_data["id"])[6:]) == {5}  # three of the five faces around


def test_without_meshio(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "meshio", None)
    assert ".vtk needs meshio: pip install tripatch[files]" in refused(b"# vtk DataFile Version 3.0\n", "a.vtk", tmp_path)


@pytest.mark.parametrize("suffix", [".usda", ".usdc"])
def test_usd_errors_name_no_code_of_usd(suffix, tmp_path):
    pytest.importorskip("pxr", reason="usd-core is not installed")
    assert refused(b"nonsense\n", f"a{suffix}", tmp_path).endswith("The USD file is damaged, or of another format")


def test_vtk_errors(tmp_path, capfd):
    pytest.importorskip("meshio")
    assert "cannot be read: The VTK file is damaged, or of another format" in refused(b"nonsense\n", "a.vtk", tmp_path)
    cut = b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0\n"
    assert refused(cut, "a.vtk", tmp_path).endswith("The VTK file is damaged, or of another format")
    assert refused(b"nonsense\n", "a.md", tmp_path).endswith(
        ".md files cannot be read as meshes. Use one of .obj, .ply, .stl, .off, .glb, .gltf, .3mf, .usd, .vtk"
    )
    assert capfd.readouterr() == ("", ""), "meshio prints nothing"
    assert "cannot be read" in refused(b"nonsense\n", "a.xyz", tmp_path)


# ---------------------------------------------------------------------------------------------------- all


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".stl", ".vtk"])
def test_converted(suffix, tmp_path):
    if suffix == ".vtk":
        pytest.importorskip("meshio")
    mesh = files.converted(reread(OBJ, "a.obj", tmp_path), suffix)
    assert (mesh.vertices == FRAME).all()
    mesh.append(fan([4, 5, 6, 7], 8))
    mesh.write(tmp_path / ("b" + suffix))
    again = files.read(tmp_path / ("b" + suffix))
    assert len(again.vertices) == 9
    places = sorted(sorted(map(tuple, again.vertices[f])) for f in again.faces)
    assert len(places) == (12 if suffix == ".stl" else 8)  # STL has triangles only


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(FileError, match=rf"none\.obj cannot be read: {re.escape(missing_file())}"):
        files.read(tmp_path / "none.obj")


def test_writing_where_one_cannot(tmp_path):
    mesh = reread(OBJ, "a.obj", tmp_path)
    with pytest.raises(FileError, match="cannot be written: No such file"):
        mesh.write(tmp_path / "none" / "a.obj")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.obj"]


def dialect(rng):
    """An OBJ file in which every line may be of another form, and its faces as a simple reader has them."""
    lines, faces, vertices, textures = [], [], 0, 0
    for _ in range(rng.integers(20, 200)):
        kind = rng.choice(["v", "vt", "vn", "f", "f", "g", "#", "", "v4"]) if vertices > 4 else "v"
        if kind in ("v", "v4"):
            numbers = [repr(float(x)) for x in rng.normal(size=3 if kind == "v" else 6)]
            lines.append(f"{rng.choice(['v ', 'v' + chr(9), ' v  '])}{rng.choice([' ', '  ']).join(numbers)}")
            vertices += 1
        elif kind in ("vt", "vn"):
            lines.append(f"{kind} 0.5 {rng.integers(9)} 1e-3")
            textures += kind == "vt"
        elif kind == "f":
            face = rng.choice(vertices, rng.integers(2, 6), replace=False)
            given = [int(v) + 1 if rng.random() < 0.8 else int(v) - vertices for v in face]
            forms = ["{}", "{}/1", "{}//1", "{}/1/1", "{}/-1/-1", "{}/"]
            form = [rng.choice(forms)] * len(face) if rng.random() < 0.7 else rng.choice(forms, len(face))
            split = rng.choice([" ", " \\\n "]) if rng.random() < 0.1 else " "
            lines.append(f"{rng.choice(['f', 'fo'])} " + split.join(each.format(v) for each, v in zip(form, given, strict=True)))
            lines[-1] += " # more" if rng.random() < 0.1 else ""
            if len(face) >= 3:
                faces.append([int(v) for v in face])
        else:
            lines.append({"g": "g part", "#": "# v 1 2 3", "": "   "}[kind])
    return str(rng.choice(["\n", "\r\n"])).join(lines), faces


@pytest.mark.parametrize("seed", range(20))
def test_obj_lines_of_any_form_are_read_alike(seed, tmp_path):
    text, faces = dialect(np.random.default_rng(seed))
    (tmp_path / "a.obj").write_bytes(text.encode())
    mesh = files.read(tmp_path / "a.obj")
    places = [line.split()[1:4] for line in text.splitlines() if line.split()[:1] == ["v"]]
    assert mesh.faces == faces and np.array_equal(mesh.vertices, np.array(places, float))
    files.write(tmp_path / "b.obj", mesh)
    assert (tmp_path / "b.obj").read_bytes() == text.encode()


def test_faces_are_made_into_lists_only_when_asked_for(tmp_path):
    for name, faces in (("a.ply", QUADS), ("b.ply", [*QUADS, [0, 1, 2]])):
        files.write(tmp_path / name, (FRAME, faces))
        mesh = files.read(tmp_path / name)
        assert mesh.faces == faces and list(mesh.faces) == faces and mesh.faces[1:] == faces[1:] and mesh.faces[-1] == faces[-1]
        assert mesh.faces + [[0, 1, 2]] == [*faces, [0, 1, 2]] and mesh.faces.index(faces[2]) == 2
        with pytest.raises(IndexError):
            mesh.faces[len(faces)]
    assert np.array_equal(np.asarray(files.read(tmp_path / "a.ply").faces), QUADS)


@pytest.mark.parametrize("order", ["little", "big"])
def test_ply_rows_of_different_lengths_are_read_at_once(order, tmp_path):
    o = "<" if order == "little" else ">"
    head = f"ply\nformat binary_{order}_endian 1.0\nelement vertex 9\n" + "".join(f"property float {c}\n" for c in "xyz")
    head += "element face 4\nproperty short a\nproperty list uchar float uv\nproperty list ushort uint vertex_indices\n"
    head += "property uchar b\nend_header\n"
    faces, body = [[0, 1, 2], [3, 4, 5, 6], [1, 2], [8, 7, 6]], struct.pack(o + "27f", *range(27))
    for k, face in enumerate(faces):
        body += struct.pack(f"{o}hB{k}fH{len(face)}IB", k, k, *range(k), len(face), *face, 1)
    (tmp_path / "a.ply").write_bytes(head.encode() + body)
    mesh = files.read(tmp_path / "a.ply")
    assert mesh.faces == [faces[0], faces[1], faces[3]] and np.array_equal(mesh.vertices.ravel(), np.arange(27))
    (tmp_path / "b.ply").write_bytes(head.encode() + body[:-3])
    with pytest.raises(files.FileError, match="damaged"):
        files.read(tmp_path / "b.ply")


def test_equal_places_are_found_whatever_their_type():
    from tripatch import _arrays

    rng = np.random.default_rng(1)
    for count in (0, 1, 500):
        for kind in (np.float32, np.float64):
            points = rng.integers(-2, 3, (count, 3)).astype(kind) * kind(0.1)
            first, place = _arrays.same_places(points)
            assert np.array_equal(points[first][place], points) and (np.diff(first) > 0).all()
            assert len(first) == len({tuple(p) for p in points.tolist()})
    assert len(_arrays.same_places(np.array([[0.0, 1, 2], [-0.0, 1, 2]]))[0]) == 1
