"""Launch files of strangers, which are read near a robot, take little time and memory."""

import time

import pytest

from cartwheel.description.launches import evaluation, launches_near

XML = "sim.launch", "<launch>{}</launch>"
PYTHON = "sim.launch.py", "{}"
DECLARED = 'DeclareLaunchArgument("{}", default_value={})\n'
START = '"xxxxxxxxxx"'


@pytest.mark.parametrize(
    ("file", "line", "values", "use"),
    [
        (XML, '<arg name="{}" default={}/>', '"{}"', "$(arg {})"),
        (PYTHON, DECLARED, "[{}]", 'LaunchConfiguration("{}"),'),
        (PYTHON, "{} = {}\n", "PathJoinSubstitution([{}])", "{},"),
        (PYTHON, "{} = {}\n", "f'{}'", "{{{}}}"),
        (PYTHON, "{} = {}\n", "PythonExpression(['\"', {} '\"'])", "{},"),
    ],
)
def test_texts_that_grow_in_each_line_are_bounded(tmp_path, file, line, values, use):
    """Each of 12 values contains the previous one 20 times: 4e16 characters."""
    lines = [line.format("a0", START)]
    for number in range(1, 13):
        value = values.format(20 * use.format(f"a{number - 1}"))
        lines.append(line.format(f"a{number}", value))
    name, whole = file
    (tmp_path / name).write_text(whole.format("".join(lines)))
    assert launches_near(tmp_path) == ()


@pytest.mark.parametrize(
    ("file", "line"),
    [(XML, '<arg name="a" value="$(eval {})"/>'), (PYTHON, 'PythonExpression(["{}"])\n')],
)
def test_all_expressions_together_take_a_limited_time(tmp_path, monkeypatch, file, line):
    """Each takes 40 ms, until it has too many values."""
    monkeypatch.setattr(evaluation, "_TOTAL", 0.2)
    slow = "len([x for x in range(100000) for y in range(1000)])"
    name, whole = file
    (tmp_path / name).write_text(whole.format(100 * line.format(slow)))
    began = time.process_time()
    assert launches_near(tmp_path) == ()
    assert time.process_time() - began < 1.5


def test_an_expression_does_not_make_a_long_text(tmp_path):
    """Of which a list could contain thousands."""
    (tmp_path / "arm.urdf").write_text("<robot/>")
    command = f"xacro {tmp_path}/arm.urdf a:=$(arg long) b:=$(arg short)"
    (tmp_path / "sim.launch").write_text(
        '<launch><arg name="long" value="$(eval \'a\' * 100000)"/>'
        '<arg name="short" value="$(eval \'a\' * 3)"/>'
        f'<param name="robot_description" command="{command}"/></launch>'
    )
    (use,) = launches_near(tmp_path)
    assert (use.arguments, use.unknown) == ({"b": "aaa"}, 1)
