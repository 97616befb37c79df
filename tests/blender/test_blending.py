"""object.blend_three_patches: three surfaces over one hole, or next to it, and their weights."""

import sys

import bpy
import numpy as np
import pytest
from test_between_patches import CORNERS, add_surface, as_mesh, border, drawn, three

blend = bpy.ops.object.blend_three_patches


def constituent(i, bulge=0.2):
    """Control points of a surface over the hole: its edge v = 0 is a side, and it continues beyond the corner opposite."""
    a, b, opposite = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3], CORNERS[i]
    u, v = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 1, 4), indexing="ij")
    points = a + u[..., None] * (b - a) + v[..., None] * (opposite - (a + b) / 2)
    points[1:3] += 0.2 * np.ones(3)
    points[:, 2:] += bulge * np.ones(3)
    return points


def over(bulges=(0.2, 0.2, 0.2), names="ABC"):
    return [add_surface(constituent(i, bulges[i]), names[i], resolution=4) for i in range(3)]


def run(obs, **options):
    bpy.ops.object.select_all(action="DESELECT")
    for ob in obs:
        ob.select_set(True)
    before = set(bpy.data.objects)
    assert blend(**options) == {"FINISHED"}
    (new,) = set(bpy.data.objects) - before
    assert bpy.context.view_layer.objects.active == new and not new.data.validate(verbose=True)
    return new


def points_of(ob):
    return np.array([ob.matrix_world @ v.co for v in ob.data.vertices])


def live(addon):
    return sys.modules[addon.__name__ + ".live"]


def test_the_blend_has_the_sides_of_its_surfaces():
    obs = over()
    new = run(obs)
    surfaces, normals = (np.vstack(parts) for parts in zip(*map(drawn, obs), strict=True))
    corners = [min(border(new), key=lambda v: np.linalg.norm(np.array(new.data.vertices[v].co) - c)) for c in CORNERS]
    for v in border(new):
        gaps = np.linalg.norm(surfaces - np.array(new.data.vertices[v].co), axis=1)
        assert gaps.min() < 1e-6
        if v not in corners:
            assert normals[gaps.argmin()] @ np.array(new.data.vertices[v].normal) > 0, "it faces the other way"
    assert len(border(new)) == 3 * (4 * 4 - 1)


def test_surfaces_with_the_same_sides_and_planes_change_the_inside():
    """Figures 13 to 16 of Szilvasi-Nagy and Szabo."""
    flat, high, one = run(over()), run(over((0.5, 0.5, 0.5), "DEF")), run(over((0.5, 0.2, 0.2), "GHI"))
    rim = border(flat)
    for other in (high, one):
        assert np.abs(points_of(flat)[rim] - points_of(other)[border(other)]).max() < 1e-6
    middle = [p[len(rim) :].mean(axis=0) @ np.ones(3) for p in map(points_of, (flat, one, high))]
    assert middle[0] + 0.01 < middle[1] < middle[2] - 0.01


def test_lambda_weighs_the_surfaces_and_is_undone():
    obs = over((0.6, 0.1, 0.1))
    new = run(obs)
    bpy.ops.ed.undo_push(message="Blend")
    plain, name = points_of(new), new.name
    new.tripatch_lambda = (0.1, 0.5, 0.5)
    bpy.ops.ed.undo_push(message="Weigh")
    moved = points_of(bpy.data.objects[name])
    assert np.linalg.norm(moved - plain, axis=1).max() > 0.01 * np.ptp(plain, axis=0).max()
    assert list(bpy.data.objects[name].tripatch_lambda) == pytest.approx([0.1, 0.5, 0.5])
    bpy.ops.ed.undo()
    new = bpy.data.objects[name]
    assert points_of(new).tobytes() == plain.tobytes()
    assert list(new.tripatch_lambda) == [0.5, 0.5, 0.5]


def test_a_weight_towards_a_surface_takes_after_it(addon):
    obs = over((0.6, 0.1, 0.1))
    new = run(obs)
    names = live(addon).settings_of(new)["names"]
    heights = {}
    for k in range(3):
        for weight in (0.05, 0.95):
            shape = [0.5] * 3
            shape[k] = weight
            new.tripatch_lambda = shape
            heights[k, weight] = (points_of(new) @ np.ones(3)).mean()
    i = names.index("A")
    assert heights[i, 0.05] > heights[i, 0.95]  # 0: all of surface i
    assert heights[(i + 1) % 3, 0.95] > heights[(i + 1) % 3, 0.05]  # 1: all of the surface before


def test_options_are_those_of_the_library():
    obs = over((0.4, 0.2, 0.1))
    first = run(obs, shape=(0.2, 0.5, 0.7))
    assert list(first.tripatch_lambda) == pytest.approx([0.2, 0.5, 0.7])
    second = run(obs, shape=(0.2, 0.5, 0.7), method="szilvasi_nagy_c0")
    assert np.abs(points_of(first)[border(first)] - points_of(second)[border(second)]).max() < 1e-6
    best = run(obs, optimal_shape=True)
    assert list(best.tripatch_lambda) != [0.5, 0.5, 0.5]
    finer = run(obs, resolution=24)
    assert len(border(finer)) == 3 * 24


@pytest.mark.parametrize("meshes", ["", "A", "ABC"])
def test_objects_beside_the_hole_are_continued_into_it(meshes):
    obs = three(resolution=8)
    obs = [as_mesh(ob) if ob.name in meshes else ob for ob in obs]
    new = run(obs)
    surfaces, normals = (np.vstack(parts) for parts in zip(*map(drawn, obs), strict=True))
    corners = [min(border(new), key=lambda v: np.linalg.norm(np.array(new.data.vertices[v].co) - c)) for c in CORNERS]
    for v in border(new):
        gaps = np.linalg.norm(surfaces - np.array(new.data.vertices[v].co), axis=1)
        assert gaps.min() < 2e-6 * np.ptp(surfaces, axis=0).max()
        if v not in corners:
            assert normals[gaps.argmin()] @ np.array(new.data.vertices[v].normal) > 0


def test_it_follows_its_surfaces_and_is_applied(addon):
    obs = over()
    new = run(obs)
    before = points_of(new)
    points = np.array([p.co for p in obs[0].data.splines[0].points])
    places = np.argsort(points[:, :3] @ CORNERS[0])[-8:]  # two rows, far from its side
    points[places, :3] += 1
    obs[0].data.splines[0].points.foreach_set("co", points.ravel())
    obs[0].data.update_tag()
    assert live(addon).refill(new) == ""
    after, rim = points_of(new), border(new)
    assert np.abs(after[rim] - before[rim]).max() < 1e-6
    assert np.abs(after[len(rim) :].mean(axis=0) - before[len(rim) :].mean(axis=0)).max() > 0.01
    assert bpy.ops.object.apply_live_fill(fill=new.name) == {"FINISHED"}
    assert not live(addon).is_blend(new)
    assert list(new.tripatch_lambda) == [0.5, 0.5, 0.5]


def test_the_handles_move_the_weights(addon):
    blending = sys.modules[addon.__name__ + ".blending"]
    new = run(over((0.6, 0.1, 0.1)))
    tracks = blending.tracks(new)
    for k, (start, end) in enumerate(tracks):
        get, put = blending.handlers(k)
        long = (end - start).length
        assert get() == pytest.approx(0.5 * long)
        put(0.25 * long)
        assert new.tripatch_lambda[k] == pytest.approx(0.25)
        put(9 * long)  # beyond the end of its way
        assert 0.99 < new.tripatch_lambda[k] < 1
    assert blending.active_blend(bpy.context) == new
    bpy.context.view_layer.objects.active = None
    assert blending.active_blend(bpy.context) is None


def test_what_cannot_be_blended_is_refused_and_changes_nothing():
    obs = over()
    obs[2].location.z = 0.1
    bpy.context.view_layer.update()
    bpy.ops.object.select_all(action="DESELECT")
    for ob in obs:
        ob.select_set(True)
    before = set(bpy.data.objects)
    with pytest.raises(RuntimeError, match="do not meet: they are 0.1 apart"):
        blend()
    assert set(bpy.data.objects) == before
    assert blend(by_hand=True) == {"FINISHED"} and set(bpy.data.objects) == before
    obs[2].select_set(False)
    with pytest.raises(RuntimeError, match="three surface or mesh objects"):
        blend()
    obs[2].location.z = 5e-4
    bpy.context.view_layer.update()
    new = run(obs)  # within the tolerance: ends meet in the middle
    assert len(border(new)) == 3 * (4 * 4 - 1)


def test_the_file_keeps_it(tmp_path, addon):
    name = run(over(), shape=(0.3, 0.5, 0.5)).name
    path = str(tmp_path / "blend.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    new = bpy.data.objects[name]
    assert live(addon).is_blend(new)
    new.tripatch_lambda = (0.6, 0.5, 0.5)
    assert list(new.tripatch_lambda) == pytest.approx([0.6, 0.5, 0.5])
