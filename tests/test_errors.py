"""The errors that a user sees."""

import difflib

from cartwheel.errors import Once, UnknownNameError, likely


def test_a_name_of_megabytes_is_cut_and_compared_with_nothing(monkeypatch):
    compared = []
    find = difflib.get_close_matches

    def count(word, *given, **options):
        compared.append(len(word))
        return find(word, *given, **options)

    monkeypatch.setattr(difflib, "get_close_matches", count)
    error = UnknownNameError("model", "robot" * 1_000_000, ["robot", "post"])
    assert str(error).startswith('model "robotrobot')
    assert len(str(error)) < 1000
    assert "There are: post, robot." in str(error)
    assert likely("robot" * 1_000_000, ["robot"], cutoff=0.0) == ""
    assert 'Did you mean "robot"?' in str(UnknownNameError("model", "robott", ["robot"]))
    assert compared == [len("robott")]


def test_a_flood_of_warnings_is_shown_at_a_bounded_rate_and_counted(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    once = Once(5)
    assert once("a") == "a"
    assert once("a") is None
    shown = [once(f"name {number}") for number in range(100)]
    assert shown[:3] == ["name 0", "name 1", "name 2"]
    assert shown[3] == "name 3 (from now on at most one warning every 10 s is shown)"
    assert shown[4:] == [None] * 96
    now[0] += Once.PAUSE
    assert once("important") == "important (warnings that are not shown: 96)"
    assert once("b") is None
    now[0] += 3 * Once.PAUSE
    assert once("c") == "c (warnings that are not shown: 1)"
    assert once("d") == "d"
