"""Every code has a number of its own, in its module's hundred, and an explanation."""

import json
import pickle
import re
import sys
from importlib import resources

import pytest
from tests import launching

from cartwheel import codes, errors
from cartwheel.codes import MODULES, all_codes, code_named, codes_of, explanation
from cartwheel.errors import Code, DescriptionError, Origin, UnknownNameError

SENTENCE_START = re.compile(r"[A-Z`<*]")


def test_there_are_codes_in_each_module_and_none_twice():
    everything = all_codes()
    assert len({code.number for code in everything}) == len(everything)
    assert len({code.name for code in everything}) == len(everything)


@pytest.mark.parametrize("index, module", list(enumerate(MODULES)), ids=list(MODULES))
def test_numbers_are_of_the_modules_hundred(index, module):
    for code in codes_of(module):
        assert re.fullmatch(rf"CW{index}\d\d", code.number), code
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", code.name), code
        assert code.severity in ("error", "warning", "info"), code
        assert code.summary and not code.summary.endswith("."), code


@pytest.mark.parametrize("module", MODULES)
def test_each_code_is_explained_in_the_order_of_the_numbers(module):
    text = (resources.files(codes) / "texts" / f"{module}.md").read_text()
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert headings == [str(code) for code in codes_of(module)]
    assert text.startswith(f"# {MODULES[module]}\n")


@pytest.mark.parametrize("code", all_codes(), ids=str)
def test_an_explanation_has_a_meaning_a_reason_and_an_example(code):
    text = explanation(code)
    meaning, reason, example = re.split(r"^### (?:Why it matters|Example)\n", text, flags=re.M)
    assert SENTENCE_START.match(meaning), meaning
    assert SENTENCE_START.match(reason.strip()), reason
    assert example.count("```") >= 2 and example.count("```") % 2 == 0, example


def test_a_code_is_found_by_number_and_by_name():
    code = code_named("cw204")
    assert code is code_named("wheel-separation-mismatch") is code_named(str(code))
    with pytest.raises(UnknownNameError) as caught:
        code_named("wheel-seperation-mismatch")
    assert caught.value.code.name == "unknown-code"
    assert caught.value.values["meant"] == "wheel-separation-mismatch"


def test_errors_keep_everything_on_their_way_to_another_process():
    origin = Origin(file="a.urdf", line=3)
    code = Code("CW999", "test", "error", "a test")
    error = DescriptionError(
        "m", code=code, origin=origin, hint="h", values={"name": "x"}, mark="name"
    )
    copied = pickle.loads(pickle.dumps(error))
    assert copied.diagnostic() == error.diagnostic()
    assert copied.values == {"name": "x"} and type(copied) is DescriptionError
    assert "[CW999 test]" in str(copied.diagnostic())
    assert pickle.loads(pickle.dumps(copied.diagnostic())) == error.diagnostic()


def test_the_command_explains_lists_and_writes_json():
    def run(*words):
        command = [sys.executable, "-m", "cartwheel", "explain", *words]
        return launching.run(command, check=False, capture_output=True, text=True)

    code = code_named("CW204")
    assert run("wheel-separation-mismatch").stdout.startswith(f"# {code}\n\n{explanation(code)}")
    listed = run().stdout
    assert all(each.number in listed and each.summary in listed for each in all_codes())
    (entry,) = json.loads(run("CW204", "--json").stdout)
    assert entry["text"] == explanation(code) and entry["severity"] == "warning"
    wrong = run("CW2044")
    assert wrong.returncode == 2 and "[CW001 unknown-code]" in wrong.stderr


def test_no_module_holds_more_than_codes_and_all_are_listed():
    folder = resources.files(codes)
    assert {each.name for each in folder.iterdir() if each.name.endswith(".py")} == {
        "__init__.py",
        *(f"{module}.py" for module in MODULES),
    }
    assert errors.UNCLASSIFIED not in all_codes()
