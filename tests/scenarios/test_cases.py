"""Parameters and seeds: which cases a scenario has."""

from __future__ import annotations

import pytest
from tests.coded import raises

from cartwheel.codes.command import SCENARIO_EXPRESSION, SCENARIO_INVALID
from cartwheel.scenarios import cases_of, digests
from cartwheel.scenarios.cases import resolved
from cartwheel.scenarios.expectations import Expression
from cartwheel.scenarios.expressions import CONDITION_NAMES, ExpressionFaultError, evaluate

CART = "robots: [{robot: rosbots.xacro, name: cart}]\n"
EXPECT = "expect: [{moves: cart}]\n"


def ids(loaded, **options):
    return [case.id for case in cases_of(loaded, **options)]


def test_a_scenario_without_parameters_is_one_case(scenario):
    assert ids(scenario(EXPECT, "drive.yaml")) == ["drive"]


def test_lists_and_seeds_are_combined(scenario):
    text = f"name: a\nseed: 5\nseeds: 2\nparameters: {{v: [1, 2], w: [x]}}\n{EXPECT}"
    expected = [f"a[v={v},w=x,seed={seed}]" for v in (1, 2) for seed in (5, 6)]
    assert ids(scenario(text)) == expected


def test_a_range_includes_both_ends(scenario):
    loaded = scenario(f"parameters: {{v: {{from: 0.1, to: 0.5, count: 5}}}}\n{EXPECT}")
    assert [case.parameters["v"] for case in cases_of(loaded)] == [0.1, 0.2, 0.3, 0.4, 0.5]


def test_random_values_depend_on_the_seed_alone(scenario):
    text = (
        "seeds: 200\nparameters:\n  u: {uniform: [2, 4]}\n  n: {normal: [1, 0.5]}\n"
        f"  c: {{choice: [a, b]}}\n{EXPECT}"
    )
    loaded = scenario(text)
    cases = cases_of(loaded)
    assert [case.parameters for case in cases] == [case.parameters for case in cases_of(loaded)]
    uniform = [case.parameters["u"] for case in cases]
    assert 2 <= min(uniform) < 2.1 and 3.9 < max(uniform) <= 4
    # The standard error of the mean of 200 values is 0.5 / sqrt(200) = 0.035.
    assert sum(case.parameters["n"] for case in cases) / 200 == pytest.approx(1, abs=0.15)
    assert {case.parameters["c"] for case in cases} == {"a", "b"}
    again = cases_of(loaded, seeds=[7])
    assert again[0].parameters == cases[7].parameters


def test_values_replace_expressions(scenario):
    loaded = scenario(
        "parameters: {v: [3]}\n"
        "expect: [{reaches: 'cart_${v}', x: '${v * 2}', y: '${sqrt(v + 1) + seed}'}]\n"
    )
    value = resolved(loaded, cases_of(loaded)[0])
    assert value["expect"] == [{"reaches": "cart_3", "x": 6, "y": 2.0}]


@pytest.mark.parametrize(
    ("expression", "code"),
    [
        ("vv", SCENARIO_EXPRESSION),
        ("v +", SCENARIO_EXPRESSION),
        ("1 / 0", SCENARIO_EXPRESSION),
        ("().__class__", SCENARIO_EXPRESSION),
        ("__import__('os')", SCENARIO_EXPRESSION),
        ("'a' * 10**9", SCENARIO_EXPRESSION),
        ("'far'", SCENARIO_INVALID),
        ("inf", SCENARIO_INVALID),
    ],
)
def test_an_invalid_value_is_found_before_any_case_runs(scenario, expression, code):
    loaded = scenario(
        f'parameters: {{v: [1]}}\nexpect:\n  - moves: a\n    after: "${{{expression}}}"'
    )
    with raises(code) as raised:
        cases_of(loaded)
    assert raised.value.origin.line == 4


@pytest.mark.parametrize("text", ["open('/etc/passwd')", "x.__globals__", "eval('1')", "exec('')"])
def test_conditions_have_no_access_to_python(text):
    from cartwheel.errors import CartwheelError

    with pytest.raises((ExpressionFaultError, CartwheelError)):
        evaluate(text, {"x": evaluate})


def test_too_many_cases_are_refused(scenario):
    loaded = scenario(f"seeds: 1000000\n{EXPECT}")
    with raises(SCENARIO_INVALID) as raised:
        cases_of(loaded)
    assert raised.value.values["cases"] == 1_000_000


def test_a_digest_changes_with_files_parameters_and_seed(scenario, tmp_path):
    robot = tmp_path / "robot.urdf"
    text = f"robots: [{{robot: robot.urdf}}]\nseeds: 2\nparameters: {{v: [1, 2]}}\n{EXPECT}"

    def made(mass=1):
        robot.write_text(
            f'<robot name="cart"><link name="base"><inertial><mass value="{mass}"/>'
            '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
        )
        loaded = scenario(text)
        return [case.digest for case in digests(loaded, cases_of(loaded))]

    first = made()
    assert len(set(first)) == 4 and made() == first
    assert not set(made(mass=2)) & set(first)


ROBOT = """<robot name="box"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry>
<mesh filename="box.obj"/></geometry></visual></link></robot>"""
WORLD = """<sdf version="1.7"><world name="w">
<include><uri>model://wall</uri></include></world></sdf>"""
WALL = """<sdf version="1.7"><model name="wall"><static>true</static>
<link name="l"/></model></sdf>"""


@pytest.mark.parametrize(
    "file", ["box.urdf", "box.obj", "box.mtl", "a.yaml", "later.urdf", "w.world", "wall/model.sdf"]
)
def test_a_digest_changes_with_each_file(scenario, tmp_path, file):
    (tmp_path / "wall").mkdir()
    for name, text in {
        "box.urdf": ROBOT, "box.obj": "mtllib box.mtl\nv 0 0 0\n", "box.mtl": "newmtl a\n",
        "a.yaml": "{}", "later.urdf": ROBOT, "w.world": WORLD, "wall/model.sdf": WALL,
        "wall/model.config": "<model><sdf>model.sdf</sdf></model>",
    }.items():  # fmt: skip
        (tmp_path / name).write_text(text)
    loaded = scenario(
        "world: w.world\nrobots: [{robot: box.urdf, controllers: a.yaml}]\n"
        f"steps: [{{spawn: later.urdf, name: b}}]\n{EXPECT}"
    )

    def digest() -> str:
        (case,) = digests(loaded, cases_of(loaded), [tmp_path])
        return case.digest

    before = digest()
    assert digest() == before
    (tmp_path / file).write_text((tmp_path / file).read_text() + "\n")
    assert digest() != before


@pytest.mark.parametrize(
    "text",
    [
        'expect: [{moves: cart}, {expression: "x(1) >"}]\n',
        f'steps: [{{until: {{expression: "x(1) >"}}}}]\n{EXPECT}',
    ],
)
def test_a_condition_that_is_no_expression_is_found_before_the_case(scenario, text):
    loaded = scenario(text)
    with raises(SCENARIO_EXPRESSION, expression="x(1) >") as caught:
        cases_of(loaded)
    assert caught.value.origin.line == 1


@pytest.mark.filterwarnings("error::SyntaxWarning")
@pytest.mark.parametrize(
    "text", ["-" * 200_000 + "1", "1" + "+1" * 200_000, "x" + ".y" * 100_000, "1if 1 else 2"]
)
def test_a_condition_of_a_stranger_is_refused_or_read_like_other_expressions(scenario, text):
    loaded = scenario(f'expect: [{{expression: "{text}"}}]\n')
    if len(text) > 100:
        with raises(SCENARIO_EXPRESSION):
            cases_of(loaded)
    else:
        assert len(cases_of(loaded)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "tme > 3",
        "time > 3 and xx('cart') > 1",
        "max([speed for each in range(3)]) > 1",
        "time > 1 if yaw('cart') else poses",
    ],
)
@pytest.mark.parametrize(
    "place", ["steps: [{until: {%s}}]\nexpect: [{moves: cart}]", "expect: [{%s}]"]
)
def test_unknown_names_are_found_before_a_case_runs(scenario, text, place):
    loaded = scenario(CART + place % f'expression: "{text}"')
    with raises(SCENARIO_EXPRESSION, expression=text) as caught:
        cases_of(loaded)
    assert caught.value.origin.line == 2


def test_names_of_conditions_are_those_that_exist():
    condition = Expression("time > 1")
    names = condition._names_of(None)
    assert {*names, "time"} == CONDITION_NAMES


def test_names_that_an_expression_binds_are_known(scenario):
    text = "sum([each * pi for each in range(3)]) > 1 and sqrt(time) > 0 and True"
    assert cases_of(scenario(f'{CART}expect: [{{expression: "{text}"}}]'))
