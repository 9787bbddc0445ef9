"""The source files of a library, by the CMakeLists.txt that builds it."""

import itertools
import time

import pytest

from cartwheel.description.files.library_sources import library_sources


def package(folder, lists: str):
    """Writes a package with two source files, whose texts are their names."""
    (folder / "src").mkdir(parents=True)
    (folder / "CMakeLists.txt").write_text(lists)
    for name in ("one.cpp", "two.cpp"):
        (folder / "src" / name).write_text(name)
    return folder


@pytest.mark.parametrize(
    ("lists", "expected"),
    [
        ("add_library(push src/one.cpp src/two.cpp)", ["one.cpp", "two.cpp"]),
        ("add_library(push SHARED ${CMAKE_CURRENT_SOURCE_DIR}/src/one.cpp)", ["one.cpp"]),
        ("project(push)\nament_auto_add_library(${PROJECT_NAME} SHARED src/two.cpp)", ["two.cpp"]),
        ("set(name push)\nadd_library(${name} src/one.cpp)", ["one.cpp"]),
        ("set(all src/one.cpp src/two.cpp)\nadd_library(push ${all})", ["one.cpp", "two.cpp"]),
        ("file(GLOB all src/*.cpp)\nadd_library(push ${all})", ["one.cpp", "two.cpp"]),
        ("add_library(pull src/one.cpp)\nadd_library(push src/two.cpp)", ["two.cpp"]),
        ("# add_library(push src/one.cpp)", []),
        ("add_library(push src/absent.cpp)", []),
        ("add_library(pushing src/one.cpp)", []),
    ],
)  # fmt: skip
def test_a_library_is_found_in_cmake(tmp_path, lists, expected):
    package(tmp_path / "repository" / "packages" / "push", lists)
    assert [*library_sources("push", tmp_path)] == expected


def test_files_outside_of_the_folder_are_not_read(tmp_path):
    (tmp_path / "secret.cpp").write_text("secret")
    folder = package(tmp_path / "own", "add_library(push ../secret.cpp src/link.cpp src/one.cpp)")
    (folder / "src" / "link.cpp").symlink_to(tmp_path / "secret.cpp")
    assert [*library_sources("push", folder)] == ["one.cpp"]


def test_lists_that_double_do_not_grow_without_limit(tmp_path):
    lists = ["set(a src/one.cpp)"]
    lists += ["set(a ${a} ${a})", "set(b ${a}x${a}x)", 'set(c "${b}${b}")'] * 60
    package(tmp_path, "\n".join([*lists, "add_library(push ${a} ${c})"]))
    before = time.process_time()
    assert [*library_sources("push", tmp_path)] == ["one.cpp"]
    assert time.process_time() - before < 2.0


def test_folders_are_listed_only_for_the_library_and_only_in_the_repository(tmp_path):
    folder = package(tmp_path / "own", "")
    lists = "file(GLOB all /usr/lib/*.so ../*.cpp src/*.cpp)\n" * 2000
    (folder / "CMakeLists.txt").write_text(f"{lists}add_library(push ${{all}})")
    (tmp_path / "secret.cpp").write_text("secret")
    before = time.process_time()
    assert [*library_sources("push", folder)] == ["one.cpp", "two.cpp"]
    assert [*library_sources("pull", folder)] == []
    assert time.process_time() - before < 2.0


def test_cmake_is_read_once_for_all_plugins(tmp_path):
    for number in range(20):
        package(tmp_path / f"p{number}", "set(a b c d)\n" * 4000)
    before = time.process_time()
    assert [
        *itertools.chain(*(library_sources(f"push{each}", tmp_path) for each in range(50)))
    ] == []
    assert time.process_time() - before < 5.0
