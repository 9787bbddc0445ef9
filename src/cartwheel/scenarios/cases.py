"""Scenarios and their cases: a case for each combination of parameters and each seed."""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import json
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cartwheel
from cartwheel.errors import CartwheelError
from cartwheel.scenarios.document import Document, read
from cartwheel.scenarios.expressions import check_conditions, substituted
from cartwheel.scenarios.fingerprints import Fingerprints
from cartwheel.scenarios.schema import validate

MOST_CASES = 100_000
"""Maximum number of cases of a scenario."""
_RANDOM = ("uniform", "normal", "choice")


@dataclass(frozen=True, slots=True)
class Scenario:
    """A valid scenario file."""

    document: Document
    name: str

    @property
    def file(self) -> Path:
        """The scenario's file."""
        return self.document.path

    @property
    def value(self) -> Mapping[str, Any]:
        """The file's contents, with ``${…}``."""
        found: Mapping[str, Any] = self.document.value
        return found


@dataclass(frozen=True, slots=True)
class Case:
    """A scenario with values for its parameters."""

    id: str
    """Unique among the cases of a run: ``name[speed=0.2,seed=3]``."""
    scenario: int
    """Index of the scenario."""
    parameters: Mapping[str, Any]
    seed: int
    digest: str = field(default="", compare=False)
    """Equal for cases with equal files, parameters and seed."""


def load_scenario(path: Path) -> Scenario:
    """Reads and validates a scenario.

    Raises:
        ScenarioError: The scenario is invalid.
    """
    document = read(path)
    validate(document)
    name = document.value.get("name") or path.name.partition(".")[0]
    return Scenario(document, name)


def cases_of(
    scenario: Scenario, index: int = 0, *, seeds: Sequence[int] | None = None
) -> list[Case]:
    """The cases of a scenario, each with valid values.

    Args:
        scenario: The scenario.
        index: Its index, for the cases.
        seeds: Replace the seeds that the scenario states.

    Raises:
        ScenarioError: A value of a case is invalid, or there are too many cases.
    """
    document, value = scenario.document, scenario.value
    if seeds is None:
        seeds = _seeds(value)
    parameters = value.get("parameters", {})
    listed = {name: _values(each) for name, each in parameters.items() if not _is_random(each)}
    count = len(seeds)
    for values in listed.values():
        count *= len(values)
    if count > MOST_CASES:
        raise document.error(
            ("parameters",),
            f"a scenario can have at most {MOST_CASES:,} cases (got {count:,})",
            hint="List fewer values, or use random values.",
            values={"cases": count, "most": MOST_CASES},
        )
    cases: list[Case] = []
    for number, chosen in enumerate(itertools.product(*listed.values())):
        for seed in seeds:
            given = dict(zip(listed, chosen, strict=True))
            drawn = {
                name: _draw(each, random.Random(f"{seed} {number} {name}"))
                for name, each in parameters.items()
                if _is_random(each)
            }
            case = Case(
                _id(scenario.name, given, seed if len(seeds) > 1 else None),
                index,
                {name: {**given, **drawn}[name] for name in parameters},
                seed,
            )
            if not cases or parameters:
                resolved(scenario, case)
            cases.append(case)
    return cases


def resolved(scenario: Scenario, case: Case) -> dict[str, Any]:
    """The contents of a scenario with the values of a case.

    Raises:
        ScenarioError: An expression cannot be evaluated, or its value is invalid.
    """
    document = scenario.document
    names = {**case.parameters, "seed": case.seed}
    value = {
        key: each if key in ("parameters", "seed", "seeds") else substituted(
            document, each, names, (key,)
        )
        for key, each in scenario.value.items()
    }  # fmt: skip
    validate(Document(document.path, value, document.lines))
    for part in ("steps", "expect"):
        check_conditions(document, value.get(part), (part,))
    if launch := value.get("launch"):
        # Arguments may be parameters.
        words = [xacro_value(each) for each in launch["command"]]
        value["launch"] = {**launch, "command": words}
    return value


def place_of(scenario: Scenario, name: str) -> str | Path:
    """A file that a scenario names: relative to the scenario, or the name of a bundled file."""
    beside = scenario.file.parent / name
    return beside if beside.exists() else name


def digests(
    scenario: Scenario,
    cases: Sequence[Case],
    package_path: Sequence[Path] = (),
    plugins: Sequence[Path] = (),
) -> Iterator[Case]:
    """The cases with their digests. Expands the descriptions of all robots.

    Args:
        scenario: The scenario.
        cases: Its cases.
        package_path: Folders that are searched for packages.
        plugins: Plugin files in addition to those of the scenario.

    Raises:
        DescriptionError: The file of a world or robot cannot be used.
    """
    prints = Fingerprints(package_path)
    known: dict[tuple[str, str], list[str]] = {}

    def of_description(file: str, arguments: Mapping[str, Any]) -> list[str]:
        key = (file, json.dumps(arguments, sort_keys=True))
        if key not in known:
            given = {name: xacro_value(each) for name, each in arguments.items()}
            known[key] = prints.of_description(place_of(scenario, file), given)
        return known[key]

    for case in cases:
        value = resolved(scenario, case)
        parts = {key: each for key, each in value.items() if key not in ("parameters", "seeds")}
        files = [of_description(value.get("world", "empty"), {})]
        others: list[str] = []
        for each in value.get("robots", ()):
            files.append(of_description(each["robot"], each.get("arguments", {})))
            named = each.get("controllers", ())
            others += [named] if isinstance(named, str) else named
        for each in value.get("steps", ()):
            if "spawn" in each:
                # The step reports a file that cannot be used.
                with contextlib.suppress(CartwheelError):
                    files.append(of_description(each["spawn"], each.get("arguments", {})))
        others += value.get("launch", {}).get("command", ())[:1]
        others += value.get("plugins", ())
        if plugins:
            files.append([prints.of_file(each) for each in plugins])
        files.append([prints.of_file(Path(place_of(scenario, each))) for each in others])
        whole = [cartwheel.__version__, case.id, case.seed, parts, files]
        data = json.dumps(whole, sort_keys=True, default=str).encode(errors="surrogatepass")
        yield Case(
            case.id,
            case.scenario,
            case.parameters,
            case.seed,
            hashlib.sha256(data).hexdigest()[:24],
        )


def xacro_value(value: Any) -> str:
    """An argument's value as xacro and ROS expect it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _seeds(value: Mapping[str, Any]) -> list[int]:
    first = value.get("seed", 0)
    seeds = value.get("seeds", 1)
    return list(range(first, first + seeds)) if isinstance(seeds, int) else list(seeds)


def _is_random(rule: Any) -> bool:
    return isinstance(rule, dict) and any(name in rule for name in _RANDOM)


def _values(rule: Any) -> list[Any]:
    if isinstance(rule, list):
        return rule
    first, last, count = rule["from"], rule["to"], rule["count"]
    if count == 1:
        return [first]
    # Without the tails of binary fractions, which would be in the cases' names.
    return [float(f"{first + (last - first) * i / (count - 1):.12g}") for i in range(count)]


def _draw(rule: Mapping[str, Any], source: random.Random) -> Any:
    if "uniform" in rule:
        return source.uniform(*rule["uniform"])
    if "normal" in rule:
        return source.gauss(*rule["normal"])
    return source.choice(rule["choice"])


def _id(name: str, values: Mapping[str, Any], seed: int | None) -> str:
    parts = [f"{key}={_brief(value)}" for key, value in values.items()]
    if seed is not None:
        parts.append(f"seed={seed}")
    return f"{name}[{','.join(parts)}]" if parts else name


def _brief(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False, default=str)
