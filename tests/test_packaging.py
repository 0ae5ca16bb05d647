"""What is committed can be handed to anyone: small, pinned, and without anyone's addresses."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
import zipfile
from typing import TYPE_CHECKING

import pytest
from packaging.requirements import Requirement
from places import REPO

if TYPE_CHECKING:
    from pathlib import Path

LARGEST = 2_000_000
# Put together here, since this file is searched too.
INDEX_HOSTS = (
    "pypi" + ".org",
    "python" + "hosted.org",
    "npm" + "js.org",
    "ana" + "conda.org",
    "py" + "pi/simple",
)


def committed() -> list[Path]:
    done = subprocess.run(["git", "ls-files", "-z"], cwd=REPO, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        pytest.skip("this is no clone")
    return [
        path
        for name in done.stdout.split("\0")
        if name and ((path := REPO / name).is_file() or path.is_symlink())
    ]


def project() -> dict[str, object]:
    return tomllib.loads((REPO / "pyproject.toml").read_text(encoding="utf-8"))


def locked() -> dict[str, tuple[str, int]]:
    """Package name → its pinned requirement, and how many hashes it has."""
    text = (REPO / "requirements.lock").read_text(encoding="utf-8").replace("\\\n", " ")
    rows = [line.split("--hash=") for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return {normal(Requirement(row[0]).name): (row[0], len(row) - 1) for row in rows}


def normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def test_no_committed_file_names_a_package_index() -> None:
    named = [
        f"{path.relative_to(REPO)}: {host}"
        for path in committed()
        for host in INDEX_HOSTS
        if host.encode() in path.read_bytes()
    ]
    assert named == []


def test_no_committed_file_is_large() -> None:
    large = {str(path.relative_to(REPO)): path.stat().st_size for path in committed()}
    assert {name: size for name, size in large.items() if size > LARGEST} == {}


def test_no_link_is_committed() -> None:
    assert [str(path) for path in committed() if path.is_symlink()] == []


def test_no_committed_file_names_a_place_on_somebodys_machine() -> None:
    places = (b"/" + b"root/", b"/" + b"work/", b"/" + b"home/")
    named = [
        f"{path.relative_to(REPO)}: {place.decode()}"
        for path in committed()
        for place in places
        if path.suffix in {".py", ".toml", ".lock", ".md", ""} and path.name != "LICENSE"
        if re.search(rb"(?<![\w.])" + re.escape(place), path.read_bytes())
    ]
    assert named == []


def test_every_pinned_requirement_has_its_hashes() -> None:
    rows = locked()
    assert len(rows) > 50
    assert {name for name, (_, hashes) in rows.items() if hashes == 0} == set()
    assert {name for name, (requirement, _) in rows.items() if "==" not in requirement} == set()


def test_every_dependency_is_pinned_to_a_version_that_it_allows() -> None:
    data = project()
    wanted = [*data["project"]["dependencies"], *data["dependency-groups"]["dev"]]
    rows = locked()
    faults = []
    for text in wanted:
        requirement = Requirement(text)
        pinned = re.search(r"==([\w.]+)", rows.get(normal(requirement.name), ("", 0))[0])
        if pinned is None:
            faults.append(f"{requirement.name} is not pinned")
        elif requirement.marker is None and not requirement.specifier.contains(pinned[1]):
            faults.append(
                f"{requirement.name} is pinned to {pinned[1]}, which is not {requirement.specifier}"
            )
    assert faults == []


def test_the_wheel_holds_the_packages_the_table_of_sources_and_the_prompts(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(tmp_path)],
        cwd=REPO,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        entry_points = next(name for name in names if name.endswith("entry_points.txt"))
        commands = archive.read(entry_points).decode()
    assert {
        "corpora/sources.toml",
        "kb_build/pages/sources.py",
        "kb_build/blender/inside/extract_api.py",
    } <= names
    texts = {path.relative_to(REPO).as_posix() for path in (REPO / "agents").rglob("prompts/**/*.md")}
    assert "agents/roles/prompts/stages/modeling.md" in texts
    assert texts <= names
    scenes = {path.relative_to(REPO).as_posix() for path in (REPO / "bench" / "scenes").glob("*.yaml")}
    assert scenes | {"bench/commands/bench.py", "bench/audit/inside/serve.py"} <= names
    tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
    assert tops == {"agents", "bench", "corpora", "kb_build", "kb_check", "kb_serve", "simworlds"}
    assert not [name for name in names if name.startswith("corpora/queries/")]
    assert "simworlds = simworlds.cli:main" in commands
