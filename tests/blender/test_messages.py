"""What the add-on says comes from the table of messages: in a language without ASCII letters nothing else is left of it."""

import re
from dataclasses import replace

import bpy
import pytest
import scenes

WIDE = str.maketrans({chr(c): chr(c + 0xFEE0) for c in (*range(0x41, 0x5B), *range(0x61, 0x7B))})


def pseudo(pattern):
    """A pattern in that language: fields keep their names and kinds, but for the words of plurals."""

    def field(match):
        kind = match[2] or ""
        return f"{{{match[1]}{kind.translate(WIDE) if '|' in kind else kind}}}"

    parts = re.split(r"(\{\w+(?::[^}]*)?\})", pattern)
    return "".join(re.sub(r"\{(\w+)(:[^}]*)?\}", field, each) if each[:1] == "{" else each.translate(WIDE) for each in parts)


@pytest.fixture
def in_pseudo_language(monkeypatch):
    import tripatch

    table = tripatch.messages.TABLE
    made = {code: replace(row, sentence=pseudo(row.sentence), panel=pseudo(row.panel)) for code, row in table.items()}
    monkeypatch.setattr(tripatch.messages, "TABLE", made)


def closed():
    bpy.ops.mesh.primitive_cube_add()
    scenes.edit(bpy.context.object)


def part_of_a_border():
    (bm,) = scenes.edit(scenes.add_hole(), mode="EDGE")
    scenes.select(bm, edges=[next(e for e in bm.edges if e.is_boundary and max(abs(c) for c in e.verts[0].co) < 3)])


def inner_edge():
    (bm,) = scenes.edit(scenes.add_hole(), mode="EDGE")
    scenes.select(bm, edges=[next(e for e in bm.edges if not any(v.is_boundary for v in e.verts))])


def inner_vertex():
    (bm,) = scenes.edit(scenes.add_hole())
    scenes.select(bm, vertices=[next(v for v in bm.verts if not v.is_boundary)])


def faces_at_the_border():
    (bm,) = scenes.edit(scenes.add_hole(), mode="FACE")
    scenes.select(bm, faces=[next(f for f in bm.faces if any(e.is_boundary for e in f.edges))])


def without_scale():
    ob = scenes.add_hole()
    ob.scale = (1, 1, 0)
    bpy.context.view_layer.update()
    scenes.edit(ob)


def whole():
    scenes.edit(scenes.add_hole())


CASES = [closed, part_of_a_border, inner_edge, inner_vertex, faces_at_the_border, without_scale, whole]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__)
def test_nothing_is_glued_to_what_an_operator_reports(in_pseudo_language, capfd, case):
    case()
    names = [ob.name for ob in bpy.context.objects_in_mode]
    capfd.readouterr()
    try:
        bpy.ops.mesh.fill_smooth()
        said = capfd.readouterr().out
    except RuntimeError as error:
        said = str(error)
    said = re.sub(r"Error: |Info: |Warning: |Outer Borders|vert(ex|ices)|and more|and", "", said)
    for name in names:
        said = said.replace(name, "")
    assert re.search("[\uff21-\uff3a\uff41-\uff5a]", said), "something is said"
    assert not re.search("[A-Za-z]", said), said


def test_refusals_of_a_selection_have_codes(addon):
    selection = __import__(addon.__name__ + ".selection", fromlist=["selection"])
    (bm,) = scenes.edit(scenes.add_hole())
    for vertices, code in (
        ([], "nothing_selected"),
        ([next(v for v in bm.verts if not v.is_boundary)], "vertices_not_on_border"),
    ):
        scenes.select(bm, vertices=vertices)
        with pytest.raises(selection.UnusableError) as caught:
            selection.selected_rims(bm, selection.Selected(bm))
        assert caught.value.code == code and str(caught.value) == str(caught.value.said)
