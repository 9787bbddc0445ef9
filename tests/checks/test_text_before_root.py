"""Text before the root element of an SDF file."""

from pathlib import Path

from cartwheel.checks import check
from cartwheel.codes.tags import TAG_IGNORED
from cartwheel.description import load

BOX = '<sdf version="1.6"><model name="m"><link name="a"/></model></sdf>'
WORLD = '<sdf version="1.6"><world name="w"><include><uri>model://box</uri></include></world></sdf>'
HEAD = '?xml version="1.0"?>\n'


def test_it_is_reported_by_check_and_when_the_model_is_loaded_also_from_a_world(tmp_path: Path):
    folder = tmp_path / "box"
    folder.mkdir()
    (folder / "model.config").write_text(
        '<model><name>box</name><sdf version="1.6">model.sdf</sdf></model>'
    )
    (folder / "model.sdf").write_text(HEAD + BOX)
    (tmp_path / "a.world").write_text(WORLD)
    for path in (folder / "model.sdf", tmp_path / "a.world"):
        for found in (check(path).findings, load(path).diagnostics):
            (each,) = [each for each in found if each.code is TAG_IGNORED]
            assert each.severity == "warning"
            assert (Path(each.origin.file).name, each.origin.line) == ("model.sdf", 1)
