"""Measures `tripatch batch`: against processes that share nothing, the scheduler's own part, memory, and a run that is killed.

    python scripts/batch_figures.py [--files 1000] [--workers 2] [--kill] [--sheet PNG]

--kill: a process and then the whole run are killed half-way, and the run continues: the night's test with --files 10000. Figures
are CPU seconds of all processes together, which other work on the machine changes little; wall seconds next to them.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

_ALONE = """
import sys
import tripatch
from pathlib import Path
from tripatch import files
out = Path(sys.argv[1])
for name in Path(sys.argv[2]).read_text().splitlines():
    mesh = files.read(name)
    fills = tripatch.fill_all(mesh.vertices, mesh.faces)
    for fill in fills:
        if isinstance(fill, tripatch.Fill):
            mesh.append(fill)
    mesh.write(out / Path(name).name)
"""


def write_meshes(folder: Path, count: int) -> list[Path]:
    """Pieces of ellipsoids around three-sided and round holes with 12 to 72 edges, no two alike."""
    rng, paths = np.random.default_rng(18), []
    for k in range(count):
        m, rings = 12 + k % 61, 4
        angle = np.arange(m) / m * 2 * np.pi
        radius = np.linspace(0.4, 0.8, rings + 1)[:, None] * (1 + 0.08 * (k % 2) * np.cos(3 * angle))
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        z = np.sqrt(1 - np.minimum(x**2 + y**2, 0.99)) * rng.uniform(0.4, 1.2)
        points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
        text = "".join(f"v {p[0]!r} {p[1]!r} {p[2]!r}\n" for p in points.tolist())
        for j in range(rings):
            for i in range(m):
                a, b = j * m + i + 1, j * m + (i + 1) % m + 1
                text += f"f {a} {a + m} {b + m} {b}\n"
        path = folder / f"{k % 10}" / f"mesh{k:06}.obj"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        paths.append(path)
    return paths


class Used:
    """CPU seconds and the largest memory of all processes of some sessions, whoever ends them and whoever waits for them."""

    def __init__(self) -> None:
        self._ticks: dict[int, tuple[str, int]] = {}
        self.peak: dict[str, float] = {}  # MB by what the process is

    def look(self, sessions: set[int]) -> None:
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                words = stat.read_text().rpartition(")")[2].split()
                if int(words[3]) not in sessions:
                    continue
                pid, said = int(stat.parent.name), (stat.parent / "cmdline").read_bytes()
                memory = re.search(r"VmHWM:\s+(\d+)", (stat.parent / "status").read_text())
            except OSError:
                continue
            kind = "worker" if b"spawn_main" in said else "child" if b"batch.child" in said else "main"
            if not said:  # ended, and not waited for yet
                kind = self._ticks.get(pid, ("main", 0))[0]
            self._ticks[pid] = kind, int(words[11]) + int(words[12])
            if memory:
                self.peak[kind] = max(self.peak.get(kind, 0), int(memory[1]) / 1024)

    def seconds(self) -> dict[str, float]:
        """By what the process is."""
        found: dict[str, float] = {}
        for kind, ticks in self._ticks.values():
            found[kind] = found.get(kind, 0) + ticks / os.sysconf("SC_CLK_TCK")
        return found


def measured(commands: list[list[str]]) -> tuple[dict[str, float], float, dict[str, float]]:
    """CPU and wall seconds of commands at the same time, and the peak memory by process in MB."""
    used, begun = Used(), time.monotonic()
    said = [tempfile.TemporaryFile() for _ in commands]
    running = [
        subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=err, start_new_session=True)
        for command, err in zip(commands, said)
    ]
    sessions = {process.pid for process in running}
    while any(process.poll() is None for process in running):
        used.look(sessions)
        time.sleep(0.05)
    wall = time.monotonic() - begun
    for process, err in zip(running, said):
        err.seek(0)
        assert process.returncode in (0, 3), (process.returncode, err.read())
    return used.seconds(), wall, used.peak


def batch(folder: Path, out: Path, workers: int, *more: str) -> list[str]:
    return [sys.executable, "-m", "tripatch", "batch", str(folder), "--out", str(out), "--workers", str(workers), *more]


def killed_half_way(folder: Path, out: Path, count: int, workers: int) -> None:
    """A process that fills is killed at a quarter, the run at a half; then it continues to the end."""

    def done() -> int:
        return sum(1 for _ in out.rglob("*.obj"))

    run = subprocess.Popen(batch(folder, out, workers), stdout=subprocess.DEVNULL, start_new_session=True)
    while done() < count // 4 and run.poll() is None:
        time.sleep(0.05)
    listed = subprocess.run(["pgrep", "-P", str(run.pid)], capture_output=True, text=True).stdout.split()
    parts = [p for p in listed if b"batch.child" in Path(f"/proc/{p}/cmdline").read_bytes()]
    os.kill(int(parts[0]), signal.SIGKILL)
    print(f"killed a process that fills with {done()} files done")
    while done() < count // 2 and run.poll() is None:
        time.sleep(0.05)
    os.killpg(run.pid, signal.SIGKILL)
    run.wait()
    time.sleep(2)  # the processes that fill find out by themselves that nobody asks any more
    print(f"killed the run with {done()} files done")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--kill", action="store_true")
    parser.add_argument("--sheet", type=Path, metavar="PNG", help="the contact sheet of 80 files only, as docs/batch.md has it")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        if args.sheet:
            write_meshes(folder / "in", 80)
            measured([batch(folder / "in", folder / "out", 0, "--worst", "8")])
            shutil.copy(folder / "out" / "tripatch-batch.png", args.sheet)
            return
        paths = write_meshes(folder / "in", args.files)
        alone = []
        for k in range(args.workers):
            share = [path for j, path in enumerate(paths) if j // 2 % args.workers == k]  # as many round holes in each
            (folder / f"list{k}").write_text("\n".join(map(str, share)))
            (folder / f"alone{k}").mkdir()
            alone.append([sys.executable, "-c", _ALONE, str(folder / f"alone{k}"), str(folder / f"list{k}")])
        parts, wall, _ = measured(alone)
        cpu = sum(parts.values())
        print(f"{args.workers} processes that share nothing: {cpu:.1f} s CPU, {wall:.1f} s wall")
        if args.kill:
            killed_half_way(folder / "in", folder / "out", len(paths), args.workers)
        parts, own_wall, peak = measured([batch(folder / "in", folder / "out", args.workers, "--worst", "0")])
        own = sum(parts.values())
        said = ", ".join(f"{kind} {seconds:.1f}" for kind, seconds in sorted(parts.items()))
        print(f"tripatch batch: {own:.1f} s CPU ({said}), {own_wall:.1f} s wall")
        print(f"part of the rate of processes that share nothing: {cpu / own:.2f} by CPU, {wall / own_wall:.2f} by wall")
        print(f"beside the files' own processes: {1000 * (own - parts['child']) / len(paths):.2f} ms CPU a file")
        parts, again_wall, _ = measured([batch(folder / "in", folder / "out", args.workers, "--worst", "0")])
        again = sum(parts.values())
        print(f"again, with nothing to do: {again:.1f} s CPU, {1000 * again / len(paths):.2f} ms a file, {again_wall:.1f} s wall")
        (folder / "one").mkdir()
        measured([batch(folder / "in", folder / "one", 0, "--worst", "0")])
        lines = [(folder / name / "tripatch-batch.jsonl").read_bytes() for name in ("out", "one")]
        assert lines[0] == lines[1], "the lines depend on the workers"
        print(f"the same {len(lines[0].splitlines())} lines from {args.workers} workers and from one process")
        print("peak memory: " + ", ".join(f"{kind} {size:.0f} MB" for kind, size in sorted(peak.items())))


if __name__ == "__main__":
    main()
