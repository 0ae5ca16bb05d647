"""What registries, editors and agents are told: valid, of this version, and leading to what is there."""

from __future__ import annotations

import base64
import json
import re
import subprocess
import tomllib
from typing import Any
from urllib.parse import parse_qs, unquote, urlsplit

import pytest
import yaml
from npm_tools import npm_tool
from places import REPO

from release.links import NAME, SERVER, cursor_link, vscode_link

VERSION = tomllib.loads((REPO / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]


def read(name: str) -> Any:
    return json.loads((REPO / name).read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "name", ["server.json", "release/bundle/manifest.json", "plugin/.claude-plugin/plugin.json"]
)
def test_each_is_of_this_version(name: str) -> None:
    assert read(name)["version"] == VERSION


def test_the_registry_can_take_the_server() -> None:
    """What the registry checks before its schema, and the schema's bounds for what we use of it."""
    server = read("server.json")
    assert len(server["description"]) <= 100
    assert re.fullmatch(r"[a-zA-Z0-9.-]+/[a-zA-Z0-9._-]+", server["name"])
    (package,) = server["packages"]
    assert (package["registryType"], package["identifier"], package["version"]) == (
        "pypi",
        "simworlds",
        VERSION,
    )
    assert package["transport"] == {"type": "stdio"}
    assert [argument["value"] for argument in package["packageArguments"]] == SERVER["args"][1:]
    readme = (REPO / "README.md").read_text(encoding="utf-8")
    assert f"mcp-name: {server['name']} " in readme, "the registry looks for it on the package's page"


def test_smithery_starts_the_same_server() -> None:
    config = yaml.safe_load((REPO / "smithery.yaml").read_text(encoding="utf-8"))["startCommand"]
    assert config["type"] == "stdio"
    assert set(config["configSchema"]["properties"]) == {"baseUrl", "blender"}
    assert 'command: "uvx"' in config["commandFunction"]
    assert '["simworlds", "serve"]' in config["commandFunction"]
    assert set(config["exampleConfig"]) <= set(config["configSchema"]["properties"])


def test_the_plugin_lies_apart_from_our_packages() -> None:
    """A plugin's folder named agents would be read as agents of Claude Code."""
    (plugin,) = read(".claude-plugin/marketplace.json")["plugins"]
    folder = REPO / plugin["source"]
    assert (folder / ".claude-plugin" / "plugin.json").is_file()
    assert not (folder / "agents").exists()
    assert read("plugin/.mcp.json")["mcpServers"] == {NAME: SERVER}


@pytest.mark.npm
@pytest.mark.parametrize("folder", [".", "plugin"])
def test_the_plugin_and_its_marketplace_are_valid_by_their_own_validator(
    folder: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    tool = npm_tool("claude")
    done = subprocess.run(
        [tool, "plugin", "validate", "--strict", str(REPO / folder)],
        env={"HOME": str(tmp_path_factory.mktemp("home")), "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_links_of_the_editors_hold_the_server() -> None:
    cursor = parse_qs(urlsplit(cursor_link()).query)
    assert cursor["name"] == [NAME]
    assert json.loads(base64.b64decode(cursor["config"][0])) == SERVER
    inner = parse_qs(urlsplit(vscode_link()).query)["url"][0]
    assert inner.startswith("vscode:mcp/install?")
    assert json.loads(unquote(inner.partition("?")[2])) == {"name": NAME, **SERVER}
    for name in ("README.md", "docs/install.md"):
        text = (REPO / name).read_text(encoding="utf-8")
        assert cursor_link() in text, name
        assert vscode_link() in text, name


def test_llms_txt_leads_to_pages_that_are_there() -> None:
    text = (REPO / "llms.txt").read_text(encoding="utf-8")
    assert text.startswith("# SimWorlds\n\n> ")
    links = re.findall(r"\]\(([^)]+)\)", text)
    assert len(links) > 8
    assert [link for link in links if not (REPO / link).is_file()] == []


def test_the_action_runs_commands_that_there_are() -> None:
    action = yaml.safe_load((REPO / "action.yml").read_text(encoding="utf-8"))
    assert action["runs"]["using"] == "composite"
    script = "\n".join(step.get("run", "") for step in action["runs"]["steps"])
    assert "${{" not in script, "inputs reach the shell as variables, never as code"
    assert "--sarif" in script
    assert set(re.findall(r"INPUT_[A-Z_]+", script)) <= {
        name for step in action["runs"]["steps"] for name in step.get("env", {})
    }


def test_the_hooks_name_commands_that_there_are() -> None:
    hooks = yaml.safe_load((REPO / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    assert {hook["id"]: hook["entry"].split()[:2] for hook in hooks} == {
        "simworlds-check": ["simworlds", "check"],
        "simworlds-verify": ["simworlds", "verify"],
    }
