"""Files as they should not be: nothing is lost in silence, nothing of the user's is written over, every refusal is a sentence."""

from __future__ import annotations

import os
import signal
import stat
import struct
import subprocess
import sys
from functools import partial

import numpy as np
import pytest
import tripatch
from systems import WINE
from tripatch import files
from tripatch.__main__ import main
from tripatch.files import FileError

OCTAHEDRON = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], float)
SEVEN = [[1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
ADDED = len(tripatch.fill(OCTAHEDRON, SEVEN).faces)


def obj(before=b"") -> bytes:
    rows = [b"v %f %f %f" % tuple(p) for p in OCTAHEDRON] + [b"f %d %d %d" % tuple(v + 1 for v in f) for f in SEVEN]
    return before + b"\n".join(rows) + b"\n"


@pytest.fixture
def mesh(tmp_path):
    path = tmp_path / "in.obj"
    path.write_bytes(obj())
    return path


def run(*words, **options):
    command = [sys.executable, "-m", "tripatch", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, **options)


# ---------------------------------------------------------------------------------------------------- reading


@pytest.mark.parametrize("suffix", ["obj", "off"])
def test_a_byte_order_mark_costs_nothing(suffix, tmp_path):
    mark = b"\xef\xbb\xbf"
    data = obj() if suffix == "obj" else b"OFF\n6 7 0\n" + b"".join(b"%f %f %f\n" % tuple(p) for p in OCTAHEDRON)
    if suffix == "off":
        data += b"".join(b"3 %d %d %d\n" % tuple(f) for f in SEVEN)
    path = tmp_path / f"in.{suffix}"
    path.write_bytes(mark + data)
    read = files.read(path)
    np.testing.assert_array_equal(read.vertices, OCTAHEDRON)
    assert read.faces == SEVEN
    assert main(["fill", str(path), str(path)]) == 0
    assert path.read_bytes().startswith(mark)
    assert len(files.read(path).faces) == 7 + ADDED


@pytest.mark.parametrize("suffix", ["obj", "off", "ply", "stl"])
def test_text_of_two_bytes_a_letter_is_refused(suffix, tmp_path):
    path = tmp_path / f"in.{suffix}"
    path.write_bytes(obj().decode().encode("utf-16"))
    with pytest.raises(FileError, match="UTF-16|The (OFF|PLY|STL) file (is damaged|ends early)"):
        files.read(path)


HUGE = 2**63 + 5


@pytest.mark.parametrize(
    "name, data",
    [
        ("a.obj", obj() + b"f 1 2 %d\n" % HUGE),
        ("a.obj", obj() + b"f 1 2 -%d\n" % HUGE),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 %d\n" % HUGE),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n%d 0 1 2\n" % HUGE),
        ("a.off", b"OFF\n%d 1 0\n0 0 0\n" % HUGE),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
                  b"element face 0\nproperty list uchar int vertex_indices\nend_header\n" % HUGE),
    ],
)  # fmt: skip
def test_numbers_beyond_all_bounds_are_refused_with_a_sentence(name, data, tmp_path, capsys):
    path = tmp_path / name
    path.write_bytes(data)
    assert main(["fill", str(path), str(tmp_path / "out.obj")]) == 2
    assert "cannot be read" in capsys.readouterr().err


def ply(vertices=3, size=3, count_type="char", form="ascii", faces=1) -> bytes:
    head = f"ply\nformat {form} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"element face {faces}\nproperty list {count_type} int vertex_indices\nend_header\n"
    if form == "ascii":
        return head.encode() + b"0 0 0\n1 0 0\n0 1 0\n" + b"%d 0 1 2\n" % size
    return head.encode() + struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<b3i", size, 0, 1, 2)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize("change", [{"size": -1}, {"size": 120}, {"vertices": -1}, {"faces": -1}, {"faces": 2**62}])
def test_counts_in_ply_that_cannot_be(form, change, tmp_path):
    path = tmp_path / "a.ply"
    path.write_bytes(ply(form=form))
    assert len(files.read(path).faces) == 1
    path.write_bytes(ply(form=form, **change))
    with pytest.raises(FileError):
        files.read(path)


def octahedron_ply(head="", red="7", element="element face 7") -> bytes:
    """A text of all faces but one, with a color at the vertices."""
    head = f"ply\nformat ascii 1.0\n{head}element vertex 6\n" + "".join(f"property float {c}\n" for c in "xyz")
    head += f"property uchar red\n{element}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [f"{x} {y} {z} {red}" for x, y, z in OCTAHEDRON] + [f"3 {a} {b} {c}" for a, b, c in SEVEN]
    return (head + "\n".join(rows) + "\n").encode("latin-1")


@pytest.mark.parametrize("red", ["", "x", "7.5"])
def test_a_vertex_that_the_header_does_not_describe_is_named(red, tmp_path, capsys):
    """Found by fuzzing: positions were read, and it ended without a word when a new vertex was to have the color of an old."""
    path, out = tmp_path / "a.ply", tmp_path / "out.ply"
    path.write_bytes(octahedron_ply(red=red))
    assert main(["fill", str(path), str(out), "--method", "side_vertex", "--resolution", "3"]) == 2
    assert "of the vertex elements cannot be read" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    "change", [{"head": "comment element vertex 9\n"}, {"head": "element vertex 0\n"}, {"element": "element\tface  7"}]
)
def test_the_counts_of_a_ply_header_are_those_that_were_read(change, tmp_path):
    """Found by fuzzing: of two elements of one name the wrong count went up."""
    path = tmp_path / "a.ply"
    path.write_bytes(octahedron_ply(**change))
    assert main(["fill", str(path), str(path)]) == 0
    assert len(files.read(path).faces) == 7 + ADDED


def test_a_ply_header_is_split_at_the_blanks_of_its_rows(tmp_path):
    """Found by fuzzing: a no-break space parted words when it was read, and did not when it was written."""
    path = tmp_path / "a.ply"
    path.write_bytes(octahedron_ply(element="element\xa0face 7"))
    with pytest.raises(FileError):
        files.read(path)


# ---------------------------------------------------------------------------------------------------- binary OFF


def binary_off(big: bool, colors: bool, double: bool = False, normals: bool = False) -> bytes:
    order, real = "><"[not big], "fd"[double]
    data = (b"N" if normals else b"") + b"OFF BINARY\n" + struct.pack(order + "3i", 6, 7, 0)
    for p in OCTAHEDRON:
        data += struct.pack(order + "3" + real, *p)
        if normals:
            data += struct.pack(order + "3" + real, *p)
    for k, face in enumerate(SEVEN):
        data += struct.pack(order + "4i", 3, *face)
        if colors:
            data += struct.pack(order + "i", 4 * (k % 2)) + struct.pack(order + "4f", 1, 0.5, 0, 1) * (k % 2)
    return data


@pytest.mark.parametrize("normals", [False, True])
@pytest.mark.parametrize(
    "big, colors, double", [(True, True, False), (False, False, False), (False, False, True), (False, True, False)]
)
def test_binary_off_of_geomview_and_of_pmp(big, colors, double, normals, tmp_path):
    path = tmp_path / "a.off"
    before = binary_off(big, colors, double, normals)
    path.write_bytes(before)
    read = files.read(path)
    np.testing.assert_array_equal(read.vertices, OCTAHEDRON)
    assert read.faces == SEVEN
    fill = tripatch.fill(read.vertices, read.faces)
    assert main(["fill", str(path), str(path)]) == 0
    after = path.read_bytes()
    again = files.read(path)
    assert again.faces == SEVEN + [[int(v) for v in f] for f in fill.faces]
    np.testing.assert_allclose(again.vertices[6:], fill.vertices, atol=1e-7)
    head = before.index(b"\n") + 13  # the rows that were there are there, byte for byte
    rows = 6 * 3 * (2 if normals else 1) * (8 if double else 4)
    assert after[: head - 12] == before[: head - 12]
    assert after[head : head + rows] == before[head : head + rows]
    assert before[head + rows :] in after[head + rows :]


def test_binary_off_that_is_cut_or_nonsense(tmp_path):
    path, whole = tmp_path / "a.off", binary_off(True, True)
    for data in (
        whole[:-1],
        whole[:15],
        whole[:40],
        whole + b"abc",
        whole.replace(struct.pack(">i", 7), struct.pack(">i", -7), 1),
    ):
        path.write_bytes(data)
        with pytest.raises(FileError, match="binary OFF"):
            files.read(path)


# ---------------------------------------------------------------------------------------------------- writing


def test_nothing_of_the_users_is_written_over(mesh):
    theirs = {mesh.with_name(name): b"mine" for name in ("out.obj.part", "in.obj.part", ".tripatch", "out.part")}
    for path, data in theirs.items():
        path.write_bytes(data)
    assert main(["fill", str(mesh), str(mesh.with_name("out.obj"))]) == 0
    assert {path: path.read_bytes() for path in theirs} == theirs
    assert len(list(mesh.parent.iterdir())) == len(theirs) + 2


@pytest.mark.parametrize(
    "report", ["in.obj", "out.obj", pytest.param("link.obj", marks=pytest.mark.skipif(WINE, reason="no links")), "./in.obj"]
)
def test_a_report_goes_neither_over_the_mesh_nor_over_the_result(report, mesh, capsys):
    mesh.with_name("link.obj").symlink_to(mesh)
    assert main(["fill", str(mesh), str(mesh.with_name("out.obj")), "--report", os.path.join(mesh.parent, report)]) == 2
    assert "--report" in capsys.readouterr().err
    assert mesh.read_bytes() == obj()


@pytest.mark.skipif(os.name != "posix", reason="modes and links of POSIX")
def test_a_file_that_is_written_over_keeps_its_mode_and_its_links(mesh):
    folder = mesh.parent
    (folder / "soft.obj").symlink_to(mesh.name)
    os.link(mesh, folder / "hard.obj")
    for out in (mesh, folder / "soft.obj", folder / "hard.obj"):
        mesh.write_bytes(obj())
        mesh.chmod(0o600)
        assert main(["fill", str(out), str(out)]) == 0
        assert stat.S_IMODE(mesh.stat().st_mode) == 0o600
        assert (folder / "soft.obj").is_symlink() and mesh.stat().st_nlink == 2
        assert len(files.read(mesh).faces) == 7 + ADDED
    (folder / "dangling.obj").symlink_to("new.obj")
    assert main(["fill", str(mesh), str(folder / "dangling.obj"), "--outer"]) in (1, 2)
    mesh.write_bytes(obj())
    assert main(["fill", str(mesh), str(folder / "dangling.obj")]) == 0
    assert (folder / "dangling.obj").is_symlink() and (folder / "new.obj").exists()


@pytest.mark.skipif(os.name != "posix", reason="the umask of POSIX")
def test_a_new_file_has_the_mode_of_new_files(mesh):
    old = os.umask(0o027)
    try:
        assert main(["fill", str(mesh), str(mesh.with_name("out.obj"))]) == 0
    finally:
        os.umask(old)
    assert stat.S_IMODE(mesh.with_name("out.obj").stat().st_mode) == 0o640


@pytest.mark.skipif(WINE or not os.path.exists("/dev/full"), reason="a full device is needed")
def test_a_full_device(mesh, tmp_path):
    mesh.with_name("full.obj").symlink_to("/dev/full")
    done = run("fill", mesh, mesh.with_name("full.obj"))
    assert done.returncode == 2 and "cannot be written" in done.stderr and "Traceback" not in done.stderr
    assert mesh.with_name("full.obj").is_symlink()
    with open("/dev/full", "w") as full:
        for words in (["methods"], ["fill", mesh, tmp_path / "out.obj"]):
            done = subprocess.run(
                [sys.executable, "-m", "tripatch", *map(str, words)], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60
            )
            assert done.returncode == 2, done.stderr
            assert "No space left" in done.stderr and "Traceback" not in done.stderr
    assert len(files.read(tmp_path / "out.obj").faces) == 7 + ADDED  # the mesh itself is written


# ---------------------------------------------------------------------------------------------------- the command


def test_json_of_any_depth(mesh):
    done = run("fill", mesh, mesh, "--output", "cage", "--subdivision", "[" * 100_000)
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert mesh.read_bytes() == obj()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_interrupted_the_file_that_was_there_stays(tmp_path):
    n = 300
    x, y = np.meshgrid(np.arange(n), np.arange(n))
    cells = [(i * n + j, i * n + j + 1, (i + 1) * n + j + 1, (i + 1) * n + j) for i in range(n - 1) for j in range(n - 1)]
    path = tmp_path / "large.obj"
    with path.open("w") as out:
        out.writelines(f"v {a} {b} 0\n" for a, b in zip(x.ravel(), y.ravel()))
        out.writelines(
            "f " + " ".join(str(v + 1) for v in cell) + "\n" for cell in cells[: len(cells) // 2] + cells[len(cells) // 2 + 1 :]
        )
    before = path.read_bytes()
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # which jobs in the background do not
    run = """if True:
        import sys
        from tripatch import files
        from tripatch.__main__ import main
        read = files.read
        files.read = lambda path: print("reading", flush=True) or read(path)
        sys.exit(main())
    """
    child = subprocess.Popen(
        [sys.executable, "-c", run, "fill", path, path, "--all"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heed,
    )
    child.stdout.readline()  # before that, the interruption is none of the command's
    child.send_signal(signal.SIGINT)
    _, said = child.communicate(timeout=60)
    if child.returncode != 0:  # it was not done before
        assert child.returncode in (130, -signal.SIGINT)
        assert "Traceback" not in said
        assert path.read_bytes() == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["large.obj"]


@pytest.mark.parametrize("letters, more", [("", 0), ("ST", 2), ("C", 4), ("N", 3), ("STCN", 9)])
def test_binary_off_with_all_that_a_vertex_may_have(letters, more, tmp_path):
    path = tmp_path / "a.off"
    plain = binary_off(False, False)
    at = plain.index(b"\n") + 13
    rows = [plain[at + 12 * k : at + 12 * (k + 1)] + struct.pack(f"<{more}f", *range(more)) for k in range(6)]
    path.write_bytes(letters.encode() + plain[:at] + b"".join(rows) + plain[at + 72 :])
    read = files.read(path)
    np.testing.assert_array_equal(read.vertices, OCTAHEDRON)
    assert read.faces == SEVEN
