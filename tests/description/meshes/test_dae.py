"""COLLADA: units, axes, nodes, materials, polygons; against numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes.files import MESH_UNREADABLE
from cartwheel.description.meshes import MeshError, load_mesh, mesh_notes
from cartwheel.description.model import Mesh

TRIANGLE = '<triangles material="paint" count="1">{inputs}<p>0 1 2</p></triangles>'
VERTEX = '<input semantic="VERTEX" source="#v" offset="0"/>'


def document(
    *,
    unit="1",
    up="Z_UP",
    nodes='<node id="n"><instance_geometry url="#g"/></node>',
    positions="0 0 0 1 0 0 0 1 0",
    surface=None,
    sources="",
    effects="",
    more="",
) -> str:
    surface = surface or TRIANGLE.format(inputs=VERTEX)
    count = len(positions.split())
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="u" meter="{unit}"/><up_axis>{up}</up_axis></asset>
  {effects}
  <library_geometries><geometry id="g" name="part"><mesh>
    <source id="p"><float_array id="pa" count="{count}">{positions}</float_array>
      <technique_common><accessor source="#pa" count="{count // 3}" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    {sources}
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    {surface}
  </mesh></geometry></library_geometries>
  {more}
  <library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"""


def effect(name: str, inside: str, parameters: str = "") -> str:
    return (
        f'<effect id="{name}-fx"><profile_COMMON>{parameters}<technique sid="common"><phong>'
        f"{inside}</phong></technique></profile_COMMON></effect>"
    )


def materials(*effects: tuple[str, str]) -> str:
    library = "".join(
        f'<material id="{n}"><instance_effect url="#{n}-fx"/></material>' for n, _ in effects
    )
    looks = "".join(effect(n, inside) for n, inside in effects)
    return (
        f"<library_effects>{looks}</library_effects>"
        f"<library_materials>{library}</library_materials>"
    )


def bound(**targets: str) -> str:
    inside = "".join(f'<instance_material symbol="{s}" target="#{t}"/>' for s, t in targets.items())
    return (
        '<node id="n"><instance_geometry url="#g"><bind_material><technique_common>'
        f"{inside}</technique_common></bind_material></instance_geometry></node>"
    )


def load(folder, text, **mesh):
    path = folder / "t.dae"
    path.write_text(text)
    return load_mesh(Mesh(uri="t.dae", path=path, **mesh))


def points(part) -> list[tuple[float, ...]]:
    return sorted(tuple(round(c, 6) + 0.0 for c in v) for v in part.vertices.tolist())


def test_unit_is_applied_and_up_axis_is_not(tmp_path):
    (part,) = load(tmp_path, document(unit="0.01", up="Y_UP", positions="0 0 0 100 0 0 0 50 0"))
    assert points(part) == [(0, 0, 0), (0, 0.5, 0), (1, 0, 0)]
    assert (part.name, part.geometry) == ("n", "part")


def test_an_accessor_that_counts_numbers_instead_of_points_is_read(tmp_path):
    text = document(surface=TRIANGLE.format(inputs=VERTEX))
    right = '<accessor source="#pa" count="3"'
    assert right in text
    (part,) = load(tmp_path, text.replace(right, right.replace("3", "9")))
    assert points(part) == [(0, 0, 0), (0, 1, 0), (1, 0, 0)]


def test_a_name_may_hold_what_xml_forbids(tmp_path):
    nodes = '<node id="<STL>" name=\'<STL "a">\'><instance_geometry url="#g"/></node>'
    (part,) = load(tmp_path, document(nodes=nodes))
    assert part.name == '<STL "a">'
    with raises(MESH_UNREADABLE):
        load(tmp_path, document(nodes=nodes.replace("url=", "<url=")))


def test_nodes_place_their_geometry(tmp_path):
    # Outer: 90 degrees about z, then 10 along the turned x, which is y. Inner: twice as large.
    nodes = """<node id="outer"><rotate>0 0 1 90</rotate><translate>10 0 0</translate>
      <node id="inner"><scale>2 2 2</scale><instance_geometry url="#g"/></node></node>"""
    (part,) = load(tmp_path, document(nodes=nodes))
    # (1,0,0) -> (2,0,0) -> (12,0,0) -> (0,12,0); (0,1,0) -> (0,2,0) -> (10,2,0) -> (-2,10,0)
    assert points(part) == [(-2, 10, 0), (0, 10, 0), (0, 12, 0)]


def test_translations_are_in_the_file_s_unit(tmp_path):
    nodes = '<node><translate>100 0 0</translate><instance_geometry url="#g"/></node>'
    (part,) = load(tmp_path, document(unit="0.01", nodes=nodes))
    assert part.vertices.min(axis=0)[0] == pytest.approx(1.0)


def test_matrix_and_instance_node(tmp_path):
    nodes = """<node><matrix>1 0 0 1  0 1 0 2  0 0 1 3  0 0 0 1</matrix>
      <instance_node url="#shared"/></node>"""
    more = """<library_nodes><node id="shared"><matrix>0 -1 0 0  1 0 0 0  0 0 1 0  0 0 0 1</matrix>
      <instance_geometry url="#g"/></node></library_nodes>"""
    (part,) = load(tmp_path, document(nodes=nodes, more=more))
    assert points(part) == [(0, 2, 3), (1, 2, 3), (1, 3, 3)]


def test_a_mirroring_node_turns_the_faces(tmp_path):
    nodes = '<node><scale>-1 1 1</scale><instance_geometry url="#g"/></node>'
    (part,) = load(tmp_path, document(nodes=nodes))
    a, b, c = part.vertices[part.faces[0]].astype(float)
    assert np.cross(b - a, c - a)[2] == pytest.approx(1.0)


def test_two_materials_make_two_submeshes(tmp_path):
    effects = materials(
        ("red", "<diffuse><color>1 0 0 1</color></diffuse>"),
        (
            "glass",
            "<diffuse><color>0 0 1 1</color></diffuse><transparent><color>1 1 1 1</color>"
            "</transparent><transparency><float>0.25</float></transparency>",
        ),
    )
    surface = (
        f'<triangles material="a" count="1">{VERTEX}<p>0 1 2</p></triangles>'
        f'<triangles material="b" count="1">{VERTEX}<p>0 2 1</p></triangles>'
    )
    parts = load(
        tmp_path, document(effects=effects, surface=surface, nodes=bound(a="red", b="glass"))
    )
    assert [part.rgba for part in parts] == [(1, 0, 0, 1), (0, 0, 1, 0.25)]


@pytest.mark.parametrize(
    ("transparency", "alpha"),
    [
        ("", 1.0),
        ('<transparent opaque="RGB_ZERO"><color>0 0 0 1</color></transparent>', 1.0),
        ('<transparent opaque="RGB_ZERO"><color>0.5 0.5 0.5 1</color></transparent>', 0.5),
        ('<transparent opaque="A_ONE"><color>1 1 1 0.3</color></transparent>', 0.3),
        # SketchUp's way to say opaque, which COLLADA's rule would hide.
        (
            '<transparent opaque="A_ONE"><color>1 1 1 1</color></transparent>'
            "<transparency><float>0</float></transparency>",
            1.0,
        ),
    ],
)
def test_transparency(tmp_path, transparency, alpha):
    effects = materials(("red", f"<diffuse><color>1 0 0 1</color></diffuse>{transparency}"))
    (part,) = load(tmp_path, document(effects=effects, nodes=bound(paint="red")))
    assert part.rgba == pytest.approx((1, 0, 0, alpha), abs=1e-5)


UV_SOURCE = """<source id="t"><float_array id="ta" count="6">0 0 1 0 0 1</float_array>
  <technique_common><accessor source="#ta" count="3" stride="2"/></technique_common></source>"""
TEXTURED = TRIANGLE.format(
    inputs=VERTEX + '<input semantic="TEXCOORD" source="#t" offset="0" set="0"/>'
)


def textured_document() -> str:
    parameters = (
        '<newparam sid="surf"><surface type="2D"><init_from>img</init_from></surface></newparam>'
        '<newparam sid="samp"><sampler2D><source>surf</source></sampler2D></newparam>'
    )
    look = effect("wood", '<diffuse><texture texture="samp" texcoord="UV"/></diffuse>', parameters)
    effects = (
        '<library_images><image id="img"><init_from>C:\\work\\my%20wood.png</init_from></image>'
        f"</library_images><library_effects>{look}</library_effects><library_materials>"
        '<material id="wood"><instance_effect url="#wood-fx"/></material></library_materials>'
    )
    return document(effects=effects, sources=UV_SOURCE, surface=TEXTURED, nodes=bound(paint="wood"))


def test_texture_is_found_beside_the_mesh(tmp_path):
    (tmp_path / "my wood.png").write_bytes(b"png")
    (part,) = load(tmp_path, textured_document())
    assert part.texture == tmp_path / "my wood.png"
    assert part.rgba == (1, 1, 1, 1)
    assert part.uv is not None
    assert part.uv.tolist() == part.vertices[:, :2].tolist()


def test_a_missing_texture_is_reported(tmp_path):
    (part,) = load(tmp_path, textured_document())
    assert part.texture is None
    notes = mesh_notes(Mesh(uri="", path=tmp_path / "t.dae"))
    assert len(notes) == 1
    assert "wood.png" in notes[0]


def test_normals_with_their_own_index_turn_with_the_node(tmp_path):
    normals = """<source id="nrm"><float_array id="na" count="6">0 0 1 1 0 0</float_array>
      <technique_common><accessor source="#na" count="2" stride="3"/></technique_common></source>"""
    surface = (
        f'<triangles count="2">{VERTEX}<input semantic="NORMAL" source="#nrm" offset="1"/>'
        "<p>0 0 1 0 2 0  0 1 1 1 2 1</p></triangles>"
    )
    nodes = '<node><rotate>0 0 1 90</rotate><instance_geometry url="#g"/></node>'
    (part,) = load(tmp_path, document(sources=normals, surface=surface, nodes=nodes))
    assert len(part.vertices) == 6
    assert part.normals is not None
    first = {tuple(np.round(part.normals[i], 6) + 0.0) for i in part.faces[0]}
    second = {tuple(np.round(part.normals[i], 6) + 0.0) for i in part.faces[1]}
    assert (first, second) == ({(0, 0, 1)}, {(0, 1, 0)})


SQUARE = "0 0 0 2 0 0 2 2 0 0 2 0 1 3 0"


@pytest.mark.parametrize(
    ("surface", "area"),
    [
        (f'<polylist count="1">{VERTEX}<vcount>4</vcount><p>0 1 2 3</p></polylist>', 4),
        (f'<polylist count="2">{VERTEX}<vcount>4 3</vcount><p>0 1 2 3 3 2 4</p></polylist>', 5),
        (f'<polygons count="2">{VERTEX}<p>0 1 2 3</p><p>3 2 4</p></polygons>', 5),
        (f'<tristrips count="1">{VERTEX}<p>0 1 3 2</p></tristrips>', 4),
        (f'<trifans count="1">{VERTEX}<p>0 1 2 3</p></trifans>', 4),
        (f'<polygons count="1">{VERTEX}<p>0 1 2 4 3</p></polygons>', 5),
    ],
)
def test_kinds_of_polygons(tmp_path, surface, area):
    (part,) = load(tmp_path, document(positions=SQUARE, surface=surface))
    a, b, c = (part.vertices[part.faces[:, i]].astype(float) for i in range(3))
    crosses = np.cross(b - a, c - a)[:, 2] / 2
    assert (crosses > 0).all(), "all turned the same way"
    assert crosses.sum() == pytest.approx(area)


def test_lines_are_reported_and_skinned_meshes_shown(tmp_path):
    surface = TRIANGLE.format(inputs=VERTEX) + f'<lines count="1">{VERTEX}<p>0 1</p></lines>'
    more = """<library_controllers><controller id="c"><skin source="#g">
      <bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 7 0 0 0 1</bind_shape_matrix></skin></controller>
      </library_controllers>"""
    nodes = '<node><instance_controller url="#c"/></node>'
    (part,) = load(tmp_path, document(surface=surface, more=more, nodes=nodes))
    assert part.vertices[:, 2].tolist() == [7, 7, 7]
    assert mesh_notes(Mesh(uri="", path=tmp_path / "t.dae")) == (
        "the COLLADA elements <lines> are ignored",
    )


UNUSABLE = [
    ("<COLLADA><asset>", "malformed XML"),
    ("<svg/>", "is not a COLLADA file"),
    ("<COLLADA/>", "no triangles"),
    ('<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>', "entities"),
    (document(unit="0"), "unit"),
    (document(unit="x"), "could not convert"),
    (document(positions="0 0 0 1 0 0 0 nan 0"), "not finite"),
    (document(positions="0 0 0 1 0 0"), "the index 2"),
    (document(nodes='<node><instance_geometry url="#none"/></node>'), '"#none"'),
    (document(nodes='<node id="a"><instance_node url="#a"/></node>'), "in a cycle"),
    (
        document(nodes='<node><scale>0 1 1</scale><instance_geometry url="#g"/></node>'),
        "to zero size",
    ),
    (document(nodes="<node><matrix>1 2 3</matrix></node>"), "16 finite numbers"),
    (document(surface="<triangles><p>0 1 2</p></triangles>"), "VERTEX"),
    (document(surface=f"<polylist>{VERTEX}<vcount>9</vcount><p>0 1 2</p></polylist>"), "9"),
]
"""Files, and why each is refused."""


@pytest.mark.parametrize("text", [case[0] for case in UNUSABLE])
def test_unusable_files(tmp_path, text):
    with raises(MESH_UNREADABLE):
        load(tmp_path, text)


@pytest.mark.wording
@pytest.mark.parametrize(("text", "reason"), UNUSABLE)
def test_unusable_files_say_why(tmp_path, text, reason):
    with pytest.raises(MeshError, match=reason):
        load(tmp_path, text)
