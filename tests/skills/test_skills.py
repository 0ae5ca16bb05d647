"""The skills: their form, their names of tools, and that every supported Blender has every name in them."""

from __future__ import annotations

import re
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
import yaml
from places import REPO

from agents.blender.checks.plan_check import NAME as PLAN_CHECK
from agents.blender.server import Suite, first_profiles
from agents.blender.team import Team
from agents.blender.tool_catalogue import BY_NAME
from agents.blender.tool_profiles import DEFAULT, is_within
from agents.plan.part import STAGES
from agents.protocol.rules.catalogue import RULES
from agents.protocol.verify_request import plan_from
from kb_build.usage.examples import uses_in
from kb_build.versions.history import ApiHistory
from kb_check.checker import Checker
from kb_serve.served_tools import TOOL_NAMES

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SKILLS = sorted((REPO / "plugin" / "skills").glob("*/SKILL.md"))
SUPPORTED = ("4.2", "4.3", "4.4", "4.5", "5.0", "5.1", "5.2", "5.3")
FIRST = first_profiles(Suite(tuple(BY_NAME.values())), Team())
TOOLS = {*BY_NAME, *TOOL_NAMES, PLAN_CHECK}
FENCED = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
INLINE = re.compile(r"`([^`\n]+)`")

every_skill = pytest.mark.parametrize("path", SKILLS, ids=lambda path: path.parent.name)


@pytest.fixture(scope="module")
def checker(base: Path) -> Iterator[Checker]:
    with closing(Checker(base)) as opened:
        yield opened


@pytest.fixture(scope="module")
def history() -> ApiHistory:
    return ApiHistory.load()


def front_matter(path: Path) -> dict[str, str]:
    _, head, _ = path.read_text(encoding="utf-8").split("---\n", 2)
    return yaml.safe_load(head)


def blocks(path: Path, language: str) -> list[str]:
    found = [code for kind, code in FENCED.findall(path.read_text(encoding="utf-8")) if kind == language]
    assert found, f"{path} has no code in {language}"
    return found


def prose(path: Path) -> str:
    return FENCED.sub("", path.read_text(encoding="utf-8"))


def test_the_skills_are_there() -> None:
    assert [path.parent.name for path in SKILLS] == ["blender-api", "simulated-scene", "verify-scene"]


@every_skill
def test_the_form_is_what_clients_read(path: Path) -> None:
    head = front_matter(path)
    assert set(head) == {"name", "description"}
    assert head["name"] == path.parent.name
    assert re.fullmatch(r"[a-z0-9-]{1,64}", head["name"])
    assert 100 < len(head["description"]) <= 1024
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 500


@every_skill
def test_tools_rules_and_stages_are_called_by_their_names(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    named = {name.rstrip("_") for name in re.findall(r"\bblender_\w+", text)}
    assert named
    assert named <= TOOLS
    assert all(is_within(FIRST[name], DEFAULT) for name in named)
    rules = set(re.findall(r"\b[CGVWRT]\d+\b", prose(path)))
    assert rules <= {rule.id for rule in RULES}
    if path.parent.name == "simulated-scene":
        table = text.partition("## 2.")[2].partition("For each")[0]
        assert tuple(re.findall(r"^\| (\w+) \|", table, re.MULTILINE)[1:]) == STAGES


@every_skill
def test_code_has_nothing_that_a_blender_lacks(path: Path, checker: Checker) -> None:
    for code in blocks(path, "python"):
        assert [finding.message for finding in checker.check(code)] == []


@every_skill
def test_what_code_uses_is_in_every_supported_version(
    path: Path, checker: Checker, history: ApiHistory
) -> None:
    for code in blocks(path, "python"):
        used = uses_in(code, path.name, checker.api, checker.version)
        assert len(used) > 3
        for name in used:
            absent = [version for version in SUPPORTED if history.exists(name, version) is False]
            assert not absent, f"{name} is not in {absent}"


@every_skill
def test_names_in_the_text_are_in_every_supported_version(
    path: Path, checker: Checker, history: ApiHistory
) -> None:
    for said in INLINE.findall(prose(path)):
        name = said.partition("(")[0]
        is_path = re.fullmatch(r"bpy\.(types|ops|data|context|path|utils)\.[\w.]+", name)
        is_member = re.fullmatch(r"[A-Z][a-z]\w+\.[a-z_]\w*", name)
        is_node = re.fullmatch(r"(Shader|Compositor|Geometry)Node\w+", name)
        if is_path:
            assert checker.check(f"import bpy\nprint({name})") == [], name
        if not (is_member or is_node or name.startswith(("bpy.types.", "bpy.ops."))):
            continue
        path_of = name if name.startswith("bpy.") else f"bpy.types.{name}"
        assert [version for version in SUPPORTED if history.exists(path_of, version) is not True] == [], name


def test_the_plan_in_the_skill_is_valid() -> None:
    (plan,) = blocks(REPO / "plugin" / "skills" / "simulated-scene" / "SKILL.md", "json")
    found, faults = plan_from(plan.encode())
    assert faults == []
    assert found is not None
