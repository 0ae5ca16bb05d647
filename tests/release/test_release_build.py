"""What is handed out: built twice alike, small, licensed, described, and started as a client starts it."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import zipfile
from typing import TYPE_CHECKING

import pytest
from npm_tools import npm_tool
from places import REPO
from running import Wire

from release.build import build_twice, epoch
from release.bundle_file import write_bundle

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that `make dist` writes."""
    folder = tmp_path_factory.mktemp("dist")
    done = subprocess.run(
        [sys.executable, "-m", "release", "--output", str(folder)],
        cwd=REPO,
        capture_output=True,
        text=True,
        check=False,
    )
    if "make dist needs a clone" in done.stderr:
        pytest.skip("this is no clone")
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def bundle(built: Path) -> Path:
    (path,) = built.glob("*.mcpb")
    return path


def only(folder: Path, pattern: str) -> Path:
    (path,) = folder.glob(pattern)
    return path


def test_the_checksums_are_those_of_the_files(built: Path) -> None:
    rows = [line.split("  ") for line in (built / "SHA256SUMS").read_text().splitlines()]
    assert {name for _, name in rows} == {path.name for path in built.iterdir()} - {"SHA256SUMS"}
    assert [digest for digest, _ in rows] == [
        hashlib.sha256((built / name).read_bytes()).hexdigest() for _, name in rows
    ]


def test_another_build_gives_the_same_bytes(built: Path, tmp_path: Path) -> None:
    wheel, sdist = build_twice(REPO, tmp_path)
    assert wheel.read_bytes() == (built / wheel.name).read_bytes()
    assert sdist.read_bytes() == (built / sdist.name).read_bytes()
    target = tmp_path / "again.mcpb"
    write_bundle(wheel, "0.1.0", target, epoch(REPO))
    assert target.read_bytes() == only(built, "*.mcpb").read_bytes()


def test_the_wheel_is_small_and_does_not_bring_blender(built: Path) -> None:
    wheel = only(built, "*.whl")
    assert wheel.stat().st_size <= 15_000_000
    with zipfile.ZipFile(wheel) as archive:
        facts = archive.read(next(name for name in archive.namelist() if name.endswith("/METADATA"))).decode()
    rows = [line for line in facts.splitlines() if line.startswith("Requires-Dist: bpy")]
    assert len(rows) == 1
    assert "extra == 'blender'" in rows[0]
    assert "License-Expression: GPL-3.0-or-later" in facts


def test_the_bill_names_every_dependency_and_is_of_this_wheel(built: Path) -> None:
    bill = json.loads(only(built, "*.cdx.json").read_text())
    own = bill["metadata"]["component"]
    assert own["hashes"][0]["content"] == hashlib.sha256(only(built, "*.whl").read_bytes()).hexdigest()
    names = {row["name"] for row in bill["components"]}
    assert {"mcp", "numpy", "bpy", "pydantic-core"} <= names
    assert not names & {"pytest", "ruff", "pyright"}
    references = {row["bom-ref"] for row in bill["components"]} | {own["bom-ref"]}
    used = {name for row in bill["dependencies"] for name in (row["ref"], *row["dependsOn"])}
    assert used == references


def test_the_bill_is_valid_cyclonedx(built: Path) -> None:
    validation = pytest.importorskip(
        "cyclonedx.validation.json", reason="cyclonedx-python-lib[json-validation] is not installed"
    )
    schema = pytest.importorskip("cyclonedx.schema")
    validator = validation.JsonStrictValidator(schema.SchemaVersion.V1_6)
    assert validator.validate_str(only(built, "*.cdx.json").read_text()) is None


def test_the_requirements_are_pinned_hashed_and_without_tools(built: Path) -> None:
    text = (built / "requirements.txt").read_text()
    rows = [row for row in text.replace("\\\n", " ").splitlines() if row.strip()]
    assert all("==" in row and "--hash=sha256:" in row for row in rows)
    names = {row.partition("==")[0] for row in rows}
    assert {"mcp", "bpy"} <= names
    assert not names & {"pytest", "ray", "openai"}


def test_the_bundle_starts_as_a_client_starts_it(bundle: Path, tmp_path: Path) -> None:
    """Its entry point over its own wheel; only uv's installing is left out."""
    with zipfile.ZipFile(bundle) as archive:
        archive.extractall(tmp_path / "bundle")
    manifest = json.loads((tmp_path / "bundle" / "manifest.json").read_text())
    with zipfile.ZipFile(only(tmp_path / "bundle", "*.whl")) as archive:
        archive.extractall(tmp_path / "installed")
    wire = Wire(
        [sys.executable, str(tmp_path / "bundle" / manifest["server"]["entry_point"])],
        tmp_path / "home",
        PYTHONPATH=str(tmp_path / "installed"),
        SIMWORLDS_BASE_URL="",
    )
    with wire.process:
        assert wire.shake_hands()["serverInfo"]["name"] == "simworlds"
        tools = wire.call("tools/list")["result"]["tools"]
        assert [tool["name"] for tool in tools] == [row["name"] for row in manifest["tools"]]
        wire.close()


@pytest.mark.npm
def test_the_bundle_is_one_by_its_own_validator(bundle: Path, tmp_path: Path) -> None:
    tool = npm_tool("mcpb")
    for words in (
        ["unpack", str(bundle), str(tmp_path / "u")],
        ["validate", str(tmp_path / "u" / "manifest.json")],
    ):
        done = subprocess.run([tool, *words], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    packed = tmp_path / "packed.mcpb"
    done = subprocess.run([tool, "pack", str(tmp_path / "u"), str(packed)], capture_output=True, check=False)
    assert done.returncode == 0
    with zipfile.ZipFile(packed) as theirs, zipfile.ZipFile(bundle) as ours:
        assert {name: theirs.read(name) for name in theirs.namelist()} == {
            name: ours.read(name) for name in ours.namelist()
        }
