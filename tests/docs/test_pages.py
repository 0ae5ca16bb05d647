"""The generated references agree with what they describe."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import fields
from os.path import normpath
from pathlib import Path

import pytest
from places import REPO

from agents.blender.checks import plan_check
from agents.blender.server import Suite, first_profiles
from agents.blender.team import PROMPTS, Team
from agents.blender.tool_catalogue import FOR_CLIENTS, TOOLS
from agents.protocol.rules.catalogue import RULES
from agents.protocol.tolerances import TOLERANCES
from docs.generate.pages import outdated, pages, write
from kb_check.rule import all_rules
from kb_serve.served_tools import TOOL_NAMES
from kb_serve.tool import DESCRIPTION, tool


def run(*options: str) -> subprocess.CompletedProcess[str]:
    """The command, in a process of its own: click caches the help of a command with the settings of its first use."""
    command = [sys.executable, "-m", "docs.generate", *options]
    return subprocess.run(command, cwd=REPO, capture_output=True, text=True, check=False)


def check(folder: Path) -> subprocess.CompletedProcess[str]:
    return run("--check", "--folder", str(folder))


@pytest.mark.slow
def test_written_pages_are_up_to_date(tmp_path: Path) -> None:
    for done in (run("--folder", str(tmp_path)), check(tmp_path)):
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.slow
def test_changed_and_missing_pages_are_named(tmp_path: Path) -> None:
    absent = outdated(tmp_path)
    assert absent[:6] == [
        "blender-tools.md",
        "cli.md",
        "predicates.md",
        "relations.md",
        "tools.md",
        "rules.md",
    ]
    assert absent[6:] == [
        *(f"rules/{rule.id}.md" for rule in RULES),
        "check-rules.md",
        *(f"check/{rule}.md" for rule in all_rules()),
    ]
    write(tmp_path)
    with (tmp_path / "cli.md").open("a") as file:
        file.write("edited by hand\n")
    done = check(tmp_path)
    assert done.returncode == 1
    assert "cli.md" in done.stderr
    assert "tools.md" not in done.stderr
    assert "make docs" in done.stderr


def test_every_command_has_its_help() -> None:
    text = pages()["cli.md"]
    for command in (
        "simworlds",
        "simworlds kb build",
        "simworlds kb info",
        "simworlds docs",
        "simworlds serve",
    ):
        assert f"## `{command}`" in text
        assert f"Usage: {command} " in text


def test_the_tool_has_its_description_arguments_and_result() -> None:
    text = pages()["tools.md"]
    entry = tool()
    assert DESCRIPTION in text
    assert entry.output_schema is not None
    for name in (*entry.input_schema["properties"], *entry.output_schema["properties"]):
        assert f"| `{name}` |" in text


def test_every_tool_of_the_suite_has_its_description_and_arguments() -> None:
    text = pages()["blender-tools.md"]
    for entry in (*TOOLS, *FOR_CLIENTS):
        assert f"## `{entry.name}`" in text
        assert entry.description in text
        for name in entry.arguments.model_json_schema().get("properties", ()):  # what clients are told of
            assert f"| `{name}` |" in text


def test_the_profiles_list_every_tool_and_count_them() -> None:
    text = pages()["blender-tools.md"].partition("## Profiles")[2].partition("\n## ")[0]
    everywhere = [*TOOL_NAMES, *(entry.name for entry in (*TOOLS, *FOR_CLIENTS)), plan_check.NAME]
    for name in everywhere:
        assert f"`{name}`" in text
    assert f"| `all` | {len(everywhere)} | `blender_tag_object`, `blender_import`, `blender_export` |" in text


def test_the_readme_says_which_tools_are_only_in_the_largest_profile() -> None:
    readme = (REPO / "README.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in readme.splitlines() if line.startswith("| `blender_")]
    named = {name: "--tools all" in row for row in rows for name in re.findall(r"`(blender_\w+)`", row)}
    previews = {"blender_scene_layout_preview"}  # whose other sizes stand abbreviated beside it
    first = first_profiles(Suite((*TOOLS, *FOR_CLIENTS)), Team())
    for name in (*(entry.name for entry in (*TOOLS, *FOR_CLIENTS)), plan_check.NAME):
        if not name.endswith(("_layout_preview", "_object_preview", "_mesh_preview")) or name in previews:
            assert named[name] is (first[name] == "all"), name


@pytest.mark.parametrize("page", ["index.md", "for-researchers.md"])
def test_pages_by_hand_have_the_number_of_rules(page: str) -> None:
    assert f"{len(RULES)} rules" in (REPO / "docs" / page).read_text(encoding="utf-8")


def test_the_plan_check_and_the_prompts_have_sections() -> None:
    text = pages()["blender-tools.md"]
    assert f"## `{plan_check.NAME}`\n\n{plan_check.DESCRIPTION}" in text
    assert "\nScenePlan {" in text
    for prompt in PROMPTS:
        section = text.partition(f"## `{prompt.name}`")[2].partition("\n## ")[0]
        assert prompt.description in section
        for argument in prompt.arguments:
            assert f"| `{argument.name}` | {'required' if argument.required else 'optional'} |" in section


def test_every_rule_has_a_page_with_all_its_texts() -> None:
    texts = pages()
    for rule in RULES:
        text = texts[f"rules/{rule.id}.md"]
        assert text.startswith(f"# {rule.id} {rule.name}\n")
        for part in (rule.about, rule.why, rule.fix, f"]({rule.id}.png)"):
            assert part in text
        for name in rule.tolerances:
            assert f"| `{name}` |" in text
        assert ("needs a plan" in text) is rule.needs_plan
        assert f"| [{rule.id} {rule.name}](rules/{rule.id}.md) |" in texts["rules.md"]


def test_the_index_has_every_tolerance_with_its_value() -> None:
    text = pages()["rules.md"]
    for field in fields(TOLERANCES):
        assert f"| `{field.name}` |" in text
    assert "| `contact` | 2 mm |" in text
    assert "| `dimension_share` | 10 % |" in text
    assert "| `turn` | 5° |" in text


def test_modules_that_the_pages_name_are_there() -> None:
    modules = "\n".join(f"/{path.relative_to(REPO)}" for path in REPO.glob("[a-z]*/**/*.py"))
    named = {
        (page.name, path)
        for page in (REPO / "docs").glob("*.md")
        for path in re.findall(r"`([a-z_./]+/[a-z_]+\.py)`", page.read_text())
    }
    assert len(named) > 50
    assert {(page, path) for page, path in named if f"/{path}\n" not in f"{modules}\n"} == set()


def test_links_of_the_rules_pages_lead_to_pages() -> None:
    texts = pages()
    for name, text in texts.items():
        if name.startswith("rules"):
            for target in re.findall(r"\]\(([^)#]+\.md)\)", text):
                assert normpath(Path(name).parent / target) in texts, (name, target)


@pytest.mark.slow
def test_the_page_of_a_removed_rule_is_outdated_and_removed(tmp_path: Path) -> None:
    write(tmp_path)
    (tmp_path / "rules" / "X1.md").write_text("# X1\n")
    (tmp_path / "rules" / "C1.png").write_bytes(b"")  # pictures are not compared
    assert outdated(tmp_path) == ["rules/X1.md"]
    write(tmp_path)
    assert outdated(tmp_path) == []
    assert (tmp_path / "rules" / "C1.png").exists()


def test_pages_do_not_depend_on_where_they_are_generated() -> None:
    for text in pages().values():
        assert str(REPO) not in text
        assert str(Path.home()) not in text
