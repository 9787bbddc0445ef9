"""Malformed XML, invalid numbers and unread elements are reported."""

import pytest
from tests.coded import named, placed, raises

from cartwheel.codes import files, tags
from cartwheel.description.elements import numbers, xml
from cartwheel.description.elements.unread import unread
from cartwheel.description.model import Element
from cartwheel.errors import DescriptionError, Origin
from cartwheel.geometry import Pose

HERE = Origin(file="robot.urdf", line=12)


def test_elements_know_the_line_of_their_first_character():
    root = xml.parse('<robot\n  name="a">\n  <link\n    name="b"/>\n</robot>', "robot.urdf")
    assert root.origin == Origin(file="robot.urdf", line=1)
    assert root.children[0].origin == Origin(file="robot.urdf", line=3)


def test_text_is_joined_and_stripped_and_prefixes_are_kept():
    root = xml.parse("<a> x<!-- c --> <![CDATA[<y>]]> <sensor:camera/></a>")
    assert root.text == "x <y>"
    assert root.children[0].tag == "sensor:camera"


@pytest.mark.parametrize("encode", [str, str.encode])
def test_blank_lines_may_stand_before_the_declaration(encode):
    root = xml.parse(encode("\n \n<?xml version='1.0'\n?>\n<a>\n<b/></a>"), "robot.urdf")
    assert root.children[0].origin == Origin(file="robot.urdf", line=6)


@pytest.mark.parametrize("encode", [str, str.encode])
def test_comments_may_hold_dashes(encode):
    text = (
        "<!-- gz topic\n --pub --->\n<a><![CDATA[<!-- -- -->]]><!-----><b/><!-- -\n- -->\n<c/></a>"
    )
    root = xml.parse(encode(text), "robot.urdf")
    assert root.text == "<!-- -- -->"
    assert [(each.tag, each.origin.line) for each in root.children] == [("b", 3), ("c", 5)]


@pytest.mark.parametrize(
    ("text", "line", "code"),
    [
        ("<a>\n<b>\n</a>", 3, "xml-malformed"),
        ("<a>\n<b>", 2, "xml-malformed"),
        ("<a>\n&nbsp;</a>", 2, "xml-malformed"),
        ('<a>\n<b c="<"/></a>', 2, "xml-malformed"),
        ('<a>\n<b c="1" c="2"/></a>', 2, "xml-malformed"),
        ("<a>\n<?xml version='1.0'?></a>", 2, "xml-malformed"),
        ("<a/>\n<b/>", 2, "xml-malformed"),
        ("hello", 1, "xml-malformed"),
        ("", 1, "xml-malformed"),
        ('<!DOCTYPE a [\n<!ENTITY x "y">]><a>&x;</a>', 2, "xml-entity"),
        (b'<?xml version="1.0" encoding="none"?><a/>', 1, "xml-malformed"),
        (b"<a>\n\xff</a>", 2, "xml-malformed"),
        ("<a>\ud800</a>", 1, "xml-malformed"),
        ("<a>\n" * 500, 101, "xml-malformed"),
    ],
)
def test_malformed_text_names_its_place(text, line, code):
    with pytest.raises(DescriptionError) as caught:
        xml.parse(text, "robot.urdf")
    assert caught.value.origin == Origin(file="robot.urdf", line=line)
    assert named(caught.value) == code


def test_external_entities_are_not_fetched(tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("secret")
    text = f'<!DOCTYPE a [<!ENTITY x SYSTEM "{secret.as_uri()}">]><a>&x;</a>'
    with pytest.raises(DescriptionError) as caught:
        xml.parse(text)
    assert named(caught.value) == "xml-entity"


@pytest.mark.parametrize("text", ["1", "-1.5", ".5", "1.", "1e-3", "+2E+2", " 3 "])
def test_numbers(text):
    assert numbers.number(text, "mass", HERE) == float(text)


@pytest.mark.wording
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("abc", 'robot.urdf:12: mass "abc" is not a number'),
        ("1_000", 'robot.urdf:12: mass "1_000" is not a number'),
        ("nan", 'robot.urdf:12: mass "nan" is not a finite number'),
        ("inf", 'robot.urdf:12: mass "inf" is not a finite number'),
        ("1e999", 'robot.urdf:12: mass "1e999" is too large'),
        ("", "robot.urdf:12: mass is empty, but must be a number"),
        (
            "0,5",
            'robot.urdf:12: mass "0,5" is not a number\n  Use a decimal point: "0.5".',
        ),
        ("١", 'robot.urdf:12: mass "١" is not a number'),
    ],
)
def test_what_is_no_number(text, message):
    with pytest.raises(DescriptionError) as caught:
        numbers.number(text, "mass", HERE)
    assert str(caught.value) == message


@pytest.mark.wording
def test_expression_outside_of_xacro_says_what_is_missing():
    with pytest.raises(DescriptionError, match="xmlns:xacro"):
        numbers.number("${width}", "mass", HERE)


def test_infinity_where_it_has_a_meaning():
    assert numbers.number("-inf", "lower", HERE, infinite=True) == float("-inf")


def test_vectors_count_their_numbers():
    assert numbers.vector(" 1\n2\t3 ", 3, "xyz", HERE) == (1, 2, 3)
    for text in ("1 2", "1, 2, 3"):
        with pytest.raises(DescriptionError) as caught:
            numbers.vector(text, 3, "xyz", HERE)
        assert named(caught.value) == "value-invalid"
        assert caught.value.values == {"name": "xyz", "stated": text}


@pytest.mark.parametrize(("text", "value"), [("true", 1), ("1", 1), ("False", 0), ("0", 0)])
def test_truth_values(text, value):
    assert numbers.boolean(text, "static", HERE) is bool(value)


def test_what_is_no_truth_value():
    with pytest.raises(DescriptionError) as caught:
        numbers.boolean("maybe", "static", HERE)
    assert named(caught.value) == "value-invalid"


@pytest.mark.parametrize(
    ("text", "size", "found"),
    [
        ("1", 1, ("1", "")),
        (" +.5e-3 ", 1, ("+.5e-3", "")),
        ("0.2*0.8", 1, ("0.2", "*0.8")),
        ("50deg", 1, ("50", "deg")),
        ("1,5", 1, ("1", ",5")),
        ("1.2.3", 1, ("1.2", ".3")),
        ("2x", 1, ("2", "x")),
        ("1 2 3 4", 3, ("1 2 3", "4")),
        ("1 2 3m", 3, ("1 2 3", "m")),
        ("1-2 3", 3, ("1 -2 3", "")),
        ("1m 2 3", 3, None),
        ("1 2", 3, None),
        ("2e", 1, None),
        ("2em", 1, None),
        ("0x10", 1, None),
        ("wide", 1, None),
        ("inf", 1, None),
        ("", 1, None),
    ],
)
def test_leading_numbers_as_c_plus_plus_streams_read_them(text, size, found):
    assert numbers.leading(text, size) == found


def test_text_after_a_number_in_an_element_is_a_warning():
    root = xml.parse("<a><w>10.5</w><d>2,5</d><v>1 2 3 4</v><h n='1m'/></a>")
    assert root.integer_at("w", 0) == 10
    assert root.number_at("d", 0) == 2
    assert root.vec3_at("v", (0, 0, 0)) == (1, 2, 3)
    warnings = [each for each in unread(root) if each.code is tags.TEXT_AFTER_NUMBER]
    assert [(each.values["tag"], each.values["used"]) for each in warnings] == [
        ("w", "10"), ("d", "2"), ("v", "1 2 3"),
    ]  # fmt: skip
    assert [each.values["stated"] for each in warnings] == ["10.5", "2,5", "1 2 3 4"]
    # urdfdom, which reads attributes, rejects such text.
    with pytest.raises(DescriptionError):
        root.require_child("h").number_of("n")


def test_attributes_and_descendants():
    root = xml.parse(
        '<a n="2" v="1 2 3" b="1"><c><d>4</d></c><pose>1 2 3 0 0 0</pose><t>true</t></a>'
    )
    assert root.number_of("n") == 2
    assert root.number_of("m", 7) == 7
    assert root.vec3_of("v") == (1, 2, 3)
    assert root.boolean_of("b") is True
    assert root.number_at("c/d", 0) == 4
    assert root.integer_at("c/d", 0) == 4
    assert root.optional_number_at("c/e") is None
    assert root.require_child("pose").pose() == Pose((1, 2, 3))
    assert root.boolean_at("t", False)
    assert root.text_at("x") == ""


def test_missing_attribute_names_the_likely_meant_one():
    root = xml.parse('<box sice="1 1 1"/>')
    with pytest.raises(DescriptionError) as caught:
        root.vec3_of("size")
    assert named(caught.value) == "tag-missing sice"


def test_missing_child_names_the_likely_meant_one():
    root = xml.parse('<link name="a"><inertail/></link>')
    with raises(tags.TAG_MISSING, missing="inertial", meant="inertail"):
        root.require_child("inertial")


def test_unread_parts_are_reported_with_place_and_likely_meaning():
    root = xml.parse(
        "<gazebo>\n<mu1>1</mu1>\n<maxContact>3</maxContact>\n<mu1>2</mu1>\n"
        "<kp valeu='1'/></gazebo>",
        "robot.urdf",
    )
    root.child("mu1")
    root.child("maxContacts")
    root.child("kp").get("value")
    assert [placed(each) for each in xml.unread(root)] == [
        "robot.urdf:3 warning tag-ignored maxContacts",
        "robot.urdf:4 warning tag-repeated",
        "robot.urdf:5 warning tag-ignored value",
    ]


def test_element_carries_the_whole_subtree_and_counts_as_read():
    root = xml.parse('<r><plugin name="p"><rate unit="Hz">5</rate></plugin></r>', "f")
    plugin = root.child("plugin")
    element = xml.to_element(plugin)
    here = Origin(file="f", line=1)
    assert element == Element(
        tag="plugin",
        attributes=(("name", "p"),),
        children=(Element(tag="rate", text="5", attributes=(("unit", "Hz"),), origin=here),),
        origin=here,
    )
    assert not list(xml.unread(root))


@pytest.mark.parametrize("content", [b"", b" \n", b"solid\0\1\2"])
def test_files_that_are_no_text(tmp_path, content):
    path = tmp_path / "robot.urdf"
    path.write_bytes(content)
    with pytest.raises(DescriptionError) as caught:
        xml.read_file(path)
    assert named(caught.value) == "file-unreadable"


def test_a_file_that_is_not_there(tmp_path):
    (tmp_path / "robot.urdf").write_text("<robot/>")
    with pytest.raises(DescriptionError) as caught:
        xml.read_file(tmp_path / "robt.urdf")
    assert named(caught.value) == "file-missing robot.urdf"
    with pytest.raises(DescriptionError) as caught:
        xml.read_file(tmp_path)
    assert named(caught.value) == "file-unreadable"


def test_utf16_and_latin1_are_decoded_as_declared():
    assert xml.parse('<?xml version="1.0" encoding="UTF-16"?><a>ü</a>'.encode("utf-16")).text == "ü"
    latin = '<?xml version="1.0" encoding="ISO-8859-1"?><a>ü</a>'.encode("latin-1")
    assert xml.parse(latin).text == "ü"


def test_a_declaration_after_a_comment_is_read_as_gazebo_reads_it():
    text = "<!-- Made by hand.\n-->\n<?xml version='1.0'?>\n<a>\n<b/></a>"
    for given in (text, text.encode()):
        root = xml.parse(given, "w.world")
        assert (root.tag, root.origin.line, root.children[0].origin.line) == ("a", 4, 5)


LATIN = '<?xml version="1.0" encoding="ISO-8859-1"?>'


@pytest.mark.wording
def test_bytes_that_are_not_utf_8_have_a_remedy():
    with raises(files.XML_MALFORMED) as got:
        xml.parse("<a>ü</a>".encode("latin-1"))
    assert LATIN in got.value.hint


def test_bytes_that_are_not_utf_8_are_named():
    text = '<robot name="r">\n<link name="Tür"/></robot>'
    with raises(files.XML_MALFORMED, byte=0xFC, column=14) as got:
        xml.parse(text.encode("latin-1"), "r.urdf")
    assert str(got.value.origin) == "r.urdf:2"
    for encoding, head in (("utf-8", ""), ("latin-1", LATIN)):
        assert xml.parse((head + text).encode(encoding)).children[0].require("name") == "Tür"


def test_a_plugin_outside_of_a_gazebo_element_is_named():
    text = '<robot name="r"><link name="a"/><plugin name="b" filename="x.so"><z/></plugin></robot>'
    root = xml.parse(text.encode(), "r.urdf")
    root.all("link")
    found = next(each for each in unread(root) if each.values.get("tag") == "plugin")
    assert found.values["plugins"] == ("x.so",)
    assert found.values["parameters"] == ("z",)


@pytest.mark.wording
@pytest.mark.parametrize(
    ("plugins", "end"),
    [
        ("", "ignored"),
        ("a", 'so plugin "a.so" in it is not loaded'),
        ("ab", 'so plugins "a.so" and "b.so" in it are not loaded'),
        ("abcde", 'so plugins "a.so", "b.so", "c.so" and 2 more in it are not loaded'),
    ],
)
def test_plugins_in_an_unread_element_are_named(plugins, end):
    tags = "".join(f'<plugin filename="{each}.so"/>' for each in plugins)
    (found,) = unread(xml.parse(f"<model><gazebo><x>{tags}</x></gazebo></model>"))
    assert found.message.endswith(end)


@pytest.mark.parametrize("encode", [str, str.encode])
@pytest.mark.parametrize(
    ("head", "line", "reported"),
    [
        ('?xml version="1.0"?>\n', 2, (1, '?xml version="1.0"?>')),
        ("<!-- a -->\nleft\n<!-- a > b -->\n<?xml version='1.0'?>\n", 5, (2, "left")),
        ("<?xml version='1.0'?>\n--> ", 2, (2, "-->")),
        (f"{'x ' * 1000}\n", 2, (1, "x " * 29 + "x")),
        ("\ufeff<?xml version='1.0' encoding='UTF-8'?>\n", 2, None),
        ("\n", 2, None),
    ],
)
def test_text_before_the_root_of_an_sdf_file_is_ignored_as_in_gazebo(encode, head, line, reported):
    root = xml.parse(encode(head + "<sdf version='1.6'>\n<model name='ü'/></sdf>"), "a.sdf")
    assert (root.origin.line, root.children[0].origin.line) == (line, line + 1)
    assert root.children[0].attributes == {"name": "ü"}
    found = [(each.origin.line, each.values["text"]) for each in root.notes]
    assert found == ([] if reported is None else [reported])
    assert all(each.code is tags.TAG_IGNORED for each in root.notes)


@pytest.mark.parametrize(
    "text",
    [
        "?xml?><robot name='a'/>",  # ROS reads a URDF with expat
        "<sdf version='1.6'/>text",
        "text<!-- <sdf/>",
        "text<sdfs/>",
        "text<model><sdf/></model>",
    ],
)
def test_other_text_outside_of_the_root_is_an_error(text):
    with pytest.raises(DescriptionError):
        xml.parse(text)
