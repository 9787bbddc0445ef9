"""The errors that a user sees."""

import difflib

from cartwheel.errors import UnknownNameError, likely


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
