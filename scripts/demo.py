"""Run by scripts/demo in Debian's Blender: fills two real holes with the installed add-on, prints the reports, and saves a .blend
and a before/after picture.

    blender --background --factory-startup --python scripts/demo.py -- ADDON.zip OUT.blend OUT.png
"""

import math
import sys

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector

ADDON_ZIP, BLEND, PICTURE = sys.argv[sys.argv.index("--") + 1 :]
RESOLUTION, SAMPLES = (1400, 1160), 48


# ---------------------------------------------------------------- the two meshes


def rounded_box(size, radius, n, along=6):
    """Vertices, faces and exact vertex normals of a box of unit directions x, y, z whose edges are rounded with n faces a quarter
    turn, the corner at (+, +, +) missing. A point of it is a point of a smaller box, the core, plus `radius` times the normal."""
    core = np.asarray(size) / 2 - radius
    points, normals, faces = [], [], []

    def add(on_core, normal, quads):
        """Points (k, 3) of the core with normals (k, 3); faces by index into them, turned outward here."""
        first, new = sum(map(len, points)), on_core + radius * normal
        points.append(new)
        normals.append(normal)
        for face in quads:
            around = np.cross(new[face[1]] - new[face[0]], new[face[2]] - new[face[0]])
            faces.append([first + v for v in (face if around @ normal[face[0]] > 0 else face[::-1])])

    def grid(nu, nv):
        """Two parameters from 0 to 1 at (nu + 1) (nv + 1) points, and their quads."""
        u, v = np.meshgrid(np.linspace(0, 1, nu + 1), np.linspace(0, 1, nv + 1), indexing="ij")
        at = np.arange(u.size).reshape(u.shape)
        return u.ravel(), v.ravel(), np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], -1).reshape(-1, 4).tolist()

    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        for side in (-1, 1):  # the flat faces across axis a
            u, v, quads = grid(along, along)
            on_core, normal = np.zeros((2, u.size, 3))
            on_core[:, a], on_core[:, b], on_core[:, c] = side * core[a], (2 * u - 1) * core[b], (2 * v - 1) * core[c]
            normal[:, a] = side
            add(on_core, normal, quads)
        for sb, sc in ((1, 1), (1, -1), (-1, 1), (-1, -1)):  # the rounded edges along axis a
            u, v, quads = grid(n, along)
            on_core, normal = np.zeros((2, u.size, 3))
            on_core[:, a], on_core[:, b], on_core[:, c] = (2 * v - 1) * core[a], sb * core[b], sc * core[c]
            normal[:, b], normal[:, c] = sb * np.cos(u * math.pi / 2), sc * np.sin(u * math.pi / 2)
            add(on_core, normal, quads)
    k, j = np.array([(k, j) for k in range(n + 1) for j in range(k + 1)]).T  # an octant of a sphere: k + 1 points in row k
    polar, turn = k / n * math.pi / 2, j / np.maximum(k, 1) * math.pi / 2
    octant = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], -1)
    at = {(k, j): i for i, (k, j) in enumerate(zip(k.tolist(), j.tolist()))}
    triangles = [[at[k, j], at[k + 1, j], at[k + 1, j + 1]] for k in range(n) for j in range(k + 1)]
    triangles += [[at[k, j], at[k + 1, j + 1], at[k, j + 1]] for k in range(n) for j in range(k)]
    for signs in [s for s in np.ndindex(2, 2, 2) if any(s)]:
        add(np.where(signs, -core, core), np.where(signs, -octant, octant), triangles)

    # the pieces share their border points
    points, normals = np.concatenate(points), np.concatenate(normals)
    _, keep, index = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    return points[keep], [[int(index[v]) for v in f] for f in faces], normals[keep]


def monkey(levels, n):
    """Suzanne, her Subdivision modifier applied, and on the forehead a three-sided hole: its lowest corner between the eyes, two
    sides of n edges along diagonals of the quads, the third of 2 n edges above. Returns vertices, faces, vertex normals from
    before the cut, and the rim."""
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
    bmesh.ops.delete(bm, geom=list(inside - rim), context="VERTS")
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
    if hasattr(mesh, "use_auto_smooth"):
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
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="VERT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bm, selected = bmesh.from_edit_mesh(thing.data), set(rim)
    for v in bm.verts:
        v.select = v.index in selected
    bm.select_flush_mode()
    print(f"{thing.name}: ", end="", flush=True)
    result = bpy.ops.mesh.fill_three_sided()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert result == {"FINISHED"}, result
    for face in thing.data.polygons[before:]:
        face.material_index = 1
    print(f"{thing.name}: {before} faces before, {len(thing.data.polygons) - before} new ones", flush=True)


# ---------------------------------------------------------------- the picture


def zebra(name, dark, light, along, count):
    """Stripes of the reflected direction, `count` over the sphere of directions: they break where the normal jumps, and bend
    where the curvature does."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, link = material.node_tree.nodes, material.node_tree.links.new

    def math_node(operation, value, other=0.0):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        link(value, node.inputs[0])
        node.inputs[1].default_value = other
        return node.outputs["Value"]

    def mix(factor, color1, color2):
        node = nodes.new("ShaderNodeMixRGB")
        link(factor, node.inputs["Fac"])
        for socket, color in (("Color1", color1), ("Color2", color2)):
            if isinstance(color, tuple):
                node.inputs[socket].default_value = (*color, 1)
            else:
                link(color, node.inputs[socket])
        return node.outputs["Color"]

    dot = nodes.new("ShaderNodeVectorMath")
    dot.operation = "DOT_PRODUCT"
    dot.inputs[1].default_value = Vector(along).normalized()
    link(nodes.new("ShaderNodeTexCoord").outputs["Reflection"], dot.inputs[0])
    wave = math_node("SINE", math_node("MULTIPLY", dot.outputs["Value"], count * math.pi))
    edge = nodes.new("ShaderNodeMapRange")
    edge.interpolation_type = "SMOOTHSTEP"
    edge.inputs["From Min"].default_value, edge.inputs["From Max"].default_value = -0.15, 0.15
    link(wave, edge.inputs["Value"])
    stripes = mix(edge.outputs["Result"], dark, light)
    inside = nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"]  # seen through the open hole: plain
    shader = nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.4
    link(mix(inside, stripes, (0.01, 0.01, 0.012)), shader.inputs["Base Color"])
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


def label(text, x, z, size, color):
    curve = bpy.data.curves.new(text, "FONT")
    curve.body, curve.size, curve.align_x, curve.align_y = text, size, "CENTER", "CENTER"
    curve.materials.append(color)
    thing = bpy.data.objects.new(f"Label {text}", curve)
    thing.matrix_world = Matrix.Translation((x, -3, z)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    bpy.context.collection.objects.link(thing)


def sun(direction, strength):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = strength, 0
    thing = bpy.data.objects.new("Sun", light)
    thing.rotation_euler = Vector(direction).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)


def render(path):
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 5.2
    eye = bpy.data.objects.new("Camera", camera)
    eye.matrix_world = Matrix.Translation((0, -10, 0)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    bpy.context.collection.objects.link(eye)
    scene.camera = eye
    # the camera sees white; the things are lit by less
    scene.world = scene.world or bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    nodes, link = scene.world.node_tree.nodes, scene.world.node_tree.links.new
    strength = nodes.new("ShaderNodeMapRange")
    strength.inputs["To Min"].default_value = 0.45
    link(nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], strength.inputs["Value"])
    nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    link(strength.outputs["Result"], nodes["Background"].inputs["Strength"])
    sun((0.6, 1.0, -1.1), 2.3)
    sun((-1.2, 0.8, 0.3), 0.6)
    scene.render.engine = "CYCLES"
    scene.cycles.use_denoising = False  # Debian's Blender is built without it
    scene.cycles.device, scene.cycles.samples, scene.cycles.max_bounces = "CPU", SAMPLES, 1
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = RESOLUTION
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.preferences.addon_install(filepath=ADDON_ZIP, overwrite=True)
    bpy.ops.preferences.addon_enable(module="tripatch_blender")

    blue, orange = ((0.02, 0.05, 0.11), (0.86, 0.88, 0.90)), ((0.50, 0.10, 0.01), (1.0, 0.80, 0.42))
    rows = (
        # name, mesh and rim, stripes, view, size, height in the picture
        (
            "CAD corner",
            (*rounded_box((2.0, 2.0, 2.0), 0.62, 12), ()),
            ((0.30, -0.25, 0.92), 7),
            Matrix.Rotation(math.radians(30), 4, "X") @ Matrix.Rotation(math.radians(-135 + 8), 4, "Z"),
            0.68,
            0.90,
        ),
        (
            "Suzanne",
            monkey(levels=3, n=10),
            ((0.85, -0.2, 0.45), 9),
            Matrix.Rotation(math.radians(30), 4, "X") @ Matrix.Rotation(math.radians(18), 4, "Z"),
            0.88,
            -1.12,
        ),
    )
    for name, (vertices, faces, normals, rim), (along, count), view, scale, z in rows:
        materials = [
            zebra(f"{name} {part}", *colors, along, count) for part, colors in (("surroundings", blue), ("fill", orange))
        ]
        for when, x in (("before", -1.3), ("after", 1.3)):
            thing = make_object(f"{name} {when}", vertices, faces, normals)
            for material in materials:
                thing.data.materials.append(material)
            thing.matrix_world = Matrix.Translation((x, 0, z)) @ Matrix.Scale(scale, 4) @ view
            if when == "after":
                fill(thing, rim)
    ink = plain("Ink", (0.03, 0.03, 0.035))
    label("before", -1.3, 2.0, 0.17, ink)
    label("after", 1.3, 2.0, 0.17, ink)
    render(PICTURE)
    bpy.ops.wm.save_as_mainfile(filepath=BLEND)


main()
