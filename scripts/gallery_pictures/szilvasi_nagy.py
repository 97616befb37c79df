"""Figures 3 to 16 of Szilvasi-Nagy and Szabo, C1-continuous Coons-type blending of triangular patches (KoG 9, 2005)."""

import numpy as np
import tripatch

from .render import BLUE, CLAY, GREEN, GREY, INK, RED, Scene, normals_of, of_patch, save, triangle_grid

COLORS = (BLUE, GREEN, RED)
CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0.87, 0]])


def constituents():
    """Three quadratic Bezier patches with common corners; patch i leans outwards along side i and sags elsewhere."""
    middle = CORNERS.mean(0)
    patches = []
    for i in range(3):
        net = {}
        for k in range(3):
            a, b = CORNERS[(k + 1) % 3], CORNERS[(k + 2) % 3]
            out = (a + b) / 2 - middle
            net[k] = (a + b) / 2 + (0.45 * out + [0, 0, 0.42] if k == i else -0.15 * out + [0, 0, [-0.02, 0.10, 0.16][i]])
        # the order (2,0,0), (1,1,0), (1,0,1), (0,2,0), (0,1,1), (0,0,2)
        patches.append(tripatch.BezierTriangle(np.array([CORNERS[0], net[2], net[1], CORNERS[1], net[0], CORNERS[2]])))
    return patches


def mu(i, b, shape):
    """The weighting function mu_i of index i = 0, 1, 2; 1 where it is 0/0, at corner i + 1."""
    x, y = shape[i] * b[..., i] ** 2, (1 - shape[i]) * b[..., (i + 2) % 3] ** 2
    return y / (x + y)


def auxiliary(i, patches, b, shape):
    """G_i = mu_(i+2) r_(i+2) + (1 - mu_(i+2)) r_(i+1); on side i the auxiliary curve g_i."""
    k = (i + 2) % 3
    m = mu(k, b, shape)[..., None]
    flat = b.reshape(-1, 3)
    at = [patches[j].evaluate(flat).reshape(b.shape) for j in (k, (i + 1) % 3)]
    return m * at[0] + (1 - m) * at[1]


def foot(i, b):
    """The foot of b on side i, at right angles in the equilateral triangle."""
    out = b + b[..., i : i + 1] / 2
    out[..., i] = 0
    return out


def correction(patches, b, shape):
    """q = sum of W_i G_i(foot_i)."""
    squares = b**2
    w = np.stack([squares[..., (i + 1) % 3] * squares[..., (i + 2) % 3] for i in range(3)], -1)
    w /= w.sum(-1, keepdims=True)
    return sum(w[..., i : i + 1] * auxiliary(i, patches, foot(i, b), shape) for i in range(3))


def side_curve(patch, i, n=60):
    b = np.zeros((n + 1, 3))
    b[:, (i + 2) % 3] = np.linspace(0, 1, n + 1)
    b[:, (i + 1) % 3] = 1 - b[:, (i + 2) % 3]
    return patch.evaluate(b)


def rim(scene, patches, width=2.6):
    for i, p in enumerate(patches):
        scene.curve(side_curve(p, i), INK, width)
    return scene


def with_constituents(surface, patches, view, lines=10, zebra=False):
    scene = Scene(*view).patch(surface, CLAY, zebra, lines)
    return rim(scene, patches)


def three(patches, view, lines=8):
    scene = Scene(*view)
    for p, color in zip(patches, COLORS, strict=True):
        scene.patch(p, color, lines=lines, lift=0.001)
    return rim(scene, patches)


def blending(folder):
    patches = constituents()
    view, side_view = (-75, 38), (-75, 6)
    half = (0.5,) * 3
    save(
        folder / "szilvasi-nagy-03.png",
        [
            three(patches, view).image(),
            *(Scene(*view).patch(p, c, lines=8).image() for p, c in zip(patches, COLORS, strict=True)),
        ],
        ["the three patches", "patch 1", "patch 2", "patch 3"],
    )

    t = np.linspace(1e-4, 1 - 1e-4, 80)
    b = np.stack([t, 0 * t, 1 - t], -1)  # side 2 of the paper: v = 0
    g = auxiliary(1, patches, b, half)
    scene = Scene(*view).patch(patches[0], BLUE, lines=8, lift=0.001).patch(patches[2], RED, lines=8, lift=0.001)
    grid = triangle_grid()
    q = correction(patches, grid, half)
    q_scene = Scene(*view).surface(q, normals_of(q), GREY).lines(q, 10)
    for i in range(3):
        edge = np.zeros((80, 3))
        edge[:, (i + 1) % 3], edge[:, (i + 2) % 3] = t, 1 - t
        q_scene.curve(auxiliary(i, patches, edge, half), INK, 2.6)
    save(
        folder / "szilvasi-nagy-04-05.png",
        [scene.curve(g, INK, 4, lift=0.5).image(), q_scene.image()],
        ["4: auxiliary curve g2, between patches 1 and 3", "5: correction term q, through g1, g2, g3"],
    )

    c0 = tripatch.blend(*patches, method="szilvasi_nagy_c0", shape="optimal")
    c1 = tripatch.blend(*patches, method="szilvasi_nagy_c1", shape="optimal")
    raised = tripatch.blend(*patches, method="szilvasi_nagy_c1", shape=(*c1.shape[:2], 0.98))
    save(
        folder / "szilvasi-nagy-06-07.png",
        [with_constituents(s, patches, view).image() for s in (c0, c1)],
        ["6: Definition 1, C0, optimal lambda", "7: Definition 2, C1, optimal lambda"],
    )
    points, normals = of_patch(raised)
    moved = np.linalg.norm(points - of_patch(c1)[0], axis=-1)
    colors = CLAY + (moved / moved.max())[..., None] * (np.array([0.85, 0.15, 0.1]) - CLAY)
    effect = rim(Scene(*view).surface(points, normals, colors).lines(points), patches)
    save(
        folder / "szilvasi-nagy-08-09.png",
        [with_constituents(s, patches, side_view).image(330, 250) for s in (c1, raised)] + [effect.image(330, 250)],
        ["8: optimal lambda, from the side", "9: lambda_3 = 0.98", f"red: moved by it, up to {moved.max():.2f}"],
    )


HOLLOW, FULL = (0.6, 0.2), (0.12, 0.0)


def prism(inner=(HOLLOW, HOLLOW, HOLLOW)):
    """Constituents for the open corner of a prism: corners on its edges, patch i touches face i along side i.

    inner[i]: where in face i the two other control points of patch i lie, along the edge next to them and into the face.
    """
    corners = -np.eye(3)
    patches = []
    for i, (along, off) in enumerate(inner):
        j, k = (i + 1) % 3, (i + 2) % 3
        rim = 0.36 * (corners[j] + corners[k])  # a hollow arc in the face x_i = 0
        net = {(j, k): rim, (i, j): along * corners[j] + off * corners[k], (i, k): along * corners[k] + off * corners[j]}
        at = {frozenset(pair): p for pair, p in net.items()}
        patches.append(
            tripatch.BezierTriangle(
                np.array(
                    [corners[0], at[frozenset((0, 1))], at[frozenset((0, 2))], corners[1], at[frozenset((1, 2))], corners[2]]
                )
            )
        )
    return patches


def faces_of_prism(scene, patches, zebra=False):
    """The three faces of the prism around the hole, flat, each between the hole's curve and the outer edges."""
    for i, p in enumerate(patches):
        inner = side_curve(p, i, 48)
        a, b = inner[0], inner[-1]
        outer = np.array([1.3 * a + 1.3 * b * k / 24 if k <= 24 else 1.3 * b + 1.3 * a * (2 - k / 24) for k in range(49)])
        steps = np.linspace(0, 1, 25)[None, :, None]
        points = inner[:, None] * (1 - steps) + outer[:, None] * steps
        normal = np.eye(3)[i]
        scene.surface(points, np.broadcast_to(normal, points.shape), GREY, zebra)
        for edge in (np.array([a, 1.3 * a]), np.array([b, 1.3 * b]), outer):
            scene.curve(edge, (0.4, 0.4, 0.42), 1.2)
    return scene


def corner(folder):
    view, side_view = (45, 32), (75, 18)
    plain, other, changed = prism(), prism((FULL, FULL, FULL)), prism((HOLLOW, HOLLOW, FULL))

    def filled(patches, v, zebra=False):
        surface = tripatch.blend(*patches, method="szilvasi_nagy_c1")
        scene = Scene(*v).patch(surface, CLAY, zebra, 0 if zebra else 10)
        return rim(faces_of_prism(scene, patches, zebra), patches)

    inside = rim(faces_of_prism(Scene(*view), plain), plain)
    for p, c in zip(plain, COLORS, strict=True):
        inside.patch(p, c, lines=5, lift=0.001)
    save(
        folder / "szilvasi-nagy-10-12.png",
        [inside.image(), filled(plain, view).image(), filled(plain, side_view).image()],
        ["10: open corner of a prism, constituents", "11: C1 surface with the neighbors", "12: from another side"],
    )
    rows = []
    for p in (other, changed):
        constituents_scene = rim(faces_of_prism(Scene(*view), p), p)
        for patch, c in zip(p, COLORS, strict=True):
            constituents_scene.patch(patch, c, lines=5, lift=0.001)
        rows += [constituents_scene.image(), filled(p, view).image(), filled(p, side_view).image()]
    save(
        folder / "szilvasi-nagy-13-16.png",
        rows,
        [
            "13: other constituents, same boundary",
            "14: the result has another shape",
            "from another side",
            "15: one input changed",
            "16: its effect inside",
            "from another side",
        ],
        columns=3,
    )


def draw(folder):
    blending(folder)
    corner(folder)
