"""Expressions of strangers' files: what they cannot reach, what they cannot make, what works."""

import threading
import time
import warnings
from pathlib import Path

import pytest
import yaml
from tests.coded import raises

from cartwheel.codes.files import (
    EXPANSION_TOO_LARGE,
    EXPRESSION_INVALID,
    XACRO_INVALID,
    XACRO_NAME_UNKNOWN,
)
from cartwheel.description import load_text
from cartwheel.description.elements import xml
from cartwheel.description.expressions import budget as bounds
from cartwheel.description.expressions import syntax
from cartwheel.description.files.packages import Packages
from cartwheel.description.xacro import expand
from cartwheel.errors import DescriptionError

NS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def expanded(body):
    text = f'<robot name="r" {NS}>{body}</robot>'
    return expand(text, "<string>", Packages(None, environment={}), {}).root


def quoted(text):
    """Text as an attribute's value."""
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return f'"{text}"'


def value(expression, given=""):
    return expanded(f"{given}<a b={quoted('${' + expression + '}')}/>").children[0].attributes["b"]


ESCAPES = [
    "().__class__",
    "().__class__.__base__.__subclasses__()",
    "(lambda: ().__class__.__base__.__subclasses__())()",
    "''.__class__.__mro__",
    "sin.__self__",
    "math.__dict__",
    "xacro.load_yaml.__globals__",
    "xacro.load_yaml.run",
    "xacro.load_yaml.run.__globals__",
    "math.sin.run",
    "xacro.parent",
    "xacro.root",
    "xacro.top()",
    "xacro._setitem('a', 1, False)",
    "xacro['__class__']",
    "python.str.mro()",
    "python.type(1).mro()",
    "python.type('')('a').__class__",
    "python.type('t', (), dict())",
    "python.vars(xacro)",
    # xacro ends an expression at its first "}": it is put together here.
    "str.format('{0.__class__' + '%c' % 125, 1)",
    "('{0.__class__' + '%c' % 125).format(1)",
    "('{a.__class__' + '%c' % 125).format_map(dict(a=1))",
    "f''",
    "'%s' % xacro",
    "str(xacro)",
    "str([xacro])",
    "[xacro]",
    "xacro",
    "(x for x in [1]).gi_frame",
    "[x for x in [1]].gi_frame.f_builtins",
    "(lambda: 1).__code__",
    "(lambda: 1).__globals__",
    "(lambda *a: a)(1)",
    "(x := 1)",
    "__import__('os')",
    "__builtins__",
    "open('/etc/passwd')",
    "eval('1')",
    "exec('1')",
    "getattr('', 'join')",
    "globals()",
    "dotify.__init__",
    "xacro.dotify(dict(a=1)).__class__",
    "xacro.dotify(dict(a=1))._YamlListWrapper__wrap",
    "'a'.encode().decode('unicode_escape')",
    "'a'.translate(dict())",
    "[].__add__",
    "[1].append.__self__",
    "dict(a=1).fromkeys",
    "b'a'",
    "...",
    "await x",
    "1 .__class__",
    "1j.__class__",
    "True.__class__",
    "pi.fromhex('1')",
    "xs @ xs",
    "'a'.join.__call__(['b'])",
    "min([1], key=python.type(''.join))",
    "sorted([1], key=1)",
    "map(xacro, [1])",
    "xacro.tokenize('aaaaaaaaaaaaaaaaaaaaaaaaaaaa!', ']|(a+)+$|[')",
]


@pytest.mark.parametrize("expression", ESCAPES)
def test_an_expression_cannot_reach_python(expression):
    with pytest.raises(DescriptionError) as caught:
        value(expression)
    # It was read as an expression, and refused for what it says.
    if caught.value.code is not XACRO_NAME_UNKNOWN:
        assert caught.value.code is EXPRESSION_INVALID
        assert "refused" in caught.value.values or caught.value.values["cause"] == "TypeError"


@pytest.mark.wording
@pytest.mark.parametrize("expression", ESCAPES)
def test_a_refused_expression_shows_no_address(expression):
    with pytest.raises(DescriptionError) as caught:
        value(expression)
    assert f"(in the expression ${{{expression[:20]}" in caught.value.message
    assert "0x" not in str(caught.value)


@pytest.mark.parametrize(
    ("expression", "refused"),
    [
        ("().__class__", "__class__"),
        ("(lambda: ().__class__)", "__class__"),
        ("[x.__class__ for x in [1]]", "__class__"),
        ("'{0.__class__}'.format(1)", "str.format"),
        ("__import__('os')", "__import__"),
    ],
)
def test_nor_can_one_of_eval(expression, refused):
    extension = quoted("$(eval " + expression.replace(")", "]").replace("(", "[") + ")")
    with raises(EXPRESSION_INVALID, refused=refused):
        expanded(f"<a b={extension}/>")


_BITS = {"kind": "number", "most": 4096}
_TEXT = {"kind": "text", "most": 1_000_000}
_LIST = {"kind": "list", "most": 100_000}
_FIELD = {"kind": "field", "most": 1000}
_VALUE = {"kind": "value", "most": 1_000_000}
_ITEMS = {"kind": "value", "most": 100_000}
_TOTAL = {"kind": "memory", "most": 100_000_000}
_WORK = {"kind": "operations", "most": 20_000_000}
_NESTED = {"kind": "nesting", "most": 100}
_TOO_LARGE = ("number", "text", "list", "value", "memory", "operations")
BOMBS = {
    "10**10**10": _BITS,
    "2**4097": _BITS,
    "9**9**9": _BITS,
    "1 << 10**10": _BITS,
    "(2**4000) * (2**4000)": _BITS,
    "'a'*10**10": _TEXT,
    "10**10*'a'": _TEXT,
    "[0]*10**9": _LIST,
    "(0,)*10**9": _LIST,
    "'a'.ljust(10**9)": _TEXT,
    "'a'.zfill(10**9)": _TEXT,
    "'%1000000000d' % 5": _FIELD,
    "'%.1000000000f' % 5.0": _FIELD,
    "'%*d' % (10**9, 5)": _FIELD,
    "'%(a)s' * 90000 % dict(a='x'*90000)": _TEXT,
    "('x'*90000).replace('x', 'y'*90000)": _TEXT,
    "'a'.join(['b'*90000]*9000)": _VALUE,
    "round(5, -10**9)": {"kind": "round", "most": 400},
    "math.factorial(10**6)": {"kind": "math.factorial", "most": 500},
    "math.comb(10**6, 5*10**5)": {"kind": "math.comb", "most": 500},
    "math.perm(10**6, 5*10**5)": {"kind": "math.perm", "most": 500},
    "math.prod([2**4000]*1000)": _BITS,
    "math.lcm(*[2**4000-i for i in python.range(100)])": _BITS,
    "python.sum([[1]*9000]*9000, [])": _LIST,
    "python.range(10**10)": _LIST,
    "1.5 in python.range(10**10)": _LIST,
    "list(python.range(10**8))": _LIST,
    "str([[[0]*1000]*1000]*1000)": _ITEMS,
    "[[[0]*1000]*1000]*1000 == [[[0]*1000]*1000]*1000": _ITEMS,
    "[[[0]*1000]*1000]*1000 in [1]": _ITEMS,
    "python.hash((((0,)*1000,)*1000,)*1000)": _ITEMS,
    "python.repr([['x'*9000]*9000])": _VALUE,
    "[a for a in python.range(90000) for b in python.range(90000)]": _LIST,
    "int('f'*90000, 16)": _BITS,
    "(lambda f: f(f))(lambda f: f(f))": {"kind": "lambda", "most": 30},
    "[" * 150 + "]" * 150: _NESTED,
    "-" * 4000 + "1": {"kind": "nesting"},
    "not " * 1000 + "1": _NESTED,
    "1" + "+1" * 2400: _NESTED,
    "'" + "a" * 6000 + "'": {"kind": "expression", "most": 5000},
    "9" * 4900: {"cause": "SyntaxError"},
    "('a'*200000).rfind('ab' + 'a'*150000)": _WORK,
    "('a'*200000).rsplit('ab' + 'a'*150000)": _WORK,
    "('a'*200000).strip('b'*150000 + 'a')": _WORK,
    "'%(a(b))9999d' % dict([('a(b)', 5)])": {"refused": "("},
    "'%(a)999s'*9000 % dict(a=1) and 0": _TEXT,
    "len([('ab '*99999).split() for i in python.range(33)])": _TOTAL,
    "len([[(1<<4000)+j for j in python.range(9000)] for i in python.range(20)])": _TOTAL,
    "len([[-i for i in [1<<4000]*9000] for j in python.range(30)])": _TOTAL,
    (
        "(lambda a, b: python.sorted(python.range(90000), key=lambda i: a if i % 2 else b))"
        "('x'*9000, 'x'*8999 + 'y')"
    ): _VALUE,
    "max(python.range(90000), key=lambda i: 'x'*9000)": _TOTAL,
}
"""Expressions, and the bound that each meets."""


@pytest.mark.parametrize(("expression", "bound"), BOMBS.items(), ids=[text[:40] for text in BOMBS])
def test_an_expression_cannot_make_much(expression, bound):
    code = EXPANSION_TOO_LARGE if bound.get("kind") in _TOO_LARGE else EXPRESSION_INVALID
    with raises(code, **bound):
        value(expression)


@pytest.mark.parametrize(
    "expression",
    [
        "[[a for a in python.range(90000)] for b in python.range(90000)]",
        "(lambda f, n: f(f, n))(lambda f, n: 0 if n == 0 else f(f, n-1) + f(f, n-1), 28)",
    ],
)
def test_an_expression_cannot_take_long(expression, monkeypatch):
    monkeypatch.setattr(bounds.Budget.__init__, "__defaults__", (0.3,))
    with raises(EXPANSION_TOO_LARGE, kind="time", most=0.3):
        value(expression)


@pytest.mark.parametrize(
    "expression",
    [
        "python.set(KEYS)",
        "python.set([1]).union(KEYS)",
        "python.set([1]).update(KEYS)",
        "dict([(key, 0) for key in KEYS])",
        "dict().update([(key, 0) for key in KEYS])",
    ],
)
def test_keys_of_one_hash_cannot_take_long(expression, monkeypatch):
    monkeypatch.setattr(bounds.Budget.__init__, "__defaults__", (0.3,))
    keys = f"[i*{2**61 - 1} for i in python.range(30000)]"
    start = time.thread_time()
    with raises(EXPANSION_TOO_LARGE, kind="time", most=0.3):
        value(expression.replace("KEYS", keys))
    # Put in at once they would take ten times as long.
    assert time.thread_time() - start < 1.5


def test_files_that_are_read_many_times_cannot_take_long(tmp_path, monkeypatch):
    file = tmp_path / "list.yaml"
    file.write_text("[" + "1," * 5000 + "]")
    monkeypatch.setattr(bounds.Budget.__init__, "__defaults__", (0.3,))
    text = f"[0 for i in python.range(40) if xacro.load_yaml('{file}') is 1]"
    with raises(EXPANSION_TOO_LARGE, kind="time", most=0.3):
        expand(
            f'<robot name="r" {NS}><a b="${{{text}}}"/></robot>',
            "test",
            Packages(tmp_path / "r.xacro"),
            {},
        )


def test_no_long_expression_is_kept():
    before = syntax._kept.cache_info().currsize
    for i in range(9):
        value(f"[{'1,' * 400} {i}][-1]")
    assert syntax._kept.cache_info().currsize == before


@pytest.mark.parametrize(
    ("character", "point"),
    [(r"\x1b", "U+001B"), (r"\0", "U+0000"), (r"\ud800", "U+D800"), (r"\uffff", "U+FFFF")],
)
def test_an_expression_cannot_make_what_xml_does_not_allow(character, point):
    for body in (f"<a b=\"${{'{character}'}}\"/>", f"<a>${{'{character}'}}</a>"):
        with raises(XACRO_INVALID, character=point):
            expanded(body)


def doubling(first, level):
    return first + "".join(level.replace("NEXT", str(i + 1)).replace("LAST", str(i))
                           for i in range(41))  # fmt: skip


SMALL_FILES = {
    "macros without elements": doubling(
        '<xacro:macro name="m0"/>',
        '<xacro:macro name="mNEXT"><xacro:mLAST/><xacro:mLAST/></xacro:macro>',
    )
    + "<xacro:m41/>",
    "macros called by name": doubling(
        '<xacro:macro name="m0"/>',
        '<xacro:macro name="mNEXT"><xacro:call macro="mLAST"/><xacro:call macro="mLAST"/>'
        "</xacro:macro>",
    )
    + "<xacro:m41/>",
    "texts": doubling(
        '<xacro:property name="p0" value="xx"/>',
        '<xacro:property name="pNEXT" value="${pLAST}${pLAST}"/>',
    )
    + '<a b="${p41}"/>',
    "lists": doubling(
        '<xacro:property name="p0" value="xx"/>',
        '<xacro:property name="pNEXT" value="${[pLAST, pLAST]}"/>',
    )
    + '<a b="${p41}"/>',
    "blocks": doubling(
        '<xacro:property name="b0"/>',
        '<xacro:property name="bNEXT"><xacro:insert_block name="bLAST"/>'
        '<xacro:insert_block name="bLAST"/></xacro:property>',
    )
    + '<xacro:insert_block name="b41"/>',
    "a long text in many copies": '<xacro:macro name="m"><a b="' + "a" * 10**6 + '"/></xacro:macro>'
    + "<xacro:m/>" * 500,
    "many attributes": '<xacro:macro name="m"><a '
    + " ".join(f'a{i}=""' for i in range(20_000)) + "/></xacro:macro>" + "<xacro:m/>" * 30,
    "many long texts": "<a b=\"${'a'*999999}\"/>" * 500,
    "a macro's parameters": '<xacro:macro name="m" params="' + "a b " * 100_000 + '"/>',
    "a name of brackets": f'<xacro:property name="{"(" * 100_000}" value="1"/>',
    "unclosed expressions": f'<a b="{"${" * 300_000}"/>',
    "itself": '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>',
}  # fmt: skip


@pytest.mark.parametrize("name", SMALL_FILES)
def test_a_small_file_cannot_make_much(name, monkeypatch):
    monkeypatch.setattr("cartwheel.description.xacro.expansion.MAX_ELEMENTS", 5000)
    monkeypatch.setattr("cartwheel.description.xacro.expansion.MAX_CALLS", 1000)
    with pytest.raises(DescriptionError):
        expanded(SMALL_FILES[name])


@pytest.mark.parametrize(
    "body",
    [
        '<xacro:macro name="m" params="x:=' + "a" * 60 + "'\"/>",
        '<xacro:macro name="m" params="x:=' + "'a'" * 60 + "'b\"/>",
        f'<a b="{"$x" * 500_000}"/>',
    ],
    ids=["a word and a quote", "quotes", "dollars"],
)
def test_what_took_years_to_read_is_read(body):
    assert expanded(body).tag == "robot"


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("2 * pi", "6.283185307179586"),
        ("-1.5e3 + 2**3 // 3 % 5", "-1498.0"),
        ("1 if 2 < 3 <= 3 != 4 else 0", "1"),
        ("'a' in ['a', 'b'] and not 'c' in ('d',)", "True"),
        ("None or 'x'", "x"),
        ("' a,b '.strip().upper().split(',')[1]", "B"),
        ("'%s_%.3f' % ('a', 1/3)", "a_0.333"),
        ("'link_' + str(3)", "link_3"),
        ("'wrist_roll'[-4:]", "roll"),
        ("[str(2*x) for x in [1, 2, 3] if x != 2]", "['2', '6']"),
        ("' '.join([str(x) for x in (1, 2)])", "1 2"),
        ("' '.join(map(str, [1, 2]))", "1 2"),
        ("dict([(k, v) for k, v in [('a', 1)]])['a']", "1"),
        ("sorted([3, 1, 2], key=lambda x: -x)", "[3, 2, 1]"),
        ("python.sorted(dict(b=1, a=2).items())", "[('a', 2), ('b', 1)]"),
        ("max(1, 2.5)", "2.5"),
        ("min([3, 4], key=lambda x: -x)", "4"),
        ("python.sum([1, 2, 3])", "6"),
        ("3 in python.range(1, 11)", "True"),
        ("[i for i, _ in python.enumerate('ab')]", "[0, 1]"),
        ("python.isinstance('a', python.str) and python.isinstance(1, (int, float))", "True"),
        ("python.type(1) == int", "True"),
        ("math.sqrt(2) == sqrt(2) and radians(180) == pi", "True"),
        ("[1, 2, 3].pop()", "3"),
        ("python.zip([1], [2])", "[(1, 2)]"),
        ("xacro.dotify(dict(a=dict(b=1))).a.b", "1"),
        ("xacro.tokenize('a, b;c')", "['a', 'b', 'c']"),
        ("len('abc') + int('4') + float('0.5')", "7.5"),
        ("(lambda a, b=2: a + b)(1)", "3"),
        ("math.factorial(5)", "120"),
        ("[x for y in [[1, 2], [3]] for x in y][::-1]", "[3, 2, 1]"),
    ],
)
def test_what_files_use_works(expression, expected):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert value(expression) == expected


def test_properties_are_evaluated_when_they_are_used():
    given = '<xacro:property name="a" value="${b + 1}"/><xacro:property name="b" value="2"/>'
    assert value("a * 2", given) == "6"
    with raises(XACRO_NAME_UNKNOWN, kind="property", name="c"):
        value("[c for x in [1]]")


def test_eval_knows_arguments():
    root = expanded(
        '<xacro:arg name="n" default="3"/><a b="$(eval n * 2 + 1)" c="$(eval n == 3 and true)"/>'
    )
    assert dict(root.children[0].attributes) == {"b": "7", "c": "True"}


def test_pyyaml_is_left_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("c.yaml").write_text("angle: !degrees 45 * 2\nlength: !inches 1\n")
    before = dict(yaml.SafeLoader.yaml_constructors)
    Path("r.xacro").write_text(
        f"""<robot name="r" {NS}><xacro:property name="c" value="${{xacro.load_yaml('c.yaml')}}"/>
        <a b="${{c.angle}}" c="${{c['length']}}"/></robot>"""
    )
    path = Path("r.xacro")
    root = expand(xml.read_bytes(path), "r.xacro", Packages(path, environment={}), {}).root
    assert dict(root.children[0].attributes) == {"b": "1.5707963267948966", "c": "0.0254"}
    assert yaml.SafeLoader.yaml_constructors == before
    with pytest.raises(yaml.constructor.ConstructorError):
        yaml.safe_load("!degrees ().__class__")


@pytest.mark.parametrize(
    "content",
    [
        "a: &a [x,x,x,x,x,x,x,x,x]\n"
        + "".join(f"{n}: &{n} [{','.join(['*' + chr(ord(n) - 1)] * 9)}]\n" for n in "bcdefghij"),
        "&a [*a]",
        "[" * 5000,
        "a: " * 200,
        "!degrees ().__class__",
        "!degrees 10**10**10",
        "!!python/object/apply:os.system [echo]",
        "2001-99-99",
        "x" * 3_000_000,
    ],
    ids=["aliases", "itself", "brackets", "colons", "escape", "power", "python", "date", "large"],
)
def test_yaml_of_strangers_has_bounds(content, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("c.yaml").write_text(content)
    body = """<xacro:property name="c" value="${xacro.load_yaml('c.yaml')}"/><a b="${c}"/>"""
    Path("r.xacro").write_text(f'<robot name="r" {NS}>{body}</robot>')
    path = Path("r.xacro")
    with pytest.raises(DescriptionError):
        expand(xml.read_bytes(path), "r.xacro", Packages(path, environment={}), {})


def test_an_expansion_waits_for_no_other(monkeypatch):
    inside, go_on = threading.Event(), threading.Event()

    class Slow(Packages):
        def find(self, name, origin=None):
            inside.set()
            assert go_on.wait(60)
            return Path("/there")

    text = f'<robot name="r" {NS}><a b="$(find pkg)"/></robot>'
    found = []
    thread = threading.Thread(
        target=lambda: found.append(expand(text, "<string>", Slow(None, environment={}), {}))
    )
    thread.start()
    assert inside.wait(60)
    other = threading.Thread(target=lambda: found.append(value("1 + 1")))
    other.start()
    other.join(60)
    assert found == ["2"]
    go_on.set()
    thread.join(60)
    assert found[1].root.children[0].attributes["b"] == "/there"


def test_no_command_runs(tmp_path):
    text = f"""<robot name="r" {NS}><link name="a"/><xacro:property name="x" value=
    "${{[c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close'][0]
    .__init__.__globals__['system']('touch {tmp_path}/owned')}}"/>${{x}}</robot>"""
    with raises(EXPRESSION_INVALID, refused="__class__"):
        load_text(text)
    assert not (tmp_path / "owned").exists()
