"""Run by scripts/demo in Debian's Blender: fills two real holes with the installed add-on, prints the reports, and saves a .blend and a
before/after picture.

    blender --background --factory-startup --python scripts/demo.py -- ADDON.zip OUT.blend OUT.png
"""

import math
import sys

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector

ADDON_ZIP, BLEND, PICTURE = sys.argv[sys.argv.index("--") + 1 :]


# ---------------------------------------------------------------- the two meshes


def rounded_box(size, radius, n):
    """Vertices, faces and exact vertex normals of a box whose edges are rounded with n faces a quarter turn, the corner at
    (+, +, +) missing. It is the surface of the points `radius` away from a smaller box, the core."""
    core = np.asarray(size) / 2 - radius
    points, normals, faces = [], [], []

    def grid(at, normal, nu, nv):
        """(nu + 1) x (nv + 1) points at(u, v), faces outward for u, v, normal right-handed."""
        first = len(points)
        for u in np.linspace(0, 1, nu + 1):
            for v in np.linspace(0, 1, nv + 1):
                points.append(at(u, v))
                normals.append(normal(u, v))
        for i in range(nu):
            for j in range(nv):
                a = first + i * (nv + 1) + j
                faces.append((a, a + nv + 1, a + nv + 2, a + 1))

    along = 6  # faces along an edge of the core
    for axis in range(3):
        a, b, c = np.roll(np.eye(3), axis, axis=0)
        ca, cb, cc = core @ a, core @ b, core @ c
        for s in (-1, 1):  # the flat faces across `a`, then the rounded edges along it
            order = (b, c, cb, cc) if s > 0 else (c, b, cc, cb)
            x, y, cx, cy = order
            grid(
                lambda u, v, s=s, x=x, y=y, cx=cx, cy=cy: s * (ca + radius) * a + (2 * u - 1) * cx * x + (2 * v - 1) * cy * y,
                lambda u, v, s=s: s * a,
                along,
                along,
            )
        for quarter in range(4):
            sb, sc = (1, -1, -1, 1)[quarter], (1, 1, -1, -1)[quarter]

            def normal(u, v, quarter=quarter):
                angle = (quarter + u) * math.pi / 2
                return math.cos(angle) * b + math.sin(angle) * c

            grid(
                lambda u, v, sb=sb, sc=sc, normal=normal: (2 * v - 1) * ca * a + sb * cb * b + sc * cc * c + radius * normal(u, v),
                normal,
                n,
                along,
            )
    for signs in np.ndindex(2, 2, 2):  # the corners: rows of an octant of a sphere, k + 1 points in row k
        s = 1 - 2 * np.array(signs)
        if s.min() > 0:
            continue
        first = len(points)
        for k in range(n + 1):
            for j in range(k + 1):
                polar, turn = k / n * math.pi / 2, (j / k if k else 0) * math.pi / 2
                d = s * (math.sin(polar) * math.cos(turn), math.sin(polar) * math.sin(turn), math.cos(polar))
                points.append(s * core + radius * d)
                normals.append(d)
        row = [first + k * (k + 1) // 2 for k in range(n + 1)]
        new = []
        for k in range(n):
            for j in range(k + 1):
                new.append((row[k] + j, row[k + 1] + j, row[k + 1] + j + 1))
                if j < k:
                    new.append((row[k] + j, row[k + 1] + j + 1, row[k] + j + 1))
        faces.extend(new if s.prod() > 0 else [f[::-1] for f in new])

    # the pieces share their border points
    _, keep, index = np.unique(np.round(np.array(points), 9), axis=0, return_index=True, return_inverse=True)
    return np.array(points)[keep], [[int(index[v]) for v in f] for f in faces], np.array(normals)[keep]


def monkey(levels, n):
    """Suzanne, her Subdivision modifier applied, and on the forehead a three-sided hole: its lowest corner on the line between the
    eyes, two sides of n edges along diagonals of the quads, the third of 2 n edges above. Returns vertices, faces, vertex normals
    from before the cut, and the rim."""
    bpy.ops.mesh.primitive_monkey_add()
    suzanne = bpy.context.object
    modifier = suzanne.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = levels
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    bm = bmesh.new()
    bm.from_mesh(suzanne.data)
    bpy.data.objects.remove(suzanne)
    bm.normal_update()
    normals = {v: v.normal.copy() for v in bm.verts}

    def walk(v, direction, steps):
        """The vertices met going straight on over vertices of four edges, off in the direction."""
        edge = max(v.link_edges, key=lambda e: (e.other_vert(v).co - v.co).normalized().dot(direction))
        line = [v]
        for _ in range(steps):
            v = edge.other_vert(v)
            line.append(v)
            edge = next((e for e in v.link_edges if not set(e.link_faces) & set(edge.link_faces)), None)
        return line

    top = min(bm.verts, key=lambda v: (v.co - Vector((0, -0.289, 0.898))).length)  # between two vertices of the coarse Suzanne
    down, up = Vector((0, -0.6, -0.8)), Vector((0, 0.6, 0.8))
    middle = walk(walk(top, down, 2**levels - 1)[-1], up, n)
    right, left = ([walk(v, Vector((x, 0, 0)), n) for v in middle] for x in (1, -1))
    for half in (right, left):
        for k in range(n):
            face = bm.faces.get([half[k][k], half[k][k + 1], half[k + 1][k + 1], half[k + 1][k]])
            bmesh.utils.face_split(face, half[k][k], half[k + 1][k + 1])
    inside = {half[k][j] for half in (right, left) for k in range(n + 1) for j in range(k + 1)}
    rim = {half[k][j] for half in (right, left) for k in range(n + 1) for j in range(k + 1) if j == k or k == n}
    bmesh.ops.delete(bm, geom=[f for f in bm.faces if set(f.verts) <= inside], context="FACES_ONLY")
    bmesh.ops.delete(bm, geom=[v for v in inside - rim], context="VERTS")
    bm.verts.index_update()
    result = (
        np.array([v.co for v in bm.verts]),
        [[v.index for v in f.verts] for f in bm.faces],
        np.array([normals[v] for v in bm.verts]),
        sorted(v.index for v in rim),
    )
    bm.free()
    return result


def make_object(name, vertices, faces, normals):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices], [], [tuple(f) for f in faces])
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.use_auto_smooth = True  # what makes Blender before 4.1 use the normals that a mesh brings
    mesh.normals_split_custom_set_from_vertices([tuple(n) for n in normals])
    mesh.validate()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


# ---------------------------------------------------------------- filling


def fill(thing, rim=()):
    """Fills with the operator, as a user would: the rim selected, or nothing. The new faces get the material of index 1."""
    before = len(thing.data.polygons)
    bpy.context.view_layer.objects.active = thing
    for v in thing.data.vertices:
        v.select = v.index in set(rim)
    thing.data.edges.foreach_set("select", [False] * len(thing.data.edges))
    thing.data.polygons.foreach_set("select", [False] * before)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="VERT")
    print(f"{thing.name}: ", end="", flush=True)
    result = bpy.ops.mesh.fill_three_sided()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert result == {"FINISHED"}, result
    for face in thing.data.polygons[before:]:
        face.material_index = 1
    print(f"{thing.name}: {before} faces before, {len(thing.data.polygons) - before} new ones", flush=True)


# ---------------------------------------------------------------- the picture


def zebra(name, dark, light):
    """Stripes of the reflected direction: they break where the normal jumps and bend where its change does."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, link = material.node_tree.nodes, material.node_tree.links.new
    shader = nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.45
    reflected = nodes.new("ShaderNodeTexCoord").outputs["Reflection"]
    along = nodes.new("ShaderNodeVectorMath")
    along.operation = "DOT_PRODUCT"
    along.inputs[1].default_value = Vector((0.30, -0.25, 0.92)).normalized()
    link(reflected, along.inputs[0])
    wave = nodes.new("ShaderNodeMath")
    wave.operation = "MULTIPLY"
    wave.inputs[1].default_value = 15.0
    link(along.outputs["Value"], wave.inputs[0])
    sine = nodes.new("ShaderNodeMath")
    sine.operation = "SINE"
    link(wave.outputs[0], sine.inputs[0])
    stripes = nodes.new("ShaderNodeMapRange")
    stripes.interpolation_type = "SMOOTHSTEP"
    stripes.inputs["From Min"].default_value, stripes.inputs["From Max"].default_value = -0.15, 0.15
    link(sine.outputs[0], stripes.inputs["Value"])
    color = nodes.new("ShaderNodeMixRGB")
    color.inputs["Color1"].default_value, color.inputs["Color2"].default_value = (*dark, 1), (*light, 1)
    link(stripes.outputs["Result"], color.inputs["Fac"])
    # the inside, seen through an open hole, is plain
    side = nodes.new("ShaderNodeNewGeometry")
    outside = nodes.new("ShaderNodeMixRGB")
    outside.inputs["Color2"].default_value = (0.015, 0.016, 0.02, 1)
    link(side.outputs["Backfacing"], outside.inputs["Fac"])
    link(color.outputs["Color"], outside.inputs["Color1"])
    link(outside.outputs["Color"], shader.inputs["Base Color"])
    return material


def plain(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    glow, out = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    glow.inputs["Color"].default_value = (*color, 1)
    material.node_tree.links.new(glow.outputs[0], out.inputs["Surface"])
    return material


def label(text, x, z, size, color, align="CENTER"):
    curve = bpy.data.curves.new(text, "FONT")
    curve.body, curve.size, curve.align_x, curve.align_y = text, size, align, "CENTER"
    curve.materials.append(color)
    thing = bpy.data.objects.new(f"Label {text}", curve)
    thing.matrix_world = Matrix.Translation((x, 0, z)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    bpy.context.collection.objects.link(thing)


def sun(direction, strength, angle):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = strength, angle
    thing = bpy.data.objects.new("Sun", light)
    thing.rotation_euler = Vector(direction).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)


def place(thing, x, z, scale, turn):
    thing.matrix_world = Matrix.Translation((x, 0, z)) @ Matrix.Scale(scale, 4) @ turn


def render(path):
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 5.2
    eye = bpy.data.objects.new("Camera", camera)
    eye.matrix_world = Matrix.Translation((0, -10, 0)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    bpy.context.collection.objects.link(eye)
    scene.camera = eye
    world = scene.world or bpy.data.worlds.new("World")
    scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.45
    sun((0.6, 1.0, -1.1), 2.4, 0.0)
    sun((-1.2, 0.8, 0.3), 0.7, 0.0)
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 24, False
    scene.cycles.max_bounces = 2
    scene.render.film_transparent = False
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 1400, 1160
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.preferences.addon_install(filepath=ADDON_ZIP, overwrite=True)
    bpy.ops.preferences.addon_enable(module="tripatch_blender")
    materials = (zebra("Surroundings", (0.02, 0.05, 0.11), (0.86, 0.88, 0.90)), zebra("Fill", (0.50, 0.10, 0.01), (1.0, 0.80, 0.42)))
    corner_view = Matrix.Rotation(math.radians(28), 4, "X") @ Matrix.Rotation(math.radians(-135 + 8), 4, "Z")
    face_view = Matrix.Rotation(math.radians(14), 4, "X") @ Matrix.Rotation(math.radians(24), 4, "Z")
    box, face = rounded_box((2.0, 2.0, 2.0), 0.62, 12), monkey(levels=3, n=10)
    rows = (("CAD corner", box, (), corner_view, 0.60, 1.0), ("Suzanne", face[:3], face[3], face_view, 0.86, -1.15))
    for name, arrays, rim, view, scale, z in rows:
        for when, x in (("before", -1.3), ("after", 1.3)):
            thing = make_object(f"{name} {when}", *arrays)
            for material in materials:
                thing.data.materials.append(material)
            place(thing, x, z, scale, view)
            if when == "after":
                fill(thing, rim)
    ink = plain("Ink", (0.03, 0.03, 0.035))
    label("before", -1.3, 2.03, 0.17, ink)
    label("after", 1.3, 2.03, 0.17, ink)
    bpy.ops.wm.save_as_mainfile(filepath=BLEND)
    render(PICTURE)
    bpy.ops.wm.save_as_mainfile(filepath=BLEND)  # with the camera and the lights


main()
