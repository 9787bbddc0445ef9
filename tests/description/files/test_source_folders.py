"""The folders of a project that people write."""

from cartwheel.description.files.source_folders import source_folders


def test_hidden_folders_and_those_of_tools_are_skipped(tmp_path):
    folders = ("b/build", "b/inner", "a", ".git", "install/a", "log", "node_modules", "__pycache__")
    for name in folders:
        (tmp_path / name).mkdir(parents=True)
        for file in ("two", "one", ".hidden"):
            (tmp_path / name / file).touch()
    (tmp_path / "a" / "COLCON_IGNORE").touch()
    walked = [(str(here.relative_to(tmp_path)), names) for here, names in source_folders(tmp_path)]
    files = [".hidden", "one", "two"]
    a = ("a", [".hidden", "COLCON_IGNORE", "one", "two"])
    assert walked == [(".", []), a, ("b", []), ("b/inner", files)]
    marked = source_folders(tmp_path, markers=("COLCON_IGNORE",))
    assert [here.name for here, _ in marked] == [tmp_path.name, "b", "inner"]


def test_the_folder_itself_may_have_any_name(tmp_path):
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "cart.urdf").touch()
    assert list(source_folders(tmp_path / "build")) == [(tmp_path / "build", ["cart.urdf"])]
