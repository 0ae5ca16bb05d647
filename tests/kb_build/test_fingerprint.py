"""Fingerprints follow all code that a base is made by."""

from __future__ import annotations

import ast
import re
import shutil
from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_build import fingerprint
from kb_build.imported import source_files

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

PACKAGE = REPO / "kb_build"
DIGESTS = {
    "usage_digest": ("kb_build.usage.usage_index", "kb_build.blender.extract_reader"),
    "reader_digest": ("kb_build.pages.page_cache",),
    "code_digest": ("kb_build.pipeline",),
}


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A copy of the package, which digests are of."""
    copy = tmp_path / "kb_build"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(fingerprint, "_PACKAGE", copy)
    monkeypatch.setattr(fingerprint, "_versions", no_versions)
    yield copy
    forget()


def no_versions(_: Iterable[str]) -> str:
    return ""


def forget() -> None:
    for name in ("extractor_digest", *DIGESTS):
        getattr(fingerprint, name).cache_clear()


def digest(name: str) -> str:
    """The digest of the code as it is now."""
    forget()
    return getattr(fingerprint, name)()


def imported(file: Path) -> Iterator[str]:
    """What a module imports when it runs, as Python's own parser reads it."""
    waiting: list[ast.AST] = [ast.parse(file.read_bytes())]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        waiting += ast.iter_child_nodes(node)
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = file.relative_to(REPO).parts[: -node.level] if node.level else ()
            base = ".".join([*above, *filter(None, [node.module])])
            yield from (base, *(f"{base}.{alias.name}" for alias in node.names))


def file_of(module: str) -> Path | None:
    path = REPO.joinpath(*module.split("."))
    return next((file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()), None)


@pytest.mark.parametrize("name", ["extractor_digest", "code_digest"])
def test_code_in_every_folder_that_runs_inside_blender_counts(package: Path, name: str) -> None:
    before = digest(name)
    assert before == digest(name)
    for file in sorted((package / "blender" / "inside").rglob("*.py")):
        whole = file.read_bytes()
        file.write_bytes(whole + b"# changed\n")
        assert digest(name) != before, file
        file.write_bytes(whole)


@pytest.mark.parametrize("name", DIGESTS)
def test_each_module_that_is_imported_on_the_way_counts(package: Path, name: str) -> None:
    before = digest(name)
    waiting, seen = list(DIGESTS[name]), set[str]()
    while waiting:
        module = waiting.pop()
        source = file_of(module)
        if module in seen or source is None or not module.startswith("kb_build."):
            continue
        seen.add(module)
        waiting += imported(source)
        file = package / source.relative_to(PACKAGE)
        whole = file.read_bytes()
        file.write_bytes(whole + b"# changed\n")
        assert digest(name) != before, module
        file.write_bytes(whole)
    assert digest(name) == before
    assert len(seen) > 10


@pytest.mark.parametrize("name", DIGESTS)
def test_a_module_that_nothing_imports_does_not_count(package: Path, name: str) -> None:
    before = digest(name)
    for folder in {file.parent for file in source_files(DIGESTS[name], PACKAGE)}:
        (package / folder.relative_to(PACKAGE) / "on_its_own.py").write_text(
            "import kb_build.symbols.records\n"
        )
    assert digest(name) == before
    reached = package.parent.joinpath(*DIGESTS[name][0].split(".")).with_suffix(".py")
    reached.write_text(reached.read_text() + "import kb_build.on_its_own\n")
    assert digest(name) != before


def test_modules_that_are_loaded_by_name_are_imported_as_well() -> None:
    files = source_files(["kb_build.pipeline"], PACKAGE)
    for file, content in files.items():
        for module in re.findall(r"""["'](kb_build(?:\.\w+)+)["']""", content.decode()):
            runs_inside = "inside" in module.split(".")
            assert runs_inside or file_of(module) in files, f"{file} names {module}"


@pytest.mark.parametrize(
    "line",
    [
        "import top.b",
        "import os, top.b as c",
        "from top import b",
        "from top import (\n    a,\n    b,  # why\n)",
        "from top.b import x as y",
        "from . import b",
        "from .b import x",
        "def f():\n    from top.b import x",
        "if TYPE_CHECKING:\n    import os\n\nimport top.b",
    ],
)
def test_every_form_of_an_import_is_followed(tmp_path: Path, line: str) -> None:
    package = tmp_path / "top"
    package.mkdir()
    for name, text in (("__init__", ""), ("a", line), ("b", ""), ("c", "")):
        (package / f"{name}.py").write_text(f"{text}\n")
    assert [file.stem for file in source_files(["top.a"], package)] == ["__init__", "a", "b"]


@pytest.mark.parametrize(
    "line", ["import os.b", "from topmost import b", "if TYPE_CHECKING:\n    import top.b\n"]
)
def test_what_is_not_imported_is_not_followed(tmp_path: Path, line: str) -> None:
    package = tmp_path / "top"
    package.mkdir()
    for name, text in (("a", line), ("b", "")):
        (package / f"{name}.py").write_text(f"{text}\n")
    assert [file.stem for file in source_files(["top.a"], package)] == ["a"]
