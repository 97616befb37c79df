"""What new faces in files take over from the faces around: texture coordinates, colors, materials, solids."""

import struct

import numpy as np
import pytest
import tripatch
from shapes import cube_sphere
from test_outer_borders import sheet
from tripatch import files

HOLE = [k for k in range(64) if 2 <= k // 8 < 6 and 2 <= k % 8 < 6]


def texture(points, half=None):
    """Affine; of the right half another map, elsewhere."""
    uv = points[:, :2] @ np.array([[0.4, 0.1], [-0.1, 0.4]]) + 0.2
    return uv if half != "right" else uv @ np.array([[0, 1], [-1, 0]]) + 5


def half_of(points):
    return "left" if points[:, 0].mean() < 0.5 else "right"


def obj(path, seam=False):
    """A plane with a hole: colors, texture coordinates, and a material for each half."""
    vertices, faces = sheet(8, 1.0, HOLE)
    rows = [f"v {x!r} {y!r} {z!r} {x!r} 0.5 {y!r}".encode() for x, y, z in vertices.tolist()]
    corners, count = [], 0
    for face in faces:
        half = half_of(vertices[face])
        rows += [b"vt %.17g %.17g" % tuple(uv) for uv in texture(vertices[face], half if seam else None)]
        corners.append((half, [(v + 1, count + c + 1) for c, v in enumerate(face)]))
        count += len(face)
    for half in ("left", "right"):
        rows.append(f"usemtl {half}".encode())
        rows += [b"f " + b" ".join(b"%d/%d" % corner for corner in face) for own, face in corners if own == half]
    path.write_bytes(b"\n".join(rows) + b"\n")
    return path


def filled(path, out, **options):
    """How many faces were there, and the file with its holes filled."""
    mesh = files.read(path)
    count = len(mesh.faces)
    for fill in tripatch.fill_all(mesh.vertices, mesh.faces, **options):
        mesh.append(fill)
    mesh.write(out)
    assert out.read_bytes()[:100] == path.read_bytes()[:100] or path.suffix in (".ply", ".stl")
    return count, files.read(out)


def materials(path):
    found, now = [], None
    for line in path.read_text().splitlines():
        if line.startswith("usemtl"):
            now = line.split()[1]
        elif line.startswith("f "):
            found.append(now)
    return found


@pytest.mark.parametrize("output", ["triangles", "quads"])
def test_obj_texture_coordinates_are_continued(tmp_path, output):
    count, mesh = filled(obj(tmp_path / "in.obj"), tmp_path / "out.obj", output=output)
    assert len(mesh.faces) > count
    for f in range(count, len(mesh.faces)):
        np.testing.assert_allclose(mesh._texture_of(f), texture(mesh.vertices[mesh.faces[f]]), atol=1e-9)


def test_obj_colors_of_vertices_are_blended(tmp_path):
    mesh = filled(obj(tmp_path / "in.obj"), tmp_path / "out.obj")[1]
    new = range(81, len(mesh.vertices))
    colors = np.array([[float(word) for word in mesh._extra(v)] for v in new])
    assert len(colors)
    x, y = mesh.vertices[81:, :2].T
    np.testing.assert_allclose(colors, np.column_stack([x, 0 * x + 0.5, y]), atol=1e-9)


def test_obj_a_texture_seam_is_continued_across_the_hole_without_mirrored_faces(tmp_path):
    count, mesh = filled(obj(tmp_path / "in.obj", seam=True), tmp_path / "out.obj")
    looks = materials(tmp_path / "out.obj")
    for f in range(count, len(mesh.faces)):
        points, uv = mesh.vertices[mesh.faces[f]], mesh._texture_of(f)
        np.testing.assert_allclose(uv, texture(points, looks[f]), atol=1e-6)
        if not (points[:, 0].min() < 0.5 < points[:, 0].max()):
            assert looks[f] == half_of(points)
    assert set(looks[count:]) == {"left", "right"}


def test_obj_faces_named_fo_are_read(tmp_path):
    path = obj(tmp_path / "in.obj")
    path.write_bytes(path.read_bytes().replace(b"\nf ", b"\nfo "))
    count, mesh = filled(path, tmp_path / "out.obj")
    assert count == 48 and len(mesh.faces) > count


def ply(path, form="ascii", end=b"\n"):
    vertices, faces = sheet(8, 1.0, HOLE)
    head = f"ply\nformat {form} 1.0\nelement vertex {len(vertices)}\n" + "".join(f"property float {c}\n" for c in "xyz")
    head += "".join(f"property uchar {c}\n" for c in ("red", "green", "blue")) + "property float quality\nproperty int label\n"
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
    head += "property int texnumber\nend_header\n"
    rows = []
    for x, y, z in vertices.tolist():
        color = [round(200 * x), round(100 * y), 7]
        if form == "ascii":
            rows.append(f"{x} {y} {z} {color[0]} {color[1]} {color[2]} {x + y} {int(x > 0.5)}".encode())
        else:
            rows.append(struct.pack("<3f3Bfi", x, y, z, *color, x + y, int(x > 0.5)))
    for face in faces:
        uv = texture(vertices[face]).ravel().tolist()
        side = int(half_of(vertices[face]) == "right")
        if form == "ascii":
            rows.append(" ".join(map(str, [4, *face, 8, *uv, side])).encode())
        else:
            rows.append(struct.pack("<B4iB8fi", 4, *face, 8, *uv, side))
    path.write_bytes(head.encode() + (b"" if form != "ascii" else end).join(rows) + end * (form == "ascii"))
    return path


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_ply_texture_coordinates_colors_and_qualities_are_blended(tmp_path, form):
    count, mesh = filled(ply(tmp_path / "in.ply", form), tmp_path / "out.ply")
    assert len(mesh.faces) > count
    for f in range(count, len(mesh.faces)):
        row, points = mesh._row(mesh._face, f), mesh.vertices[mesh.faces[f]]
        np.testing.assert_allclose(np.reshape(row[1], (-1, 2)), texture(points), atol=1e-5)
        if not (points[:, 0].min() < 0.5 < points[:, 0].max()):
            assert row[2] == int(half_of(points) == "right")
    for v in range(81, len(mesh.vertices)):
        row, (x, y, _) = mesh._row(mesh._vertex, v), mesh.vertices[v]
        np.testing.assert_allclose(row[3:6], [200 * x, 100 * y, 7], atol=1.1)
        assert abs(row[6] - x - y) < 1e-5 and row[7] in (0, 1)  # a label is no quantity


def test_ply_rows_may_share_a_line(tmp_path):
    path = ply(tmp_path / "in.ply", "ascii", b" ")
    count, mesh = filled(path, tmp_path / "out.ply")
    assert count == 48 and len(mesh.vertices) > 81 and len(mesh.faces) > 48


def facets(vertices, faces):
    return [vertices[[face[0], face[k], face[k + 1]]] for face in faces for k in range(1, len(face) - 1)]


def binary_stl(path, attributes, more=b""):
    triangles = facets(*sheet(8, 1.0, HOLE))
    body = b"".join(struct.pack("<12fH", 0, 0, 1, *p.ravel(), attributes[half_of(p)]) for p in np.array(triangles, np.float32))
    path.write_bytes(b"COLOR=".ljust(80) + struct.pack("<I", len(triangles)) + body + more)
    return path


def test_new_stl_facets_have_the_colors_of_their_neighbors(tmp_path):
    count, mesh = filled(binary_stl(tmp_path / "in.stl", {"left": 0x801F, "right": 0x83E0}), tmp_path / "out.stl")
    for f in range(count, len(mesh.faces)):
        points = mesh.vertices[mesh.faces[f]]
        if not (points[:, 0].min() < 0.5 < points[:, 0].max()):
            assert mesh._part_of[f] == {"left": 0x801F, "right": 0x83E0}[half_of(points)]


def test_bytes_behind_the_last_stl_triangle_stay(tmp_path):
    path = binary_stl(tmp_path / "in.stl", {"left": 0, "right": 0}, b"\x01" * 37)
    count, mesh = filled(path, tmp_path / "out.stl")
    assert count == 96 and len(mesh.faces) > count
    assert (tmp_path / "out.stl").read_bytes().endswith(b"\x01" * 37)


def test_an_stl_file_that_ends_early_is_refused_with_what_was_found(tmp_path):
    path = binary_stl(tmp_path / "in.stl", {"left": 0, "right": 0})
    path.write_bytes(path.read_bytes()[:-70])
    with pytest.raises(files.FileError, match="announces 96 entries and has 94"):
        files.read(path)


@pytest.mark.parametrize("upper", [False, True])
def test_new_facets_go_into_the_solid_beside_them(tmp_path, upper):
    vertices, faces = cube_sphere(6)
    gone = int(np.argmax([vertices[face][:, 0].min() for face in faces]))
    other = int(np.argmin([vertices[face][:, 0].max() for face in faces]))
    parts = {"a": [], "b": []}
    for f, face in enumerate(faces):
        if f not in (gone, other):
            parts["a" if vertices[face][:, 0].mean() > 0 else "b"] += facets(vertices, [face])
    text = ""
    for name, triangles in parts.items():
        text += f"solid {name}\n"
        for p in triangles:
            corners = "".join("vertex {} {} {}\n".format(*row) for row in p.tolist())
            text += f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n"
        text += f"endsolid {name}\n"
    path = tmp_path / "in.stl"
    path.write_text(text.upper() if upper else text)
    count, mesh = filled(path, tmp_path / "out.stl")
    assert len(mesh.faces) > count and not tripatch.find_holes(mesh.faces)
    made = (tmp_path / "out.stl").read_text()
    assert made.isupper() == upper
    for solid, side in zip(made.lower().split("endsolid"), (1, -1)):
        places = [line.split()[1:] for line in solid.splitlines() if line.strip().startswith("vertex")]
        assert (side * np.array(places, float)[:, 0] > -1e-3).all()
