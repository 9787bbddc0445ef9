"""Plugin files of scenarios and of the command."""

from pathlib import Path

import pytest

from cartwheel.codes.command import LAUNCH_NOT_ALLOWED
from cartwheel.codes.devices import PLUGIN_FILE_INVALID
from cartwheel.scenarios import Options, cases_of, digests
from cartwheel.scenarios.workers import Workers

from .test_command import command, results, write  # noqa: F401

PLUGIN = """
from cartwheel.plugin import NoTags, Plugin
from cartwheel.msgs.std_msgs import Float64


class Lamp(Plugin[NoTags]):
    filenames = ("libtest_lamp.so",)

    def configure(self):
        publisher = self.advertise("lamp", Float64)
        self.part.schedule(10.0, after=lambda: publisher.publish(Float64(data={level})))
"""
ROBOT = """<robot name="box"><link name="box"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<gazebo><plugin name="lamp" filename="libtest_lamp.so"/></gazebo></robot>"""
SCENARIO = """robots: [{robot: box.urdf, name: box, z: 1}]
duration: 0.5
seeds: 2
expect: [{expression: "field('/lamp', 'data') == 1"}]
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "box.urdf").write_text(ROBOT)
    (tmp_path / "lamp.py").write_text(PLUGIN.format(level=1.0))
    return tmp_path


def with_plugins(text: str) -> str:
    return f"plugins: [lamp.py]\n{text}"


def test_a_scenario_names_its_plugins(files, run):
    outcome = run(with_plugins(SCENARIO).replace("seeds: 2\n", ""), allow_launch=True)
    assert outcome.status == "passed", outcome.findings[0].text


def test_plugins_of_a_scenario_need_permission(files, run):
    outcome = run(with_plugins(SCENARIO).replace("seeds: 2\n", ""))
    (finding,) = outcome.findings
    assert (outcome.status, finding.code) == ("error", LAUNCH_NOT_ALLOWED.number)
    assert finding.line == 1


def test_a_missing_plugin_file_is_an_error_of_the_case(run, files):
    (files / "lamp.py").unlink()
    outcome = run(with_plugins(SCENARIO).replace("seeds: 2\n", ""), allow_launch=True)
    assert (outcome.status, outcome.findings[0].code) == ("error", PLUGIN_FILE_INVALID.number)


def test_plugins_are_used_in_parallel_processes(files, scenario):
    loaded = scenario(SCENARIO)
    cases = list(digests(loaded, cases_of(loaded), plugins=[files / "lamp.py"]))
    options = Options(
        folder=files / "out", record="none", pictures="none", plugins=(files / "lamp.py",)
    )
    workers = Workers([loaded], options, 2, 120.0)
    try:
        assert [each.status for each in workers.run(cases)] == ["passed", "passed"]
    finally:
        workers.close()


def test_digests_depend_on_the_plugin_files(files, scenario):
    loaded, named = scenario(SCENARIO), scenario(with_plugins(SCENARIO), "named.yaml")

    def found() -> tuple[str, str, str]:
        file = files / "lamp.py"
        (plain, _), (given, _), (own, _) = (
            tuple(digests(loaded, cases_of(loaded))),
            tuple(digests(loaded, cases_of(loaded), plugins=[file])),
            tuple(digests(named, cases_of(named))),
        )
        return plain.digest, given.digest, own.digest

    before = found()
    assert len(set(before)) == 3
    assert found() == before
    (files / "lamp.py").write_text(PLUGIN.format(level=2.0))
    after = found()
    assert [one == other for one, other in zip(before, after, strict=True)] == [True, False, False]


def test_the_option_of_the_command(files, command, capsys):  # noqa: F811
    write(SCENARIO)
    assert command("drive.yaml", "-j1") == 1
    assert command("drive.yaml", "-j1", "--plugin", "lamp.py") == 0
    assert [case["status"] for case in results()] == ["passed", "passed"]
    # What passed with the same plugin is not run again.
    capsys.readouterr()
    assert command("drive.yaml", "-j1", "--plugin", "lamp.py", "--resume") == 0
    assert "2 cases passed in an earlier run" in capsys.readouterr().err
    Path("lamp.py").write_text(PLUGIN.format(level=2.0))
    assert command("drive.yaml", "-j1", "--plugin", "lamp.py", "--resume") == 1
    assert [case["status"] for case in results()] == ["failed", "failed"]
    assert command("drive.yaml", "--plugin", "missing.py") == 2


def test_errors_are_counted_apart_from_failures(files, command, capsys):  # noqa: F811
    write(with_plugins(SCENARIO))
    assert command("drive.yaml", "-j1") == 1
    assert "0 passed, 2 errors" in capsys.readouterr().out
