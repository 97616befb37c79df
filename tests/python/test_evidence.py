"""Files say which of their faces are fills, and `tripatch strip` gives back the file as it was, bit for bit."""

import json
import re
import struct

import numpy as np
import pytest
import tripatch
from test_cli import run, sphere_hole, write_obj
from test_fill_holes import sheet
from tripatch import files

OBJ = b"# a scan\r\nmtllib a.mtl\r\ng body left\r\nusemtl red\r\n%s\r\n# the end"


def obj_of(vertices, faces):
    rows = [("v " + " ".join(map(repr, map(float, p)))).encode() for p in vertices]
    rows += [("f " + " ".join(str(v + 1) for v in f)).encode() for f in faces]
    return OBJ.replace(b"%s", b"\r\n".join(rows))


def ply_of(vertices, faces, form="ascii", end=b"\n"):
    head = f"ply\nformat {form} 1.0\ncomment mine\nelement vertex 0{len(vertices)}\nproperty float x\nproperty float y\n"
    head += f"property float z\nproperty uchar red\nelement face {len(faces)}\nproperty list uchar int vertex_indices\n"
    head += "property short label\nelement other 1\nproperty int n\nend_header\n"
    if form == "ascii":
        rows = [(" ".join(map(repr, map(float, p))) + "  7 ").encode() for p in vertices]
        rows += [(f"{len(f)} " + " ".join(map(str, f)) + " 5\t").encode() for f in faces]
        return head.encode() + b"\n".join([*rows, b"9"]) + end
    o = "<" if "little" in form else ">"
    body = b"".join(struct.pack(o + "3fB", *p, 7) for p in vertices)
    body += b"".join(struct.pack(o + f"B{len(f)}iH", len(f), *map(int, f), 5) for f in faces)
    return head.encode() + body + struct.pack(o + "i", 9)


def off_of(vertices, faces):
    rows = [" ".join(map(repr, map(float, p))) for p in vertices] + ["3 " + " ".join(map(str, f)) for f in faces]
    return (f"OFF # mine\n\n{len(vertices)}  {len(faces)} 0 # counts\n" + "\n".join(rows)).encode()


def plain(suffix):
    def made(vertices, faces, folder):
        tripatch.write(folder / f"plain{suffix}", (vertices, faces))
        return (folder / f"plain{suffix}").read_bytes()

    return made


def text_stl(vertices, faces, _):
    text = "solid mine\n"
    for face in faces:
        text += "facet normal 0 0 1\n outer loop\n"
        text += "".join(f"  vertex {' '.join(map(repr, map(float, vertices[v])))}\n" for v in face) + " endloop\nendfacet\n"
    return (text + "endsolid mine\n").encode()


def on_one_line(vertices, faces, _):
    head, body = re.split(rb"(?<=end_header)\s+", ply_of(vertices, faces), maxsplit=1)
    rows = [b" ".join(row.split()) for row in body.splitlines()]
    return b"\n".join([head, b" ".join(rows[: len(vertices)]), *rows[len(vertices) :], b""])


FILES = {
    "obj": (".obj", lambda v, f, _: obj_of(v, f)),
    "obj, plain": (".obj", plain(".obj")),
    "ply, text": (".ply", lambda v, f, _: ply_of(v, f)),
    "ply, text without an end": (".ply", lambda v, f, _: ply_of(v, f, end=b"")),
    "ply, text with all vertices on one line": (".ply", on_one_line),
    "ply, little endian": (".ply", lambda v, f, _: ply_of(v, f, "binary_little_endian")),
    "ply, big endian": (".ply", lambda v, f, _: ply_of(v, f, "binary_big_endian")),
    "ply, plain": (".ply", plain(".ply")),
    "off": (".off", lambda v, f, _: off_of(v, f)),
    "stl, binary": (".stl", plain(".stl")),
    "stl, text": (".stl", text_stl),
}


@pytest.fixture(params=FILES)
def case(request, tmp_path):
    """A file with two holes: its path and its bytes."""
    suffix, make = FILES[request.param]
    vertices, faces = sheet()
    vertices = np.concatenate([vertices, vertices * [1, 1, 2] + [20, 0, 0]])
    data = make(vertices, np.concatenate([faces, faces + len(vertices) // 2]), tmp_path)
    path = tmp_path / f"in{suffix}"
    path.write_bytes(data)
    return path, data


def test_strip_gives_back_the_file_bit_for_bit(case, tmp_path, capsys):
    path, data = case
    out, report, back = (tmp_path / f"{name}{path.suffix}" for name in ("out", "report", "back"))
    assert run(capsys, "fill", path, "-o", out, "--all", "--report", report)[0] == 0
    assert out.read_bytes() != data
    by_report = ["--report", report] if path.suffix in (".stl", ".off") else []
    code, said, err = run(capsys, "strip", out, "-o", back, *by_report)
    assert (code, err) == (0, "") and said
    assert back.read_bytes() == data


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
def test_fills_that_were_made_one_after_another_are_all_stripped(suffix, tmp_path, capsys):
    vertices, faces = sheet()
    vertices = np.concatenate([vertices, vertices + [20, 0, 0]])
    first, second, third, back = (tmp_path / f"{k}{suffix}" for k in range(4))
    tripatch.write(first, (vertices, np.concatenate([faces, faces + len(vertices) // 2])))
    rims = [loop for loop in tripatch.find_holes(files.read(first).faces) if len(loop) < 20]
    rim = [",".join(map(str, loop)) for loop in rims]
    assert run(capsys, "fill", first, second, "--rim", rim[0], "--deviation" if suffix == ".ply" else "-v")[0] == 0
    assert run(capsys, "fill", second, third, "--rim", rim[1])[0] == 0
    assert numbers_of(third) == {0, 1, 2}
    assert run(capsys, "strip", third, back)[0] == 0
    assert back.read_bytes() == first.read_bytes()


def numbers_of(path):
    """The numbers of fills that the faces of a file have."""
    data = path.read_bytes()
    if path.suffix == ".obj":
        return {0} | {int(k) for k in re.findall(rb"(?m)^g .*\btripatch_fill_(\d+)$", data)}
    mesh = files.read(path)
    at = mesh._face.index("tripatch_fill")
    return {mesh._row(mesh._face, k)[at] for k in range(mesh._face.count)}


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
def test_each_fill_says_how_it_was_made(suffix, tmp_path, capsys):
    path, out = tmp_path / f"in{suffix}", tmp_path / f"out{suffix}"
    tripatch.write(path, sheet())
    assert run(capsys, "fill", path, out, "--all", "--method", "polyharmonic_spline")[0] == 0
    (said,) = [json.loads(each) for each in re.findall(rb"(?m)^(?:#|comment) tripatch fill (.*?)\r?$", out.read_bytes())]
    (fill,) = tripatch.fill_all(*sheet(), method="polyharmonic_spline")
    assert said["fill"] == 1 and said["method"] == fill.report.method and said["tripatch"] == tripatch.__version__
    assert said["error_estimate"] == pytest.approx(fill.report.deviation_max) and len(said["options_sha256"]) == 64
    assert (said["vertices"], said["faces"]) == (len(fill.vertices), len(fill.faces))
    assert numbers_of(out) == {0, 1}


def test_the_hash_of_the_options_tells_other_options_apart(tmp_path):
    path = write_obj(tmp_path / "in.obj", sphere_hole())
    mesh = files.read(path)
    said = []
    for options in ({}, {"bulge": 1.2}, {"bulge": 1.2}):
        made = mesh.filled(tripatch.fill_all(mesh.vertices, mesh.faces, **options))
        said.append(re.search(rb'"options_sha256":"(\w+)"', made._data)[1])
    assert said[0] != said[1] == said[2]


def test_groups_and_materials_of_the_faces_around_stay_those_of_the_fill(tmp_path, capsys):
    path, out = tmp_path / "in.obj", tmp_path / "out.obj"
    path.write_bytes(obj_of(*sheet()))
    assert run(capsys, "fill", path, out)[0] == 0
    assert b"\r\ng body left tripatch_fill_1\r\n" in out.read_bytes()
    assert out.read_bytes().count(b"usemtl") == 1


def test_what_strip_cannot_give_back_is_said(tmp_path, capsys):
    path, out, back = tmp_path / "in.obj", tmp_path / "out.obj", tmp_path / "back.obj"
    write_obj(path, sphere_hole())
    code, _, err = run(capsys, "strip", path, back)
    assert code == 1 and "has no fills" in err and not back.exists()
    assert run(capsys, "fill", path, out, "--faces", "cage", "--cage-rim", "move", "--resolution", "0")[0] == 0
    code, _, err = run(capsys, "strip", out, back)
    assert code == 1 and "the original cannot be restored" in err and not back.exists()
    stl = tmp_path / "a.stl"
    tripatch.write(stl, sheet())
    assert run(capsys, "fill", stl, stl)[0] == 0
    code, _, err = run(capsys, "strip", stl, tmp_path / "b.stl")
    assert code == 1 and "--report FILE.json" in err
