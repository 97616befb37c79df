"""glTF, 3MF and USD: holes in the meshes of scenes are filled where they lie, and all that was there is there after."""

import json
import struct
import sys
import zipfile

import numpy as np
import pytest
import tripatch
from test_cli import run
from test_outer_borders import sheet
from tripatch import borders, files

HOLE = [k for k in range(64) if 2 <= k // 8 < 6 and 2 <= k % 8 < 6]
PLACED = np.array([[0, -2, 0, 3], [2, 0, 0, 4], [0, 0, 2, 5], [0, 0, 0, 1.0]])  # turned, twice as large, moved
MIRRORED = np.diag([-1.0, 1, 1, 1])


def triangles(faces):
    return np.array([(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)])


def bowl(side=8):
    """A curved sheet with a hole of 16 edges."""
    vertices, faces = sheet(side, 1.0, HOLE)
    return np.column_stack([vertices[:, :2], 0.2 * vertices[:, 0] ** 2]), triangles(faces)


def texture(points):
    return points[:, :2] * [0.5, 0.25] + [0.25, 0.5]


def world(points, matrix):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


# glTF


class Gltf:
    """A file that is put together by pygltflib."""

    def __init__(self):
        self.pygltflib = pytest.importorskip("pygltflib")
        g = self.pygltflib
        self.data, self.gltf = b"", g.GLTF2(asset=g.Asset(version="2.0", copyright="mine"), scene=0, scenes=[g.Scene(nodes=[])])
        self.gltf.extensionsUsed = ["EXT_mine"]
        self.gltf.extensions = {"EXT_mine": {"kept": [1, 2.5, ""]}}

    def accessor(self, values, kind=5126, **more):
        values = np.ascontiguousarray(values, {5126: "<f4", 5125: "<u4", 5123: "<u2", 5121: "<u1"}[kind])
        self.data += bytes(-len(self.data) % 4)
        self.gltf.bufferViews.append(self.pygltflib.BufferView(buffer=0, byteOffset=len(self.data), byteLength=values.nbytes))
        self.data += values.tobytes()
        shape = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}[values.shape[1] if values.ndim > 1 else 1]
        bounds = {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()} if values.ndim > 1 else {}
        view = len(self.gltf.bufferViews) - 1
        made = self.pygltflib.Accessor(bufferView=view, componentType=kind, count=len(values), type=shape, **bounds, **more)
        self.gltf.accessors.append(made)
        return len(self.gltf.accessors) - 1

    def mesh(self, primitives, matrix=None, **more):
        g = self.pygltflib
        self.gltf.meshes.append(g.Mesh(primitives=primitives, extras={"mine": "mesh"}, **more))
        column = None if matrix is None else matrix.T.ravel().tolist()
        self.gltf.nodes.append(g.Node(mesh=len(self.gltf.meshes) - 1, matrix=column, extras={"mine": True}))
        self.gltf.scenes[0].nodes.append(len(self.gltf.nodes) - 1)

    def primitive(self, points, faces, material=None, **attributes):
        g = self.pygltflib
        given = {name: values if isinstance(values, tuple) else (values,) for name, values in attributes.items()}
        named = {name: self.accessor(*values) for name, values in given.items()}
        own = g.Attributes(POSITION=self.accessor(points), **named)
        return g.Primitive(attributes=own, indices=self.accessor(np.ravel(faces), 5125), material=material)

    def write(self, path):
        self.gltf.buffers = [self.pygltflib.Buffer(byteLength=len(self.data))]
        self.gltf.set_binary_blob(self.data)
        self.gltf.save(path)
        return path


def split(points, faces, by):
    """Every face of a kind has vertices of its own: a seam."""
    rows, made = {}, []
    for face in faces:
        kind = by(points[face].mean(axis=0))
        made.append([rows.setdefault((int(v), kind), len(rows)) for v in face])
    old = np.array([v for v, _ in rows])
    return old, np.array(made), np.array([kind for _, kind in rows])


def left(middle):
    return bool(middle[0] < 0.5)


def with_seams(path):
    """Two primitives of one mesh, parted by material through the hole, with normals and texture coordinates; and a second mesh,
    which lies elsewhere and mirrored."""
    file, (points, faces) = Gltf(), bowl()
    g = file.pygltflib
    file.gltf.materials = [g.Material(name="red", extras={"m": 1}), g.Material(name="blue")]
    primitives = []
    for half in (True, False):
        mine = faces[[left(points[face].mean(axis=0)) == half for face in faces]]
        used, inverse = np.unique(mine, return_inverse=True)
        own = points[used]
        normals = np.column_stack([-0.4 * own[:, 0], 0 * own[:, 0], 1 + 0 * own[:, 0]])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        colors = np.column_stack([own[:, 0], 0.5 + 0 * own[:, 0], own[:, 1]])
        given = {"NORMAL": normals, "TEXCOORD_0": texture(own) + (0 if half else 5), "COLOR_0": colors}
        primitives.append(file.primitive(own, inverse.reshape(-1, 3), int(half), **given))
    file.mesh(primitives, PLACED)
    file.mesh([file.primitive(points + [30, 0, 0], faces, 0)], MIRRORED)
    return file.write(path)


def json_of(path):
    data = path.read_bytes()
    if data[:4] != b"glTF":
        return json.loads(data), b""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def assert_kept(old, new, path=""):
    """All of the old JSON is in the new one; lists may be longer, and buffers larger."""
    if isinstance(old, dict):
        for key, value in old.items():
            if key != "byteLength" or "/buffers/" not in path:
                assert_kept(value, new[key], f"{path}/{key}")
    elif isinstance(old, list):
        for k, value in enumerate(old):
            assert_kept(value, new[k], f"{path}/{k}")
    else:
        assert old == new, path


def holes(path):
    mesh = tripatch.read(path)
    found = borders.find(mesh.vertices, mesh.faces)
    return [len(rim) for rim in found.rims]


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_gltf_all_that_was_there_is_there_after_and_strip_gives_the_file_back(tmp_path, capsys, suffix):
    path, out, back = (tmp_path / f"{name}{suffix}" for name in ("in", "out", "back"))
    with_seams(path)
    assert holes(path) == [16, 16]
    code, said, err = run(capsys, "fill", path, "-o", out, "--all")
    assert (code, err) == (0, "") and "Filled 2 holes" in said
    assert holes(out) == []
    (old, data), (new, more) = json_of(path), json_of(out)
    assert_kept(old, new)
    assert more.startswith(data) or suffix == ".gltf"
    assert run(capsys, "strip", out, "-o", back)[0] == 0
    assert back.read_bytes() == path.read_bytes()


def test_gltf_new_primitives_have_the_material_and_say_which_fills_they_hold(tmp_path, capsys):
    path, out = with_seams(tmp_path / "in.glb"), tmp_path / "out.glb"
    assert run(capsys, "fill", path, out, "--all")[0] == 0
    said = json_of(out)[0]
    added = [p for mesh, count in zip(said["meshes"], (2, 1), strict=True) for p in mesh["primitives"][count:]]
    assert sorted(p["material"] for p in added) == [0, 0, 1]
    fills = [fill for p in added for fill in p["extras"]["tripatch_fill"]]
    assert {fill["fill"] for fill in fills} == {1, 2} and all(fill["method"] for fill in fills)
    for p in added:
        assert said["accessors"][p["indices"]]["count"] == 3 * sum(fill["faces_here"] for fill in p["extras"]["tripatch_fill"])


def test_gltf_fills_lie_on_the_surface_and_continue_its_attributes(tmp_path, capsys):
    path, out = with_seams(tmp_path / "in.glb"), tmp_path / "out.glb"
    assert run(capsys, "fill", path, out, "--all")[0] == 0
    mesh = files.read(out)
    for primitive in json_of(out)[0]["meshes"][0]["primitives"][2:]:
        values = {name: mesh._decoded(k) for name, k in primitive["attributes"].items()}
        points = values["POSITION"]
        np.testing.assert_allclose(points[:, 2], 0.2 * points[:, 0] ** 2, atol=2e-3)
        half = 0 if primitive["material"] else 5
        np.testing.assert_allclose(values["TEXCOORD_0"] - half, texture(points), atol=5e-3)
        np.testing.assert_allclose(values["COLOR_0"][:, 1], 0.5, atol=1e-6)
        np.testing.assert_allclose(values["COLOR_0"][:, 0], points[:, 0], atol=0.05)
        np.testing.assert_allclose(np.linalg.norm(values["NORMAL"], axis=1), 1, atol=1e-5)
        assert (values["NORMAL"][:, 2] > 0.8).all()
        corners = points[mesh._triangles(primitive, len(points))]
        assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0).all()
    points = mesh.vertices[np.array(mesh.faces[-2])]
    assert points[:, 0].max() < -29  # of the mirrored mesh, in the world


def test_gltf_flat_shaded_faces_with_vertices_of_their_own_are_one_surface(tmp_path, capsys):
    file, (points, faces) = Gltf(), bowl()
    file.mesh([file.primitive(points[faces.ravel()], np.arange(faces.size))])
    path = file.write(tmp_path / "in.glb")
    assert holes(path) == [16] and len(files.read(path).vertices) == len(np.unique(faces))
    assert run(capsys, "fill", path, tmp_path / "out.glb")[0] == 0
    assert holes(tmp_path / "out.glb") == []


def test_gltf_fills_that_were_made_one_after_another_are_all_stripped(tmp_path, capsys):
    first, second, third, back = (tmp_path / f"{k}.glb" for k in range(4))
    with_seams(first)
    for path, out in ((first, second), (second, third)):
        rims = tripatch.choose_holes(tripatch.read(path).vertices, tripatch.read(path).faces)
        assert run(capsys, "fill", path, out, "--rim", ",".join(map(str, rims[0])))[0] == 0
    assert holes(third) == []
    assert run(capsys, "strip", third, back)[0] == 0
    assert back.read_bytes() == first.read_bytes()


def test_gltf_buffers_beside_the_file_are_read_and_named_from_another_folder(tmp_path, capsys):
    path = with_seams(tmp_path / "in.glb")
    said, data = json_of(path)
    said["buffers"][0]["uri"] = "the%20data.bin"
    (tmp_path / "the data.bin").write_bytes(data)
    (tmp_path / "in.gltf").write_text(json.dumps(said))
    (tmp_path / "out").mkdir()
    out = tmp_path / "out" / "out.gltf"
    assert run(capsys, "fill", tmp_path / "in.gltf", out, "--all")[0] == 0
    assert json_of(out)[0]["buffers"][0]["uri"] == "../the%20data.bin" and holes(out) == []
    assert run(capsys, "strip", out, tmp_path / "back.gltf")[0] == 0
    assert (tmp_path / "back.gltf").read_bytes() == (tmp_path / "in.gltf").read_bytes()


def test_gltf_morph_targets_and_joints_go_on(tmp_path, capsys):
    file, (points, faces) = Gltf(), bowl()
    joints = (np.tile([1, 0, 0, 0], (len(points), 1)), 5123)
    own = file.primitive(points, faces, None, JOINTS_0=joints, WEIGHTS_0=np.tile([1.0, 0, 0, 0], (len(points), 1)))
    own.targets = [{"POSITION": file.accessor(np.column_stack([0 * points[:, :2], points[:, :1]]))}]
    file.mesh([own], weights=[0.0])
    assert run(capsys, "fill", file.write(tmp_path / "in.glb"), tmp_path / "out.glb")[0] == 0
    mesh = files.read(tmp_path / "out.glb")
    new = json_of(tmp_path / "out.glb")[0]["meshes"][0]["primitives"][1]
    values = {name: mesh._decoded(k) for name, k in new["attributes"].items()}
    assert (values["JOINTS_0"][:, 0] == 1).all() and (values["WEIGHTS_0"][:, 0] == 1).all()
    moved = mesh._decoded(new["targets"][0]["POSITION"])
    np.testing.assert_allclose(moved[:, 2], values["POSITION"][:, 0], atol=0.05)


@pytest.mark.parametrize("name", ["KHR_draco_mesh_compression", "EXT_meshopt_compression"])
def test_gltf_compressed_meshes_are_refused_with_a_sentence(tmp_path, capsys, name):
    said, data = json_of(with_seams(tmp_path / "in.glb"))
    if "draco" in name:
        said["meshes"][0]["primitives"][0]["extensions"] = {name: {"bufferView": 0, "attributes": {}}}
    else:
        said["bufferViews"][0]["extensions"] = {name: {"buffer": 0}}
    path = tmp_path / "packed.gltf"
    path.write_text(json.dumps(said))
    code, _, err = run(capsys, "fill", path, tmp_path / "out.gltf")
    assert code == 2 and name in err and "without compression" in err


@pytest.mark.parametrize("end", [3, 15, 40, 700, 2000])
def test_gltf_a_damaged_file_is_refused_with_a_sentence(tmp_path, capsys, end):
    path = with_seams(tmp_path / "in.glb")
    path.write_bytes(path.read_bytes()[:end])
    code, _, err = run(capsys, "fill", path, tmp_path / "out.glb")
    assert code == 2 and "cannot be read" in err and "Traceback" not in err


def test_gltf_other_libraries_read_the_result(tmp_path, capsys):
    trimesh = pytest.importorskip("trimesh")
    pygltflib = pytest.importorskip("pygltflib")
    path, out = with_seams(tmp_path / "in.glb"), tmp_path / "out.glb"
    assert run(capsys, "fill", path, out, "--all")[0] == 0
    assert [len(mesh.primitives) for mesh in pygltflib.GLTF2().load(out).meshes] == [4, 2]
    scene = trimesh.load_scene(out)
    whole = trimesh.util.concatenate(scene.dump())
    mine = tripatch.read(out)
    assert len(whole.faces) == len(mine.faces)
    np.testing.assert_allclose(whole.bounds, [mine.vertices.min(axis=0), mine.vertices.max(axis=0)], atol=1e-5)


# 3MF

SLICER = b"; settings of a slicer\nlayer_height = 0.2\n"


def threemf(path, colors=False):
    """A package that is made by lib3mf: the bowl, placed in the build by a component, and a file of a slicer next to it."""
    lib3mf = pytest.importorskip("lib3mf")
    points, faces = bowl()
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    mesh = model.AddMeshObject()
    mesh.SetName("the <bowl>")
    vertices = [lib3mf.Position((lib3mf.ctypes.c_float * 3)(*map(float, p))) for p in points]
    mesh.SetGeometry(vertices, [lib3mf.Triangle((lib3mf.ctypes.c_uint32 * 3)(*map(int, f))) for f in faces])
    if colors:
        group = model.AddColorGroup()
        numbers = [group.AddColor(wrapper.FloatRGBAToColor(float(p[0]), 0.5, float(p[1]), 1.0)) for p in points]
        for k, face in enumerate(faces):
            own = lib3mf.TriangleProperties(group.GetResourceID(), (lib3mf.ctypes.c_uint32 * 3)(*(numbers[v] for v in face)))
            mesh.SetTriangleProperties(k, own)
        mesh.SetObjectLevelProperty(group.GetResourceID(), numbers[0])
    several = model.AddComponentsObject()
    several.AddComponent(mesh, wrapper.GetTranslationTransform(0.0, 0.0, 7.0))
    model.AddBuildItem(several, wrapper.GetTranslationTransform(100.0, 0.0, 0.0))
    model.QueryWriter("3mf").WriteToFile(str(path))
    with zipfile.ZipFile(path, "a") as package:
        package.writestr("Metadata/slicer.config", SLICER)
    return path


def test_3mf_all_that_was_there_is_there_after_and_strip_gives_the_file_back(tmp_path, capsys):
    path, out, back = (tmp_path / f"{name}.3mf" for name in ("in", "out", "back"))
    threemf(path)
    mesh = tripatch.read(path)
    np.testing.assert_allclose(mesh.vertices.min(axis=0), [100, 0, 7], atol=1e-5)
    code, said, err = run(capsys, "fill", path, "-o", out)
    assert (code, err) == (0, "") and "Filled 1 hole" in said
    assert out.read_bytes().startswith(path.read_bytes()) and holes(out) == []
    with zipfile.ZipFile(out) as package:
        assert package.testzip() is None and package.read("Metadata/slicer.config") == SLICER
    assert run(capsys, "strip", out, "-o", back)[0] == 0
    assert back.read_bytes() == path.read_bytes()


def test_3mf_lib3mf_reads_the_fill_and_what_is_said_of_it(tmp_path, capsys):
    path, out = threemf(tmp_path / "in.3mf"), tmp_path / "out.3mf"
    count = len(tripatch.read(path).faces)
    assert run(capsys, "fill", path, out)[0] == 0
    import lib3mf

    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.ReadFromFile(str(out))
    assert reader.GetWarningCount() == 0
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    mesh = meshes.GetCurrentMeshObject()
    assert mesh.GetName() == "the <bowl>" and mesh.GetTriangleCount() > count
    group = model.GetMetaDataGroup()
    said = json.loads(next(group.GetMetaData(k).GetValue() for k in range(group.GetMetaDataCount())))
    assert said["fill"] == 1 and said["first_face"] == count and said["faces_here"] == mesh.GetTriangleCount() - count


def test_3mf_colors_are_continued(tmp_path, capsys):
    path, out = threemf(tmp_path / "in.3mf", colors=True), tmp_path / "out.3mf"
    assert run(capsys, "fill", path, out)[0] == 0
    mesh = files.read(out)
    new = range(len(mesh.faces) - 20, len(mesh.faces))
    for f in new:
        points = mesh.vertices[mesh.faces[f]] - [100, 0, 7]
        wanted = np.column_stack([255 * points[:, 0], 0 * points[:, 0] + 127.5, 255 * points[:, 1]])
        assert np.abs(mesh._by_corner(f)[:, :3] - wanted).max() < 40  # as drawn, colors are not linear
        assert mesh._entries(f)[0] == mesh._entries(0)[0]


def test_3mf_a_file_that_is_none_is_refused_with_a_sentence(tmp_path, capsys):
    path = tmp_path / "in.3mf"
    for data in (b"", b"PK\x03\x04", b"solid"):
        path.write_bytes(data)
        code, _, err = run(capsys, "fill", path, tmp_path / "out.3mf")
        assert code == 2 and "The 3MF file is damaged" in err


# USD


def usd(path):
    """A stage by usd-core: the bowl as quads under a transformation, with texture coordinates, colors and a subset."""
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Gf, Sdf, Usd, UsdGeom

    vertices, faces = sheet(8, 1.0, HOLE)
    points = np.column_stack([vertices[:, :2], 0.2 * vertices[:, 0] ** 2])
    stage = Usd.Stage.CreateNew(str(path))
    stage.GetRootLayer().comment = "mine"
    root = UsdGeom.Xform.Define(stage, "/root")
    root.AddTransformOp().Set(Gf.Matrix4d(*PLACED.T.ravel()))
    mesh = UsdGeom.Mesh.Define(stage, "/root/bowl")
    mesh.GetPrim().SetCustomDataByKey("mine", 3)
    mesh.CreatePointsAttr(points.astype(np.float32))
    mesh.CreateFaceVertexCountsAttr([len(face) for face in faces])
    mesh.CreateFaceVertexIndicesAttr([int(v) for face in faces for v in face])
    mesh.CreateSubdivisionSchemeAttr("none")
    primvars = UsdGeom.PrimvarsAPI(mesh)
    corners = texture(points[[v for face in faces for v in face]])
    rows, indices = np.unique(corners, axis=0, return_inverse=True)
    st = primvars.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
    st.Set(rows.astype(np.float32))
    st.SetIndices(indices.reshape(-1).tolist())
    primvars.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "vertex").Set(points.astype(np.float32))
    primvars.CreatePrimvar("label", Sdf.ValueTypeNames.StringArray, "uniform").Set(["old"] * len(faces))
    UsdGeom.Subset.CreateGeomSubset(mesh, "all", "face", list(range(len(faces))))
    UsdGeom.Sphere.Define(stage, "/root/ball")
    stage.GetRootLayer().Save()
    return path, len(points), len(faces)


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd"])
def test_usd_meshes_are_filled_in_place(tmp_path, capsys, suffix):
    (path, _, faces), out = usd(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    code, said, err = run(capsys, "fill", path, "-o", out)
    assert (code, err) == (0, "") and "Filled 1 hole" in said
    assert out.read_bytes()[:8] == path.read_bytes()[:8] and holes(out) == []
    from pxr import Usd, UsdGeom

    stage, before = Usd.Stage.Open(str(out)), Usd.Stage.Open(str(path))
    assert [p.GetPath() for p in stage.Traverse()] == [p.GetPath() for p in before.Traverse()]
    assert stage.GetRootLayer().comment == "mine"
    mesh, old = UsdGeom.Mesh.Get(stage, "/root/bowl"), UsdGeom.Mesh.Get(before, "/root/bowl")
    for name in ("points", "faceVertexCounts", "faceVertexIndices", "primvars:st", "primvars:displayColor", "primvars:label"):
        values, own = mesh.GetPrim().GetAttribute(name).Get(), old.GetPrim().GetAttribute(name).Get()
        assert len(values) > len(own) and list(values[: len(own)]) == list(own)
    points = np.array(mesh.GetPointsAttr().Get())
    np.testing.assert_allclose(points[:, 2], 0.2 * points[:, 0] ** 2, atol=2e-3)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get())
    primvars = UsdGeom.PrimvarsAPI(mesh)
    np.testing.assert_allclose(primvars.GetPrimvar("st").ComputeFlattened(), texture(points[corners]), atol=5e-3)
    np.testing.assert_allclose(primvars.GetPrimvar("displayColor").Get(), points, atol=0.05)
    assert set(primvars.GetPrimvar("label").Get()) == {"old"}
    assert len(UsdGeom.Subset.Get(stage, "/root/bowl/all").GetIndicesAttr().Get()) == len(mesh.GetFaceVertexCountsAttr().Get())
    marks = np.array(primvars.GetPrimvar("tripatch_fill").Get())
    assert (marks[:faces] == 0).all() and (marks[faces:] == 1).all() and len(marks) > faces
    data = mesh.GetPrim().GetCustomData()
    assert data["mine"] == 3 and data["tripatch"]["fill_1"]["faces_here"] == len(marks) - faces
    assert not stage.GetCompositionErrors()


def test_usd_references_are_kept_and_filled_by_opinions_of_this_layer(tmp_path, capsys):
    path, *_ = usd(tmp_path / "asset.usda")
    from pxr import Usd, UsdGeom

    (tmp_path / "out").mkdir()
    stage = Usd.Stage.CreateNew(str(tmp_path / "scene.usda"))
    stage.DefinePrim("/model").GetReferences().AddReference("./asset.usda", "/root")
    stage.GetRootLayer().Save()
    before, out = path.read_bytes(), tmp_path / "out" / "scene.usda"
    assert len(files.read(tmp_path / "scene.usda").faces) == len(files.read(path).faces) > 0
    assert run(capsys, "fill", tmp_path / "scene.usda", out)[0] == 0
    assert path.read_bytes() == before and "@../asset.usda@" in out.read_text() and holes(out) == []
    assert UsdGeom.Sphere.Get(Usd.Stage.Open(str(out)), "/model/ball")


def test_usd_without_usd_core_the_extra_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    path = tmp_path / "in.usda"
    path.write_text("#usda 1.0\n")
    code, _, err = run(capsys, "fill", path, tmp_path / "out.obj")
    assert code == 2 and "pip install tripatch[usd]" in err and err.count("\n") == 1
    tripatch.write(tmp_path / "in.obj", bowl())
    code, _, err = run(capsys, "fill", tmp_path / "in.obj", tmp_path / "out.usdc")
    assert code == 2 and "pip install tripatch[usd]" in err


def test_usd_files_that_are_none_are_refused_with_a_sentence(tmp_path, capsys):
    pytest.importorskip("pxr", reason="usd-core is not installed")
    for name in ("in.usda", "in.usdc", "in.usdz"):
        (tmp_path / name).write_bytes(b"nothing")
        code, _, err = run(capsys, "fill", tmp_path / name, tmp_path / "out.obj")
        assert code == 2 and "cannot be read" in err and "Traceback" not in err


def test_usd_what_strip_cannot_give_back_is_said(tmp_path, capsys):
    (path, *_), out = usd(tmp_path / "in.usda"), tmp_path / "out.usda"
    assert run(capsys, "fill", path, out)[0] == 0
    code, _, err = run(capsys, "strip", out, tmp_path / "back.usda")
    assert code == 1 and "do not keep what was filled" in err


# all of them

ALL = [".glb", ".gltf", ".3mf", ".usda", ".usdc"]


def made(path):
    if path.suffix.startswith(".usd"):
        return usd(path)[0]
    return threemf(path) if path.suffix == ".3mf" else with_seams(path)


@pytest.mark.parametrize("suffix", ALL)
def test_a_mesh_of_another_format_is_written_and_read_again(tmp_path, capsys, suffix):
    if suffix.startswith(".usd"):
        pytest.importorskip("pxr", reason="usd-core is not installed")
    tripatch.write(tmp_path / "in.obj", bowl())
    out = tmp_path / f"out{suffix}"
    code, _, err = run(capsys, "fill", tmp_path / "in.obj", out)
    assert code == 0 and "holds vertices and faces only" in err
    assert holes(out) == []
    np.testing.assert_allclose(tripatch.read(out).vertices[:65], bowl()[0][:65], atol=1e-7)


@pytest.mark.parametrize("suffix", ALL)
def test_fill_holes_takes_what_read_returns(tmp_path, suffix):
    path, out = made(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    before = path.read_bytes()
    mesh = tripatch.read(path)
    filled = tripatch.fill_holes(mesh)
    assert len(filled.faces) > len(mesh.faces)
    tripatch.write(out, filled)
    assert holes(out) == [] and path.read_bytes() == before
    tripatch.write(tmp_path / f"same{suffix}", mesh)
    if not suffix.startswith(".usd"):
        assert (tmp_path / f"same{suffix}").read_bytes() == before


def test_batch_fills_scenes_in_folders(tmp_path, capsys):
    (tmp_path / "in").mkdir()
    for suffix in (".glb", ".3mf"):
        made(tmp_path / "in" / f"a{suffix}")
    assert run(capsys, "batch", tmp_path / "in", "-o", tmp_path / "out", "--workers", "1")[0] == 0
    assert holes(tmp_path / "out" / "a.glb") == [] and holes(tmp_path / "out" / "a.3mf") == []
