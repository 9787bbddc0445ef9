"""Launch files of strangers, which are made to take long or to fill the memory."""

from __future__ import annotations

import time
import tracemalloc
from pathlib import Path

import pytest

from cartwheel.description.launches import effort, launches_near
from cartwheel.description.launches.written import written_in

_SECONDS = 10.0
"""CPU time. Without limits, each of these files takes minutes, or more memory than there is."""
_SLOW = "len([x for x in range(99999) if [y for y in range(99999)]])"
_ROBOT = 'Command(["xacro ", FindPackageShare("arm"), "/urdf/arm.urdf"])\n'
_KNOWN = '<param name="robot_description" textfile="$(find arm)/urdf/arm.urdf"/>'


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "arm"
    for name in ("launch", "urdf"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    (folder / "urdf" / "arm.urdf").write_text('<robot name="arm"><link name="base"/></robot>')
    return folder


def _read(package: Path, name: str, text: str) -> list[str]:
    (package / "launch" / name).write_text(text)
    begin = time.thread_time()
    found = launches_near(package)
    assert time.thread_time() - begin < _SECONDS
    return [each.description.name for each in found if each.description is not None]


_DOUBLED = "".join(f'<arg name="a{n + 1}" value="{f"$(arg a{n})" * 10}"/>' for n in range(9))


@pytest.mark.parametrize(
    "elements",
    [
        f'<arg name="a0" value="{"x" * 1000}"/>{_DOUBLED}',
        f'<arg name="a" value="$({"a" * 300_000}"/>',
        f'<arg name="a" value="{"$(" * 300_000}"/>',
        "".join(f'<arg name="a{n}" value="$({"a" * 4900}$({" " * 4900}"/>' for n in range(1400)),
        "".join(f'<arg name="a{n}" value="{"$(" * 4900}"/>' for n in range(1400)),
    ],
    ids=["doubled", "long-call", "long-calls", "calls", "open-calls"],
)
def test_texts_in_xml_neither_grow_nor_take_long(package: Path, elements: str) -> None:
    found = _read(package, "a.launch", f"<launch>{elements}{_KNOWN}</launch>")
    assert found == ["arm.urdf"]  # what follows is read


@pytest.mark.parametrize(
    "statement",
    [
        "p = Path(p) / p",
        "p = os.path.join(p, p)",
        "p = os.path.join(*[[p, [p, p]], p])",
        'SetLaunchConfiguration("p", [LaunchConfiguration("p"), LaunchConfiguration("p"), "ab"])',
        'DeclareLaunchArgument("p", default_value=p); p = f"{p}{p}"',
    ],
)
def test_texts_in_python_do_not_grow(package: Path, statement: str) -> None:
    text = f'p = "abcd"\n{statement}\n' + f"{statement}\n" * 50 + _ROBOT
    assert _read(package, "a.launch.py", text) == ["arm.urdf"]


def _is_read_to_the_end(package: Path, name: str, text: str) -> bool:
    """Whether a launch file is read to its end. Other launch files are read in any case."""
    folder = package / "launch"
    known = f"<launch>{_KNOWN}</launch>"
    is_python = name.endswith(".py")
    whole = f"{text}\n{_ROBOT}" if is_python else text.replace("</launch>", f"{_KNOWN}</launch>")
    for each in ("0.launch", "z.launch"):
        (folder / each).unlink(missing_ok=True)
    found = _read(package, name, whole)
    for each in ("0.launch", "z.launch"):
        (folder / each).write_text(known)  # remains there
    assert _read(package, name, whole) == [*["arm.urdf"] * 2, *found]
    assert found in ([], ["arm.urdf"])
    return bool(found)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.launch", """<launch><arg name="a" value="$(eval EXPRESSION)"/></launch>"""),
        ("a.launch.py", """PythonExpression(["EXPRESSION"])\n"""),
    ],
)
def test_all_expressions_together_take_a_limited_time(
    package: Path, name: str, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(effort, "_SECONDS", 0.25)  # An expression may take 0.2 s.
    assert _is_read_to_the_end(package, name, text.replace("EXPRESSION", "1 + 1"))
    many = "".join(
        (package / "launch" / f"{n}{name}").write_text(text.replace("EXPRESSION", _SLOW)) and ""
        for n in range(3)
    )
    (package / "launch" / "0.launch").unlink()
    assert _read(package, name, many) == []  # not even what follows


@pytest.mark.parametrize(
    "text",
    [
        "for i in range(400):\n" + "  pass\n" * 1000,
        "for i in range(400):\n  x = [" + "a, " * 1000 + "]\n  print(x)\n",
        'yaml.safe_load("c.yaml")\n',
        "".join(f'FindPackageShare("package{n}")\n' for n in range(100)),
        "x = " + "1 + " * 60_000 + "1\n",
    ],
    ids=["statements", "values", "yaml", "packages", "size"],
)
def test_the_work_of_all_launch_files_is_limited(
    package: Path, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(effort, "_STEPS", 200_000)
    monkeypatch.chdir(package)
    (package / "c.yaml").write_text("# " + "-" * 20_000)
    assert _is_read_to_the_end(package, "a.launch.py", "x = 1")
    assert not _is_read_to_the_end(package, "a.launch.py", text)


def test_the_values_that_a_function_returns_take_a_limited_time(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(effort, "_STEPS", 200_000)
    text = """
def found():
    long = ["a", "b"]
    DOUBLED
    for _ in range(5000):
        if unknown():
            return VALUE
    return VALUE

x = found()
""".replace("DOUBLED", "; ".join(["long = long + long"] * 12))
    assert _is_read_to_the_end(package, "a.launch.py", text.replace("VALUE", '"a"'))
    assert not _is_read_to_the_end(package, "a.launch.py", text.replace("VALUE", "[long]"))


def test_a_launch_file_is_read_after_a_chained_comparison(package: Path) -> None:
    text = f'a = "x" if 1 < 2 < 3 else "y"\nif 1 < 2 < 3:\n    pass\n{_ROBOT}'
    assert _read(package, "a.launch.py", text) == ["arm.urdf"]


def test_namespaces_of_parameters_in_a_launch_file_do_not_fill_the_memory(package: Path) -> None:
    path = package / "a.launch"
    block = '<rosparam ns="{}">\nmove: {{type: a/BController}}</rosparam>'
    deep = block.format("a/" * 20_000)
    path.write_text(f"<launch>{deep}\n{block.format('b/c')}</launch>")
    text = written_in(path)
    assert text is not None
    assert [line.strip() for line in text.splitlines() if line] == [
        "b:",
        "c:",
        "move: {type: a/BController}",
    ]


def test_thousands_of_parameters_in_a_launch_file_take_a_limited_time(package: Path) -> None:
    path = package / "a.launch"
    many = (f"<rosparam>m{number}: {{type: a/BController}}</rosparam>" for number in range(60_000))
    path.write_text("<launch>{}</launch>".format("\n".join(many)))
    begin = time.thread_time()
    text = written_in(path)
    assert time.thread_time() - begin < _SECONDS
    assert text is not None
    assert len(text.splitlines()) == 60_000


def test_nested_branches_with_many_variables_need_little_memory(package: Path) -> None:
    names = "".join(f"v{n} = {n}\n" for n in range(20_000))
    branches = "".join("  " * depth + "if unknown():\n" for depth in range(60))
    peaks = []
    for text in (names, f"{names}{branches}{'  ' * 60}v1 = 2\n"):
        tracemalloc.start()
        assert _is_read_to_the_end(package, "a.launch.py", text)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0]
