"""Borders that are near each other are joined in glTF, 3MF and USD files too: where they lie, and nothing else changes."""

import numpy as np
import pytest
import tripatch
from test_cli import run
from test_scenes import MIRRORED, PLACED, Gltf, assert_kept, holes, json_of, world
from tripatch import files

ALL = [".glb", ".gltf", ".3mf", ".usda", ".usdc"]
GAP = 1e-4


def halves():
    """A bent plate of two parts that lie a little apart. The right one has twice the edges at the cut: T-junctions. Each has a
    hole of its own."""
    points, faces = [], []
    for side, count in ((0, 4), (1, 8)):
        xs = np.linspace(0, 1, count + 1) + side * (1 + GAP)
        ys = np.linspace(0, 2, 2 * count + 1)
        first, row = sum(map(len, points)), len(xs)
        x, y = (each.ravel() for each in np.meshgrid(xs, ys))
        points.append(np.column_stack([x, y, 0.1 * y**2]))
        for j in range(2 * count):
            for i in range(count):
                if not (count // 4 <= i < 3 * count // 4 and count // 2 <= j < 3 * count // 2):
                    a = first + j * row + i
                    faces += [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]
    return np.concatenate(points), np.array(faces)


def texture(points):
    return points[:, :2] * [0.4, 0.2] + 0.1


def gltf(path, matrix=PLACED):
    """One mesh of two primitives, of which the left one has what can be given by vertex."""
    file, (points, faces) = Gltf(), halves()
    made = []
    for mine, more in ((faces[points[faces[:, 0], 0] < 1.00001], True), (faces[points[faces[:, 0], 0] > 1.00001], False)):
        used, inverse = np.unique(mine, return_inverse=True)
        own = points[used]
        given = {"TEXCOORD_0": texture(own)}
        if more:
            given["JOINTS_0"] = (np.tile([1, 2, 0, 0], (len(own), 1)), 5121)
            given["COLOR_0"] = (np.round(255 * np.column_stack([own[:, :2] / 2, 0 * own])[:, :4]), 5121)
        made.append(file.primitive(own, inverse.reshape(-1, 3), None, **given))
        made[-1].targets = [{"POSITION": file.accessor(texture(own)[:, [0, 1, 1]])}]
    file.mesh(made, matrix, weights=[0.0])
    return file.write(path)


def threemf(path, in_one=True):
    lib3mf = pytest.importorskip("lib3mf")
    points, faces = halves()
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    several = model.AddComponentsObject()
    for mine in (faces,) if in_one else (faces[points[faces[:, 0], 0] < 1.00001], faces[points[faces[:, 0], 0] > 1.00001]):
        used, inverse = np.unique(mine, return_inverse=True)
        mesh = model.AddMeshObject()
        vertices = [lib3mf.Position((lib3mf.ctypes.c_float * 3)(*map(float, p))) for p in points[used]]
        mesh.SetGeometry(vertices, [lib3mf.Triangle((lib3mf.ctypes.c_uint32 * 3)(*map(int, f))) for f in inverse.reshape(-1, 3)])
        group = model.AddColorGroup()
        numbers = [group.AddColor(wrapper.FloatRGBAToColor(float(p[0]) / 2.1, float(p[1]) / 2.1, 0.0, 1.0)) for p in points[used]]
        for k, face in enumerate(inverse.reshape(-1, 3)):
            own = lib3mf.TriangleProperties(group.GetResourceID(), (lib3mf.ctypes.c_uint32 * 3)(*(numbers[v] for v in face)))
            mesh.SetTriangleProperties(k, own)
        mesh.SetObjectLevelProperty(group.GetResourceID(), numbers[0])
        several.AddComponent(mesh, wrapper.GetTranslationTransform(0.0, 0.0, 7.0))
    model.AddBuildItem(several, wrapper.GetTranslationTransform(100.0, 0.0, 0.0))
    model.QueryWriter("3mf").WriteToFile(str(path))
    return path


def usd(path, per_point=False, left_handed=False):
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Gf, Sdf, Usd, UsdGeom

    points, faces = halves()
    faces = faces[:, ::-1] if left_handed else faces
    stage = Usd.Stage.CreateNew(str(path))
    root = UsdGeom.Xform.Define(stage, "/root")
    root.AddTransformOp().Set(Gf.Matrix4d(*PLACED.T.ravel()))
    mesh = UsdGeom.Mesh.Define(stage, "/root/plate")
    mesh.CreatePointsAttr(points.astype(np.float32))
    mesh.CreateFaceVertexCountsAttr([3] * len(faces))
    mesh.CreateFaceVertexIndicesAttr(faces.ravel().tolist())
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateOrientationAttr("leftHanded" if left_handed else "rightHanded")
    primvars = UsdGeom.PrimvarsAPI(mesh)
    rows, indices = np.unique(texture(points[faces.ravel()]), axis=0, return_inverse=True)
    st = primvars.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
    st.Set(rows.astype(np.float32))
    st.SetIndices(indices.reshape(-1).tolist())
    plain = primvars.CreatePrimvar("plain", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
    plain.Set(texture(points[faces.ravel()]).astype(np.float32))
    if per_point:
        primvars.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "vertex").Set(points.astype(np.float32))
    stage.GetRootLayer().Save()
    return path


def made(path):
    if path.suffix.startswith(".usd"):
        return usd(path)
    return threemf(path) if path.suffix == ".3mf" else gltf(path)


@pytest.mark.parametrize("suffix", ALL)
def test_borders_are_joined_and_holes_are_filled(tmp_path, capsys, suffix):
    path, out = made(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    before = path.read_bytes()
    code, said, err = run(capsys, "fill", path, out, "--all", "--join", 50 * GAP)
    assert (code, err) == (0, "") and "Joined borders: 9 vertices moved, 8 vertices put into edges" in said
    assert "Filled 2 holes" in said and path.read_bytes() == before
    mesh = tripatch.read(out)
    assert holes(out) == [] and len(tripatch.fill_all(mesh.vertices, mesh.faces).outer_borders) == 1


@pytest.mark.parametrize("suffix", ALL)
def test_what_fill_holes_joins_is_written(tmp_path, suffix):
    path, out = made(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    mesh = tripatch.read(path)
    filled = tripatch.fill_holes(mesh, join=50 * GAP)
    tripatch.write(out, filled)
    assert holes(out) == [] and len(tripatch.fill_all(filled.vertices, filled.faces).outer_borders) == 1
    assert len(mesh.faces) == len(tripatch.read(path).faces)  # the one that was read is as it was


@pytest.mark.parametrize("suffix", [*ALL, ".stl", ".ply"])
def test_a_mesh_of_quads_is_joined_when_it_is_written_in_another_format(tmp_path, capsys, suffix):
    if suffix.startswith(".usd"):
        pytest.importorskip("pxr", reason="usd-core is not installed")
    points, faces = halves()
    quads = [[*a[:3], b[2]] for a, b in zip(faces[::2].tolist(), faces[1::2].tolist(), strict=True)]
    tripatch.write(tmp_path / "in.obj", (points, quads))
    out = tmp_path / f"out{suffix}"
    assert run(capsys, "fill", tmp_path / "in.obj", out, "--all", "--join", 50 * GAP)[0] == 0
    mesh = tripatch.read(out)
    assert holes(out) == [] and len(tripatch.fill_all(mesh.vertices, mesh.faces).outer_borders) == 1


@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".3mf"])
def test_strip_gives_the_file_back_also_where_borders_were_joined(tmp_path, capsys, suffix):
    path, out, back = (tmp_path / f"{name}{suffix}" for name in ("in", "out", "back"))
    made(path)
    assert run(capsys, "fill", path, out, "--all", "--join", 50 * GAP)[0] == 0
    assert run(capsys, "strip", out, back)[0] == 0
    assert back.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("matrix", [PLACED, MIRRORED])
def test_gltf_what_vertices_have_is_blended_within_edges(tmp_path, capsys, matrix):
    path, out = gltf(tmp_path / "in.glb", matrix), tmp_path / "out.glb"
    assert run(capsys, "fill", path, out, "--all", "--join", 50 * GAP)[0] == 0
    (old, data), (new, more) = json_of(path), json_of(out)
    assert more.startswith(data)
    for name in ("nodes", "bufferViews", "accessors", "extensions", "asset"):
        assert_kept(old[name], new[name])
    mesh, before = files.read(out), files.read(path)
    changed, moved = new["meshes"][0]["primitives"][:2]
    was = old["meshes"][0]["primitives"]
    assert moved["attributes"]["TEXCOORD_0"] == was[1]["attributes"]["TEXCOORD_0"] and moved["indices"] == was[1]["indices"]
    values = {name: mesh._decoded(k) for name, k in changed["attributes"].items()}
    points, count = values["POSITION"], len(before._decoded(was[0]["attributes"]["POSITION"]))
    assert len(points) == count + 8 and len(mesh._triangles(changed, count)) == len(before._triangles(was[0], count)) + 8
    np.testing.assert_allclose(values["TEXCOORD_0"], texture(points), atol=1e-3)
    np.testing.assert_allclose(values["COLOR_0"][:, :2] / 255, points[:, :2] / 2, atol=0.01)
    assert (values["JOINTS_0"] == [1, 2, 0, 0]).all()
    np.testing.assert_allclose(mesh._decoded(changed["targets"][0]["POSITION"])[:, :2], texture(points), atol=1e-3)
    area = [np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])[:, 2].sum() for x in [points[mesh._triangles(changed, len(points))]]]
    assert area[0] / 2 == pytest.approx(1.5, abs=1e-3)
    np.testing.assert_allclose(mesh.vertices.min(axis=0), world(halves()[0], matrix).min(axis=0), atol=1e-3)


def test_gltf_other_libraries_read_what_was_joined(tmp_path, capsys):
    trimesh = pytest.importorskip("trimesh")
    path, out = gltf(tmp_path / "in.glb"), tmp_path / "out.glb"
    assert run(capsys, "fill", path, out, "--all", "--join", 50 * GAP)[0] == 0
    whole = trimesh.util.concatenate(trimesh.load_scene(out).dump())
    whole.merge_vertices(merge_tex=True, merge_norm=True)
    borders = trimesh.grouping.group_rows(whole.edges_sorted, require_count=1)
    assert len(borders) == 2 * 4 + 2 * 8 + 8 + 16  # the outer border alone


@pytest.mark.parametrize("in_one", [True, False])
def test_3mf_triangles_share_the_vertices_that_are_joined(tmp_path, capsys, in_one):
    path, out = threemf(tmp_path / "in.3mf", in_one), tmp_path / "out.3mf"
    assert run(capsys, "fill", path, out, "--all", "--join", 50 * GAP)[0] == 0
    mesh = files.read(out)
    (first, *_), (count, *_) = ([len(part.corners) // 3 for part in each._parts] for each in (mesh, files.read(path)))
    lib3mf = pytest.importorskip("lib3mf")
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.ReadFromFile(str(out))
    assert reader.GetWarningCount() == 0 and first > count
    if in_one:
        corners = mesh._parts[0].corners.reshape(-1, 3)
        edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 1).sum() == 2 * 4 + 2 * 8 + 8 + 16
    for f in range(len(mesh.faces)):
        if mesh.vertices[mesh.faces[f], 0].max() < 101.0001:
            wanted = 255 * (mesh.vertices[mesh.faces[f]] - [100, 0, 7])[:, :2] / 2.1
            assert np.abs(mesh._by_corner(f)[:, :2] - wanted).max() < 40  # as drawn, colors are not linear


@pytest.mark.parametrize("left_handed", [False, True])
@pytest.mark.parametrize("per_point", [False, True])
def test_usd_values_of_corners_and_points_are_blended_within_edges(tmp_path, capsys, per_point, left_handed):
    path, out = usd(tmp_path / "in.usda", per_point, left_handed), tmp_path / "out.usda"
    assert run(capsys, "fill", path, out, "--all", "--join", 50 * GAP)[0] == 0
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.Open(str(out))
    mesh = UsdGeom.Mesh.Get(stage, "/root/plate")
    points, corners = np.array(mesh.GetPointsAttr().Get()), np.array(mesh.GetFaceVertexIndicesAttr().Get())
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
    assert counts.sum() == len(corners) and (counts > 3).sum() == 8
    primvars = UsdGeom.PrimvarsAPI(mesh)
    np.testing.assert_allclose(primvars.GetPrimvar("st").ComputeFlattened(), texture(points[corners]), atol=1e-3)
    np.testing.assert_allclose(primvars.GetPrimvar("plain").Get(), texture(points[corners]), atol=1e-3)
    if per_point:
        np.testing.assert_allclose(primvars.GetPrimvar("displayColor").Get(), points, atol=0.01)
    else:
        edges = np.concatenate([np.column_stack([f, np.roll(f, -1)]) for f in np.split(corners, np.cumsum(counts)[:-1])])
        borders = (np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1] == 1).sum()
        assert borders == 2 * 4 + 2 * 8 + 8 + 16
    assert not stage.GetCompositionErrors()


@pytest.mark.parametrize("suffix", [".glb", ".3mf", ".usda"])
def test_cages_move_and_split_what_is_at_the_rim(tmp_path, capsys, suffix):
    path, out = made(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    for rim in ("move", "exact"):
        assert run(capsys, "fill", path, out, "--all", "--faces", "cage", "--cage-rim", rim)[0] in (0, 3)
        assert holes(out) == []
