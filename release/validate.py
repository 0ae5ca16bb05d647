"""Asks each artefact's own validator, which npx or uvx fetches: for who is about to release."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import click

_CYCLONEDX = """import sys
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
fault = JsonStrictValidator(SchemaVersion.V1_6).validate_str(open(sys.argv[1]).read())
sys.exit(str(fault) if fault else 0)
"""


@dataclass(frozen=True, slots=True)
class Validation:
    """What is validated, and the command that does it."""

    what: str
    command: tuple[str, ...]


def validations(repo: Path, dist: Path, scratch: Path) -> list[Validation]:
    """All of them. ``scratch``: an empty folder, in which server.json is looked at alone."""
    listing = scratch / "listing"
    listing.mkdir()
    shutil.copyfile(repo / "server.json", listing / "server.json")
    npx = ("npx", "--yes", "--package")
    claude = (*npx, "@anthropic-ai/claude-code", "claude", "plugin", "validate", "--strict")
    mcpb = (*npx, "@anthropic-ai/mcpb", "mcpb")
    cyclonedx = ("uv", "run", "--no-project", "--quiet", "--with", "cyclonedx-python-lib[json-validation]")
    action = ("uvx", "check-jsonschema", "--builtin-schema", "vendor.github-actions")
    return [
        Validation("the registry's entry", ("uvx", "skillsaw", str(listing))),
        Validation("the action", (*action, str(repo / "action.yml"))),
        Validation(
            "the hooks", ("uvx", "pre-commit", "validate-manifest", str(repo / ".pre-commit-hooks.yaml"))
        ),
        Validation(
            "the bill of materials", (*cyclonedx, "python", "-c", _CYCLONEDX, str(_only(dist, "*.cdx.json")))
        ),
        Validation("the wheel and the sdist", ("uvx", "twine", "check", "--strict", *_packages(dist))),
        Validation("the bundle", (*mcpb, "unpack", str(_only(dist, "*.mcpb")), str(scratch / "bundle"))),
        Validation("its manifest", (*mcpb, "validate", str(scratch / "bundle" / "manifest.json"))),
        Validation("the plugin", (*claude, str(repo / "plugin"))),
        Validation("its marketplace", (*claude, str(repo))),
    ]


def validate(repo: Path, dist: Path) -> None:
    """Runs all of them. Raises ClickException if one refuses, or cannot be had."""
    refused: list[str] = []
    with tempfile.TemporaryDirectory(prefix="simworlds-validate-") as scratch:
        for row in validations(repo, dist, Path(scratch)):
            if shutil.which(row.command[0]) is None:
                raise click.ClickException(
                    f"{row.command[0]} is not installed, which {row.what} is validated with."
                )
            done = subprocess.run(row.command, capture_output=True, text=True, check=False)
            click.echo(f"{'ok' if done.returncode == 0 else 'REFUSED':<8} {row.what}")
            if done.returncode:
                refused.append(row.what)
                click.echo(f"{done.stdout.strip()}\n{done.stderr.strip()}", err=True)
    if refused:
        raise click.ClickException(f"Refused: {', '.join(refused)}.")


def _packages(dist: Path) -> tuple[str, str]:
    return str(_only(dist, "*.whl")), str(_only(dist, "*.tar.gz"))


def _only(dist: Path, pattern: str) -> Path:
    found = list(dist.glob(pattern))
    if len(found) != 1:
        raise click.ClickException(f"There is no {pattern} in {dist}. Build it first: make dist")
    return found[0]
