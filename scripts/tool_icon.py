"""Writes the icon of the Shape Fill tool in the format of Blender's own tool icons: a frame with a hole of three sides, the patch
in it, a handle at each corner. Run it after a change; the file belongs to the source tree."""

import math
from pathlib import Path

FILE = Path(__file__).parents[1] / "addon" / "tripatch_blender" / "icons" / "shape_fill.dat"
LIGHT, ACCENT, HANDLE = (229, 229, 229, 255), (117, 255, 175, 255), (255, 150, 60, 255)  # the first two are Blender's
MIDDLE = (128, 122)
#: Radii of the frame's outer and inner border and of the patch, from the middle to a corner.
FRAME, HOLE, PATCH, DOT = 116, 84, 66, 19
STEPS = 8  # a side


def rounded(radius, bulge):
    """Points around a triangle whose sides bulge outwards by so much of the radius."""
    corners = [math.radians(90 + 120 * k) for k in range(3)]
    points = []
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        for k in range(STEPS):
            t = k / STEPS
            x, y = ((1 - t) * f(a) + t * f(b) for f in (math.cos, math.sin))
            longer = 1 + bulge * 4 * t * (1 - t)
            points.append((MIDDLE[0] + radius * longer * x, MIDDLE[1] - 12 + radius * longer * y))
    return points


def around(points):
    return zip(points, points[1:] + points[:1], strict=True)


def triangles():
    """(three points, their color), the last drawn on top."""
    outer, inner, patch = rounded(FRAME, 0.35), rounded(HOLE, 0.25), rounded(PATCH, 0.25)
    for (a, b), (c, d) in zip(around(outer), around(inner), strict=True):
        yield (a, b, c), LIGHT
        yield (c, b, d), LIGHT
    for a, b in around(patch):
        yield ((MIDDLE[0], MIDDLE[1] - 12), a, b), ACCENT
    for x, y in inner[::STEPS]:
        dot = [(x + DOT * math.cos(t * math.pi / 5), y + DOT * math.sin(t * math.pi / 5)) for t in range(10)]
        for a, b in around(dot):
            yield ((x, y), a, b), HANDLE


def main():
    made = list(triangles())
    coordinates = bytes(max(0, min(255, round(c))) for points, _ in made for point in points for c in point)
    colors = bytes(c for _, color in made for c in color * 3)
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_bytes(b"VCO\0" + bytes((255, 255, 0, 0)) + coordinates + colors)


if __name__ == "__main__":
    main()
