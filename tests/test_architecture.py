"""Who may import whom. The rules are one table; each is shown to bite on a tree that breaks it."""

from __future__ import annotations

import ast
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from places import REPO

if TYPE_CHECKING:
    from pathlib import Path

PACKAGES = ("kb_build", "kb_serve", "agents", "bench")
BLENDERS_OWN = {
    *(
        "_bpy",
        "_bpy_types",
        "_rna_manual_reference",
        "addon_utils",
        "aud",
        "bl_math",
        "bl_operators",
        "bl_ui",
    ),
    *(
        "blf",
        "bmesh",
        "bpy",
        "bpy_extras",
        "bpy_restrict_state",
        "bpy_types",
        "freestyle",
        "gpu",
        "gpu_extras",
    ),
    *("idprop", "imbuf", "manta", "mathutils", "nodeitems_utils", "rna_manual_reference"),
}


@dataclass(frozen=True)
class Rule:
    """Modules below ``who`` must not import what is below ``what``, unless it is below one of ``unless``."""

    who: str
    what: tuple[str, ...]
    unless: tuple[str, ...] = ()


RULES = (
    Rule("kb_build.records", PACKAGES),
    # How text is cut into words belongs to the store's schema: index and query must agree on it.
    Rule("kb_build.index.analysis", PACKAGES),
    Rule("kb_build", ("kb_serve", "agents", "bench")),
    Rule(
        "kb_serve",
        ("kb_build", "agents", "bench"),
        # What a base holds (records, schema, analysis, lines), where it lies (settings), and one way to make it.
        (
            "kb_build.records",
            "kb_build.schema",
            "kb_build.index.analysis",
            "kb_build.symbol_lines",
            "simworlds.settings",
            "kb_build.pipeline",
        ),
    ),
    Rule(
        "agents",
        ("kb_build", "kb_serve", "bench"),
        # The command mounts theirs, the references describe them; which Blender to start is known in one place.
        (
            "simworlds.cli:kb_build",
            "simworlds.cli:kb_serve",
            "docs.generate.references:kb_serve",
            "simworlds.sandbox.launch:kb_build",
            # How any MCP server is carried over stdio and HTTP, who is let in, and how it tells its tools' arguments:
            # nothing of the base.
            "simworlds.schema_notation:simworlds.mcp_transport.schemas",
            "agents.blender.server:simworlds.mcp_transport.schemas",
            "agents.commands.mcp:simworlds.mcp_transport.http",
            "agents.commands.mcp:simworlds.mcp_transport.stdio",
        ),
    ),
    Rule("agents.plan", ("simworlds.llm", "agents.blender", "agents.roles", "agents.loop")),
    Rule("agents.protocol", ("simworlds.llm", "agents.blender", "agents.roles", "agents.loop")),
    Rule("bench", ("agents.protocol",)),
)


def below(name: str, top: str) -> bool:
    return name == top or name.startswith(top + ".")


def module_name(path: Path, repo: Path) -> str:
    parts = path.relative_to(repo).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(tree: ast.AST, module: str, *, is_package: bool) -> set[str]:
    """Every module that ``tree`` names in an import, wherever it stands; relative ones in full."""
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = module.split(".") if is_package else module.split(".")[:-1]
                base = ".".join([*parts[: len(parts) - node.level + 1], *filter(None, [base])])
            found.update([base, *(f"{base}.{alias.name}" for alias in node.names)])
    return found


def modules(repo: Path) -> dict[str, tuple[Path, ast.Module]]:
    paths = [path for package in PACKAGES for path in sorted((repo / package).rglob("*.py"))]
    return {module_name(path, repo): (path, ast.parse(path.read_bytes())) for path in paths}


def breaches_of_rules(module: str, imported: set[str]) -> list[str]:
    found: list[str] = []
    for rule in RULES:
        if not below(module, rule.who):
            continue
        for name in sorted(imported):
            forbidden = any(below(name, what) for what in rule.what)
            excused = any(below(f"{module}:{name}", item) or below(name, item) for item in rule.unless)
            excused = excused or any(item.startswith(f"{name}.") for item in rule.unless)
            if forbidden and not excused:
                found.append(f"{module} imports {name}")
    return found


def inside_folders(path: Path) -> list[Path]:
    """Its own, and those of the packages around it: the parts of one package share what they know of Blender."""
    around = [parent / "inside" for parent in path.parent.parent.parents if parent.name in PACKAGES]
    return [path.parent, *(folder for folder in around if folder.is_dir())]


def breaches_inside(module: str, path: Path, imported: set[str]) -> list[str]:
    """What runs in Blender knows Blender, the standard library and its neighbours; nobody else knows bpy."""
    if "inside" not in module.split("."):
        return [f"{module} imports {name}" for name in sorted(imported) if name.split(".")[0] in BLENDERS_OWN]
    siblings = {neighbour.stem for folder in inside_folders(path) for neighbour in folder.glob("*.py")}
    allowed = BLENDERS_OWN | siblings | set(sys.stdlib_module_names) | {""}
    if not below(module, "kb_build"):  # every Blender that scenes are built or judged in brings it
        allowed |= {"numpy", "zstandard"}
    return [f"{module} imports {name}" for name in sorted(imported) if name.split(".")[0] not in allowed]


def breaches_between_roles(module: str, imported: set[str]) -> list[str]:
    parts = module.split(".")
    if parts[:2] != ["agents", "roles"] or len(parts) < 3:
        return []
    others = (
        name for name in sorted(imported) if name.startswith("agents.roles.") and not below(name, module)
    )
    shared = ("agents.roles.base", "agents.roles.prompts")
    return [f"{module} imports {name}" for name in others if not any(below(name, item) for item in shared)]


def breaches(repo: Path) -> list[str]:
    found: list[str] = []
    for module, (path, tree) in modules(repo).items():
        imported = imports_of(tree, module, is_package=path.name == "__init__.py")
        found += breaches_of_rules(module, imported)
        found += breaches_inside(module, path, imported)
        found += breaches_between_roles(module, imported)
    return found


def rebuilders(repo: Path) -> list[str]:
    """The server's functions that import the build: ``module.function``, or the module if outside of any."""
    found: list[str] = []
    for module, (_, tree) in modules(repo).items():
        if not below(module, "kb_serve"):
            continue
        scopes = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
        whole = imports_of(tree, module, is_package=False)
        named = [s.name for s in scopes if "kb_build.pipeline" in imports_of(s, module, is_package=False)]
        if "kb_build.pipeline" in whole:
            found += [f"{module}.{name}" for name in named] or [module]
    return found


def test_nobody_imports_what_is_not_theirs() -> None:
    assert breaches(REPO) == []


def test_the_tree_that_is_checked_is_the_real_one() -> None:
    names = set(modules(REPO))
    assert {"kb_build.records", "kb_serve", "agents", "bench", "kb_build.inside.extract"} <= names


def test_the_server_reaches_the_build_through_one_function_at_most() -> None:
    found = rebuilders(REPO)
    assert len(found) <= 1, found
    assert not [name for name in found if name in modules(REPO)], "the import belongs into the function"


@pytest.mark.parametrize(
    ("path", "code", "breach"),
    [
        ("kb_build/records.py", "import kb_build.errors", "kb_build.records imports kb_build.errors"),
        ("kb_build/store.py", "from kb_serve.reader import read", "kb_build.store imports kb_serve.reader"),
        ("kb_build/store.py", "def f():\n    import bpy", "kb_build.store imports bpy"),
        (
            "kb_serve/rank/search.py",
            "from kb_build.store import write",
            "kb_serve.rank.search imports kb_build.store",
        ),
        (
            "kb_serve/rank/search.py",
            "from kb_build import store",
            "kb_serve.rank.search imports kb_build.store",
        ),
        ("kb_serve/deep/a.py", "from ..x import y\nimport agents", "kb_serve.deep.a imports agents"),
        ("agents/loop.py", "from kb_serve import knowledge_base", "agents.loop imports kb_serve"),
        ("agents/plan/scene.py", "from ..models import claude", "agents.plan.scene imports simworlds.llm"),
        (
            "agents/protocol/a.py",
            "import agents.blender.wire",
            "agents.protocol.a imports agents.blender.wire",
        ),
        (
            "agents/roles/coder.py",
            "from .planner import plan",
            "agents.roles.coder imports agents.roles.planner",
        ),
        (
            "bench/audit/audit.py",
            "import agents.protocol.facts",
            "bench.audit.audit imports agents.protocol.facts",
        ),
        ("simworlds/cli.py", "import bench", "simworlds.cli imports bench"),
        ("kb_build/inside/a.py", "import numpy", "kb_build.inside.a imports numpy"),
        ("agents/blender/inside/a.py", "import kb_build", "agents.blender.inside.a imports kb_build"),
    ],
)
def test_a_breach_is_seen(tmp_path: Path, path: str, code: str, breach: str) -> None:
    (tmp_path / path).parent.mkdir(parents=True)
    (tmp_path / path).write_text(code)
    assert breach in breaches(tmp_path)


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("kb_serve/rank/search.py", "from kb_build.records import Symbol\nfrom kb_build import schema"),
        ("simworlds/cli.py", "from kb_build.cli import kb\nfrom kb_serve.cli import docs"),
        ("kb_build/inside/a.py", "import bpy, json, wire\nfrom mathutils import Vector"),
        ("measurements/report.py", "import agents.plan"),
    ],
)
def test_what_is_allowed_is_let_through(tmp_path: Path, path: str, code: str) -> None:
    (tmp_path / path).parent.mkdir(parents=True)
    (tmp_path / path).write_text(code)
    (tmp_path / path).with_name("wire.py").write_text("")
    assert breaches(tmp_path) == []


def test_a_second_way_into_the_build_is_seen(tmp_path: Path) -> None:
    (tmp_path / "kb_serve").mkdir()
    (tmp_path / "kb_serve" / "a.py").write_text("def f():\n    from kb_build.pipeline import build\n" * 1)
    (tmp_path / "kb_serve" / "b.py").write_text("from kb_build import pipeline\n")
    assert rebuilders(tmp_path) == ["kb_serve.a.f", "kb_serve.b"]


def test_importing_every_module_needs_no_blender_and_prints_nothing() -> None:
    names = [
        name
        for name, (path, _) in modules(REPO).items()
        if "inside" not in name.split(".") and path.name != "__main__.py"
    ]
    code = f"""
import importlib, sys
for name in {names!r}:
    importlib.import_module(name)
assert "bpy" not in sys.modules, "bpy was imported"
"""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=REPO, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
