"""Each mutation makes documents that differ from the original in one place."""

import pytest
from benchmarks.check import KINDS, SITES, bases
from benchmarks.mutations import documents, swap_letters, written
from lxml import etree

from cartwheel.codes import code_named

FAULTS = [each for module in KINDS.values() for each in module.FAULTS]
HARMLESS = [each for module in KINDS.values() for each in module.HARMLESS]
CASES = {
    each.name: (kind, each)
    for kind, module in KINDS.items()
    for each in (*module.FAULTS, *module.HARMLESS)
}


@pytest.fixture(scope="module")
def robots():
    return {kind: bases(kind) for kind in KINDS}


@pytest.mark.parametrize(("kind", "mutation"), CASES.values(), ids=CASES)
def test_a_mutation_changes_a_robot(robots, kind, mutation):
    changed = 0
    for text in robots[kind].values():
        before = written(etree.fromstring(text.encode()))
        made = list(documents(text, mutation, SITES))
        assert len(made) <= SITES
        assert len(set(made)) == len(made)
        assert before not in made or mutation.name.endswith("written anew")
        changed += len(made)
    assert changed


def test_each_fault_expects_a_code_of_the_catalogue():
    names = [mutation.name for mutation in FAULTS]
    assert len(set(names)) == len(names)
    for mutation in FAULTS:
        assert code_named(mutation.code)
        assert all(code_named(name) for name in mutation.follows)
    assert not any(mutation.code for mutation in HARMLESS)


@pytest.mark.parametrize(
    ("word", "wrong"), [("wheel", "wehel"), ("mu1", "um1"), ("aa", "aax"), ("a-b", "a-bx")]
)
def test_two_letters_are_swapped(word, wrong):
    assert swap_letters(word) == wrong
