"""No memory, room or rights, Ctrl-C and kills at any moment: it is said in a sentence, and the file that was there survives."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap

import pytest
from shapes import octant
from tripatch import files
from tripatch.__main__ import main
from tripatch.files.writing import write_over

pytestmark = pytest.mark.skipif(os.name != "posix", reason="limits and signals of POSIX")


@pytest.fixture
def mesh(tmp_path):
    vertices, faces, _ = octant(12)
    path = tmp_path / "in.obj"
    files.converted(files.MeshFile(vertices, [[int(v) for v in face] for face in faces]), ".obj").write(path)
    return path


def run(script, *words):
    """Python text in a process of its own; what it says."""
    begin = "import os, resource, signal, sys\nfrom tripatch import files\nfrom tripatch.__main__ import main\n"
    begin += "IN, OUT = sys.argv[1:3]\n"
    command = [sys.executable, "-c", begin + textwrap.dedent(script), *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".stl"])
def test_no_room_on_the_disk(suffix, mesh):
    """A limit of the size of files, which is met while one is written, as a full disk is."""
    out = mesh.with_suffix(suffix) if suffix != ".obj" else mesh
    if out != mesh:
        read = files.read(mesh)
        files.converted(files.MeshFile(read.vertices, read.faces), suffix).write(out)
    before = out.read_bytes()
    done = run(
        """
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (os.path.getsize(OUT), resource.RLIM_INFINITY))
        sys.exit(main(["fill", IN, OUT]))
        """,
        out,
        out,
    )
    assert done.returncode == 2 and "cannot be written" in done.stderr and "Traceback" not in done.stderr, done.stderr
    assert out.read_bytes() == before
    assert sorted(p.name for p in mesh.parent.iterdir()) == sorted({mesh.name, out.name})


@pytest.mark.skipif(sys.platform != "linux", reason="what a process has is read from /proc")
def test_too_little_memory(mesh):
    done = run(
        """
        has = next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmData"))  # kB
        resource.setrlimit(resource.RLIMIT_DATA, (1024 * has + 50 * 2**20, resource.RLIM_INFINITY))
        sys.exit(main(["fill", IN, OUT, "--method", "side_vertex", "--resolution", "700"]))
        """,
        mesh,
        mesh.with_name("out.obj"),
    )
    assert done.returncode == 2 and "memory" in done.stderr and "Traceback" not in done.stderr, done.stderr
    assert [p.name for p in mesh.parent.iterdir()] == [mesh.name]


@pytest.mark.parametrize(
    ("out", "reason"),
    [("not/there/out.obj", "does not exist"), ("folder", "cannot be written"), ("folder/.", "cannot be written")],
)
def test_places_that_cannot_be_written(out, reason, mesh, capsys):
    (mesh.parent / "folder").mkdir()
    before = mesh.read_bytes()
    assert main(["fill", str(mesh), str(mesh.parent / out)]) == 2
    assert reason in capsys.readouterr().err
    assert mesh.read_bytes() == before and not list((mesh.parent / "folder").iterdir())


@pytest.mark.skipif(getattr(os, "geteuid", lambda: 0)() == 0, reason="root writes where nobody may")
def test_a_folder_that_may_only_be_read(mesh, capsys):
    mesh.parent.chmod(0o555)
    try:
        assert main(["fill", str(mesh), str(mesh)]) == 2
        assert "cannot be written" in capsys.readouterr().err
    finally:
        mesh.parent.chmod(0o755)


def test_ended_while_it_writes(mesh):
    """As by a power cut: half of the new file is written, and nothing after that happens."""
    before = mesh.read_bytes()
    done = run(
        """
        whole = files.MeshFile.write
        def save(self, path, own=files.obj.ObjFile._save):
            own(self, path)
            os.truncate(path, os.path.getsize(path) // 2)
            os.kill(os.getpid(), signal.SIGKILL)
        files.obj.ObjFile._save = save
        main(["fill", IN, OUT])
        """,
        mesh,
        mesh,
    )
    assert done.returncode == -9, done.stderr
    assert mesh.read_bytes() == before


def test_ctrl_c_at_every_50_ms(mesh):
    """In one process, whose timer comes later each time: the file is as it was or whole, and nothing is left next to it."""
    original = mesh.read_bytes()
    done = run(
        """
        original = open(IN, "rb").read()
        main(["fill", IN, OUT, "--resolution", "60"])
        whole = open(OUT, "rb").read()
        os.remove(OUT)
        signal.signal(signal.SIGALRM, signal.default_int_handler)
        for k in range(1, 1000):
            open(IN, "wb").write(original)
            signal.setitimer(signal.ITIMER_REAL, 0.05 * k)
            answer = main(["fill", IN, IN, "--resolution", "60"])
            signal.setitimer(signal.ITIMER_REAL, 0)
            assert answer in (0, 130), answer
            assert open(IN, "rb").read() in ((whole,) if answer == 0 else (whole, original)), k
            assert os.listdir(os.path.dirname(IN)) == [os.path.basename(IN)], k
            if answer == 0:
                break
        print("interrupted", k - 1)
        """,
        mesh,
        mesh.with_name("out.obj"),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "interrupted" in done.stdout and "Traceback" not in done.stderr
    assert mesh.read_bytes() != original


@pytest.mark.parametrize("links", [1, 2])
def test_ctrl_c_after_any_call_of_writing(links, mesh):
    """Python lets an interrupt in where a function begins and where one of C has returned: after each of these in turn."""
    original = mesh.read_bytes()
    if links == 2:
        mesh.with_name("other name.obj").hardlink_to(mesh)
    names = sorted(os.listdir(mesh.parent))
    left = calls = 0

    def interrupt(frame, event, _):
        nonlocal left
        if event in ("call", "c_return"):
            left -= 1
            if left == 0:
                raise KeyboardInterrupt

    while not left:
        calls += 1
        mesh.write_bytes(original)
        left = calls
        sys.setprofile(interrupt)
        try:
            write_over(mesh, lambda part: part.write_bytes(b"new"))
        except KeyboardInterrupt:
            pass
        finally:
            sys.setprofile(None)
        assert sorted(os.listdir(mesh.parent)) == names, calls
        if left:
            assert mesh.read_bytes() == b"new"
        elif links == 1:
            assert mesh.read_bytes() in (original, b"new")
    assert calls > 30
