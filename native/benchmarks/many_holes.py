"""Times fills in a mesh that is large next to its holes: a height field of a million vertices with 900 three-sided holes.

    python many_holes.py [--cells N] [--holes K] [--side E]

Each figure is wall time and CPU time in seconds, the best of a few runs. What counts is that a hole costs what the hole is worth,
not the mesh: `all` over the number of holes against `one` in a small mesh.
"""

import argparse
import os
import time

import numpy as np
import tripatch


def mesh(cells: int, holes: int, side: int) -> tuple[np.ndarray, np.ndarray, list[list[int]]]:
    """A height field of cells^2 squares, two triangles each, with holes^2 right-angled triangular holes of 3 side edges."""
    n = cells + 1
    x, y = np.meshgrid(np.arange(n), np.arange(n))
    z = 3 * np.sin(2 * np.pi / 50 * x) * np.cos(2 * np.pi / 50 * y)
    vertices = np.column_stack([x.ravel(), y.ravel(), z.ravel()]).astype(float)
    i, j = np.meshgrid(np.arange(cells), np.arange(cells), indexing="ij")
    a = (i * n + j).ravel()
    low, high = np.column_stack([a, a + 1, a + n]), np.column_stack([a + 1, a + n + 1, a + n])
    keep_low, keep_high = np.ones((cells, cells), bool), np.ones((cells, cells), bool)
    pitch = cells // holes
    start = (pitch - side) // 2
    rims = []
    for p in range(holes):
        for q in range(holes):
            r, c = p * pitch + start, q * pitch + start
            for k in range(side):
                keep_low[r + k, c : c + side - k] = False
                keep_high[r + k, c : c + side - k - 1] = False
            corner = r * n + c
            along = [corner + k for k in range(side)]
            slant = [corner + (side - k) + k * n for k in range(side)]
            back = [corner + (side - k) * n for k in range(side)]
            rims.append(along + slant + back)
    faces = np.concatenate([low[keep_low.ravel()], high[keep_high.ravel()]])
    return vertices, faces, rims


def best(runs: int, work) -> str:
    wall, cpu = [], []
    for _ in range(runs):
        w, c = time.perf_counter(), time.process_time()
        work()
        wall.append(time.perf_counter() - w)
        cpu.append(time.process_time() - c)
    return f"wall {min(wall):8.4f}   cpu {min(cpu):8.4f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=975, help="squares along each edge of the height field")
    parser.add_argument("--holes", type=int, default=30, help="holes along each edge")
    parser.add_argument("--side", type=int, default=6, help="edges of each side of a hole")
    parser.add_argument("--runs", type=int, default=3)
    args = parser.parse_args()
    vertices, faces, rims = mesh(args.cells, args.holes, args.side)
    print(
        f"{len(vertices)} vertices, {len(faces)} triangles, {len(rims)} holes of {3 * args.side} edges, {os.cpu_count()} threads"
    )
    few = mesh(40, 1, args.side)
    for fairing in (None, "auto"):
        print(f"fairing {fairing}")
        print("  one, small mesh   ", best(10, lambda f=fairing: tripatch.fill(few[0], few[1], rim=few[2][0], fairing=f)))
        rim = rims[len(rims) // 2]
        print("  one, this mesh    ", best(10, lambda f=fairing, r=rim: tripatch.fill(vertices, faces, rim=r, fairing=f)))
        print("  all, this mesh    ", best(args.runs, lambda f=fairing: tripatch.fill_all(vertices, faces, rims, fairing=f)))
    print("  border loops      ", best(args.runs, lambda: tripatch.find_holes(faces)))


if __name__ == "__main__":
    main()
