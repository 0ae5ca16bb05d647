"""Who may import whom, directly and through others, and how much stands in a folder. Each rule is shown to bite."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import pytest
from places import REPO

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

PARTS = (
    "simworlds",
    "kb_check",
    "kb_build",
    "kb_serve",
    "agents",
    "bench",
    "measurements",
    "release",
    "docs",
)
BLENDERS_OWN = frozenset(
    (  # noqa: SIM905
        "_bpy _bpy_types _rna_manual_reference addon_utils aud bl_math bl_operators bl_ui blf bmesh bpy bpy_extras "
        "bpy_restrict_state bpy_types freestyle gpu gpu_extras idprop imbuf manta mathutils nodeitems_utils "
        "rna_manual_reference"
    ).split()
)
# What every Blender that scenes are built or judged in brings, besides the standard library.
BLENDERS_PACKAGES = frozenset({"numpy", "zstandard"})
SHARED_INSIDE = ("simworlds.sandbox.inside",)

Graph = dict[str, frozenset[str]]


@dataclass(frozen=True)
class Rule:
    """Modules below ``who`` must not import (``through`` others, too) what is below ``what``.

    ``unless``: a module that may be imported, or ``importer:imported`` for one importer alone.
    """

    who: str
    what: tuple[str, ...]
    unless: tuple[str, ...] = ()
    through: bool = False


def others(*names: str) -> tuple[str, ...]:
    return tuple(part for part in PARTS if part not in names)


def in_order(folder: str, *names: str) -> Iterator[Rule]:
    """What stands in a folder: nothing of it imports what comes behind it."""
    for at, name in enumerate(names[:-1], start=1):
        yield Rule(f"{folder}.{name}", tuple(f"{folder}.{later}" for later in names[at:]))


# Folders whose modules and packages are in an order: none imports what comes behind it.
ORDERS = {
    "kb_build.flow": (
        *("syntax", "values", "blender", "state", "evaluation", "calls", "execution", "analysis"),
    ),
    "kb_build.blender.inside": (
        *("wire", "apart", "classes", "outside_rna", "instances", "passes", "nodes"),
        *("bpy_ops", "preconditions", "tried", "extract_api"),
    ),
    "kb_serve.lookups": (
        *("records", "kept_rows", "base_file", "symbols"),
        *("names", "history", "makers", "manual", "usage", "settings"),
    ),
    "kb_serve.recognise": (
        *("message_patterns", "several", "unwanted", "changed_by"),
        *("chains", "elsewhere", "resolver", "likely", "removed", "recognition", "by_words", "named"),
        *("notes", "code", "messages", "missing_names", "recogniser"),
    ),
    "kb_serve.answer": (
        *("budget", "pages", "facts", "ways", "render", "steps", "topic", "asked"),
        *(
            "hits",
            "hit_lines",
            "hit_blocks",
            "query_text",
            "question_frame",
            "hit_answers",
            "known",
            "docs_answer",
            "next_call",
            "said_twice",
            "changes",
            "drafts",
            "composer",
        ),
    ),
    "kb_serve.answer.steps": (
        *(
            "names",
            "scene",
            "making",
            "node_trees",
            "operators",
            "setting",
            "main_classes",
            "made_groups",
            "order",
        ),
    ),
}

RULES = (
    *(rule for folder, names in ORDERS.items() for rule in in_order(folder, *names)),
    Rule("simworlds", others("simworlds"), through=True),
    Rule("kb_build", others("simworlds", "kb_build"), through=True),
    # How code is read needs to know what a symbol is and where a base keeps it; both are leaves.
    Rule(
        "kb_build.flow",
        ("kb_build",),
        (
            "kb_build.symbols.api_names",
            "kb_build.flow",
            "kb_build.symbols.math_classes",
            "kb_build.symbols.python_values",
            "kb_build.symbols.object_data",
            "kb_build.symbols.paths",
            "kb_build.symbols.records",
            "kb_build.symbols.flag_names",
            "kb_build.schema",
            "kb_build.symbols.unlisted",
        ),
    ),
    # Checking words its findings as the knowledge base words its answers. The server loads the tool by its name.
    Rule("kb_check", others("simworlds", "kb_check", "kb_build", "kb_serve"), through=True),
    Rule(
        "kb_check",
        ("kb_build",),
        (
            "kb_build.symbols.api_names",
            "kb_build.flow",
            "kb_build.symbols.handlers",
            "kb_build.symbols.python_values",
            "kb_build.symbols.object_data",
            "kb_build.symbols.paths",
            "kb_build.symbols.records",
            "kb_build.symbols.flag_names",
            "kb_build.symbols.taken",
            "kb_build.symbols.needs",
            "kb_build.schema",
            "kb_build.symbols.accepted",
            "kb_build.symbols.flags",
            "kb_build.symbols.lines",
            "kb_build.index.analysis",
            "kb_build.symbols.unlisted",
        ),
    ),
    Rule("kb_build.symbols.api_names", ("kb_build", "kb_check")),
    Rule("kb_build.symbols.handlers", ("kb_build", "kb_check")),
    Rule("kb_build.symbols.paths", ("kb_build", "kb_check")),
    Rule("kb_build.symbols.taken", ("kb_build", "kb_check")),
    Rule("kb_build.symbols.needs", ("kb_build", "kb_check")),
    Rule(
        "kb_build.symbols.records",
        ("kb_build", "kb_check"),
        (
            "kb_build.symbols.flag_names",
            "kb_build.symbols.needs",
            "kb_build.symbols.paths",
            "kb_build.symbols.taken",
        ),
    ),
    Rule("kb_build.symbols.flag_names", ("kb_build", "kb_check")),
    Rule("kb_build.pages.page", ("kb_build", "kb_check")),
    Rule("kb_build.schema", ("kb_build", "kb_check")),
    Rule("kb_build.symbols.unlisted", ("kb_build", "kb_check")),
    Rule("kb_build.symbols.object_data", ("kb_build", "kb_check")),
    Rule(
        "kb_build.symbols.accepted",
        ("kb_build", "kb_check"),
        ("kb_build.symbols.flag_names", "kb_build.symbols.records"),
    ),
    Rule("kb_build.symbols.math_classes", ("kb_build", "kb_check"), ("kb_build.symbols.records",)),
    Rule(
        "kb_build.symbols.python_values",
        ("kb_build", "kb_check"),
        ("kb_build.symbols.flag_names", "kb_build.symbols.records"),
    ),
    # How text is cut into words belongs to the store's schema: index and query must agree on it.
    Rule("kb_build.index.analysis", ("kb_build",), ("kb_build.symbols.api_names",)),
    Rule("kb_build.index.everyday_table", ("kb_build",)),
    # What is in a base, before anything is made of it.
    Rule("kb_serve.lookups", ("kb_serve",), ("kb_serve.lookups", "kb_serve.errors")),
    Rule("kb_serve", others("simworlds", "kb_build", "kb_serve"), through=True),
    Rule(
        "kb_serve",
        ("kb_build",),
        # What a base holds, which words it lends each other, and one way to make it.
        (
            "kb_build.symbols.api_names",
            "kb_build.symbols.paths",
            "kb_build.pages.definitions",
            "kb_build.pages.page",
            "kb_build.symbols.records",
            "kb_build.symbols.flag_names",
            "kb_build.symbols.needs",
            "kb_build.symbols.taken",
            "kb_build.schema",
            "kb_build.index.analysis",
            "kb_build.index.everyday_table",
            "kb_build.symbols.math_classes",
            "kb_build.symbols.python_values",
            "kb_build.symbols.object_data",
            "kb_build.symbols.accepted",
            "kb_build.symbols.flags",
            "kb_build.symbols.lines",
            "kb_build.symbols.unlisted",
            "kb_build.pipeline",
        ),
    ),
    # The knowledge base is reached over MCP, as any other client reaches it.
    Rule("agents", others("simworlds", "agents"), through=True),
    Rule(
        "agents.plan", ("simworlds.llm", "simworlds.sandbox", "agents.blender", "agents.roles", "agents.loop")
    ),
    Rule(
        "agents.protocol",
        ("simworlds.llm", "simworlds.sandbox", "agents.blender", "agents.roles", "agents.loop"),
    ),
    *(
        # What scores results shares no code with the systems that it scores.
        Rule(f"bench.{part}", others("simworlds", "bench"), through=True)
        for part in ("audit", "judge", "validity", "scenes", "references", "frames", "results")
    ),
    Rule("bench", ("kb_check", "kb_build", "kb_serve", "measurements", "docs"), through=True),
    Rule(
        "bench",
        ("agents",),
        ("bench.sweep.systems:agents", "bench.blenderbench:agents", "bench.commands:agents"),
    ),
)


def below(name: str, top: str) -> bool:
    return name == top or name.startswith(top + ".")


def module_name(path: Path, repo: Path) -> str:
    parts = path.relative_to(repo).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(tree: ast.AST, module: str, *, is_package: bool) -> set[str]:
    """Every module that ``tree`` names in an import, wherever it stands; relative ones in full."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = module.split(".") if is_package else module.split(".")[:-1]
                base = ".".join([*parts[: len(parts) - node.level + 1], *filter(None, [base])])
            names.update([base, *(f"{base}.{alias.name}" for alias in node.names)])
    return names


@cache
def modules(repo: Path) -> dict[str, tuple[Path, ast.Module]]:
    paths = [path for part in PARTS for path in sorted((repo / part).rglob("*.py"))]
    return {module_name(path, repo): (path, ast.parse(path.read_bytes())) for path in paths}


@cache
def imports(repo: Path) -> Graph:
    """Module → everything that it names in imports, those under TYPE_CHECKING included."""
    return {
        module: frozenset(imports_of(tree, module, is_package=path.name == "__init__.py"))
        for module, (path, tree) in modules(repo).items()
    }


def between_modules(graph: Graph) -> Graph:
    """The same, of the tree's own modules alone; a name that a package holds counts for the package."""
    return {
        module: frozenset(
            name
            for name in named
            if name in graph
            and name != module
            # ``from a.b import c`` names a.b as well; where c is a module, a.b is only the way to it.
            and not (any(below(other, name) and other in graph for other in named - {name}))
        )
        for module, named in graph.items()
    }


def reached(graph: Graph, module: str) -> dict[str, str]:
    """Every module that is imported by way of ``module`` → the one that imports it."""
    found: dict[str, str] = {}
    waiting = [module]
    while waiting:
        importer = waiting.pop()
        for name in sorted(graph.get(importer, frozenset())):
            if name not in found:
                found[name] = importer
                waiting.append(name)
    return found


def is_excused(rule: Rule, module: str, name: str) -> bool:
    for item in rule.unless:
        importer, colon, imported = item.rpartition(":")
        if colon and not below(module, importer):
            continue
        if below(name, imported) or imported.startswith(f"{name}."):
            return True
    return False


def breaches_of_rules(graph: Graph) -> Iterator[str]:
    own = between_modules(graph)
    for rule in RULES:
        for module in (name for name in graph if below(name, rule.who)):
            for name in sorted(graph[module]):
                if any(below(name, what) for what in rule.what) and not is_excused(rule, module, name):
                    yield f"{module} imports {name}"
            if rule.through:
                for name, importer in reached(own, module).items():
                    if any(below(name, what) for what in rule.what) and importer != module:
                        yield f"{module} reaches {name} through {importer}"


def breaches_inside(graph: Graph) -> Iterator[str]:
    """What runs in Blender knows Blender, the standard library and the packages beside it; nobody else knows bpy."""
    for module, named in graph.items():
        parts = module.split(".")
        if "inside" not in parts:
            yield from (
                f"{module} imports {name}" for name in sorted(named) if name.split(".")[0] in BLENDERS_OWN
            )
            continue
        own = ".".join(parts[: parts.index("inside") + 1])
        packages = {own, *SHARED_INSIDE}
        if below(module, "bench"):
            packages |= {name for name in graph if below(name, "bench") and name.endswith(".inside")}
        allowed = BLENDERS_OWN | set(sys.stdlib_module_names)
        if not below(module, "kb_build"):
            allowed |= BLENDERS_PACKAGES
        for name in sorted(named):
            ours = any(below(name, package) or package.startswith(f"{name}.") for package in packages)
            if not ours and name.split(".")[0] not in allowed:
                yield f"{module} imports {name}"


def breaches_between_roles(graph: Graph) -> Iterator[str]:
    shared = ("agents.roles.base", "agents.roles.names", "agents.roles.prompts", "agents.roles.sheets")
    for module, named in graph.items():
        if not module.startswith("agents.roles."):
            continue
        for name in sorted(named):
            if name.startswith("agents.roles.") and not any(below(name, item) for item in (module, *shared)):
                yield f"{module} imports {name}"


# The streams of the process are guarded, and one console may send escapes of its own (simworlds.terminal).
AROUND_THE_GUARD = frozenset(
    (  # noqa: SIM905
        "rich.console.Console rich.get_console rich.print rich.print_json rich.inspect rich.pretty.pprint "
        "simworlds.terminal.streams.unguarded"
    ).split()
)
RAW_STREAMS = frozenset({"sys.__stdout__", "sys.__stderr__", "sys.stdout.buffer", "sys.stderr.buffer"})


def breaches_of_guard(repo: Path) -> Iterator[str]:
    """Ways to a terminal that do not go through ``simworlds.terminal``."""
    graph = imports(repo)
    for module, (_, tree) in modules(repo).items():
        if below(module, "simworlds.terminal") or "inside" in module.split("."):
            continue
        yield from (f"{module} uses {name}" for name in sorted(AROUND_THE_GUARD & graph[module]))
        for node in ast.walk(tree):
            if (
                isinstance(node, ast.Attribute)
                and (name := ast.unparse(node)) in RAW_STREAMS | AROUND_THE_GUARD
            ):
                yield f"{module} uses {name}"


def circles(graph: Graph) -> list[list[str]]:
    """Groups of modules that import each other, directly or through others (Tarjan's strongly connected components)."""
    own = between_modules(graph)
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []

    def visit(module: str) -> None:
        order[module] = low[module] = len(order)
        stack.append(module)
        for name in sorted(own[module]):
            if name not in order:
                visit(name)
                low[module] = min(low[module], low[name])
            elif name in stack:
                low[module] = min(low[module], order[name])
        if low[module] == order[module]:
            at = stack.index(module)
            group = stack[at:]
            del stack[at:]
            if len(group) > 1:
                groups.append(sorted(group))

    for module in own:
        if module not in order:
            visit(module)
    return groups


def package_circles(graph: Graph) -> list[list[str]]:
    """Circles of the top level's parts, as ``kb_build`` and ``kb_serve``. What imports none of us is in none."""
    own = between_modules(graph)
    parts = {
        part: frozenset(
            name.split(".")[0] for module in own if below(module, part) for name in own[module] if own[name]
        )
        - {part}
        for part in PARTS
    }
    return circles({part: names | {part} for part, names in parts.items()})


def breaches(repo: Path) -> list[str]:
    graph = imports(repo)
    return [
        *breaches_of_rules(graph),
        *breaches_inside(graph),
        *breaches_between_roles(graph),
        *breaches_of_guard(repo),
    ]


def rebuilders(repo: Path) -> list[str]:
    """The server's functions that import the build: ``module.function``, or the module if outside of any."""
    names: list[str] = []
    for module, (_, tree) in modules(repo).items():
        if not below(module, "kb_serve"):
            continue
        scopes = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
        named = [s.name for s in scopes if "kb_build.pipeline" in imports_of(s, module, is_package=False)]
        if "kb_build.pipeline" in imports_of(tree, module, is_package=False):
            names += [f"{module}.{name}" for name in named] or [module]
    return names


# What the wheel brings.
PRODUCT = ("simworlds", "kb_build", "kb_serve", "kb_check", "agents", "bench")
MOST_MODULES = 16
# Lists: each module is one more of a kind that people add to.
LISTS = frozenset(
    (  # noqa: SIM905
        "agents/blender/tools bench/references/inside/scenes kb_check/migrate/rewrites kb_check/rules "
        "kb_serve/recognise/messages"
    ).split()
)


def sizes(repo: Path) -> Counter[str]:
    """Folder of the product → how many modules stand in it."""
    return Counter(
        path.parent.relative_to(repo).as_posix()
        for module, (path, _) in modules(repo).items()
        if any(below(module, part) for part in PRODUCT) and not path.name.startswith("__")
    )


def breaches_of_order(repo: Path) -> Iterator[str]:
    """Folders with more modules than they may have."""
    for folder, size in sorted(sizes(repo).items()):
        if size > MOST_MODULES and folder not in LISTS:
            yield f"{folder} has {size} modules, and at most {MOST_MODULES} are allowed"


def write(repo: Path, files: Mapping[str, str]) -> None:
    for name, code in files.items():
        path = repo / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(code)


def test_no_module_imports_or_reaches_what_it_must_not() -> None:
    assert breaches(REPO) == []


def test_all_that_stands_in_an_ordered_folder_has_its_place() -> None:
    for folder, names in ORDERS.items():
        below_it = [
            name.removeprefix(f"{folder}.") for name in modules(REPO) if name.startswith(f"{folder}.")
        ]
        assert set(names) == {name.partition(".")[0] for name in below_it}, folder


def test_no_folder_has_more_modules_than_a_reader_looks_through() -> None:
    assert list(breaches_of_order(REPO)) == []
    assert sizes(REPO).keys() >= LISTS


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = imports(REPO)
    assert circles(graph) == []
    assert package_circles(graph) == []


def test_the_tree_that_is_checked_is_the_real_one() -> None:
    names = set(modules(REPO))
    assert {
        "kb_build.symbols.records",
        "kb_serve",
        "agents",
        "bench",
        "kb_build.blender.inside.extract_api",
    } <= names


def test_the_server_reaches_the_build_through_one_function_at_most() -> None:
    names = rebuilders(REPO)
    assert len(names) <= 1, names
    assert not [name for name in names if name in modules(REPO)], "the import belongs into the function"


@pytest.mark.parametrize(
    ("path", "code", "breach"),
    [
        ("simworlds/files.py", "import kb_build.errors", "simworlds.files imports kb_build.errors"),
        (
            "kb_build/symbols/records.py",
            "import kb_build.errors",
            "kb_build.symbols.records imports kb_build.errors",
        ),
        ("kb_build/store.py", "from kb_serve.reader import read", "kb_build.store imports kb_serve.reader"),
        ("kb_build/store.py", "def f():\n    import bpy", "kb_build.store imports bpy"),
        (
            "kb_build/flow/blender/api.py",
            "from kb_build.store import write",
            "kb_build.flow.blender.api imports kb_build.store",
        ),
        (
            "kb_build/flow/values/types.py",
            "from kb_build.flow.state.core import Core",
            "kb_build.flow.values.types imports kb_build.flow.state",
        ),
        (
            "kb_serve/answer/render.py",
            "from kb_serve.answer.steps.order import Steps",
            "kb_serve.answer.render imports kb_serve.answer.steps",
        ),
        (
            "kb_serve/answer/steps/making/trees.py",
            "from kb_serve.answer.steps.node_trees.nodes import NodeSteps",
            "kb_serve.answer.steps.making.trees imports kb_serve.answer.steps.node_trees",
        ),
        ("kb_serve/search.py", "from kb_build.store import write", "kb_serve.search imports kb_build.store"),
        ("kb_serve/search.py", "from kb_build import store", "kb_serve.search imports kb_build.store"),
        ("kb_serve/deep/a.py", "from ..x import y\nimport agents", "kb_serve.deep.a imports agents"),
        ("agents/loop.py", "from kb_serve import knowledge_base", "agents.loop imports kb_serve"),
        ("agents/plan/scene.py", "from ..loop import run", "agents.plan.scene imports agents.loop"),
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
        ("bench/audit/audit.py", "import agents.protocol", "bench.audit.audit imports agents.protocol"),
        (
            "bench/judge/items.py",
            "if TYPE_CHECKING:\n    import kb_build.x",
            "bench.judge.items imports kb_build.x",
        ),
        ("bench/sweep/steps.py", "import agents.loop", "bench.sweep.steps imports agents.loop"),
        ("agents/views.py", "import bench", "agents.views imports bench"),
        ("kb_build/blender/inside/a.py", "import numpy", "kb_build.blender.inside.a imports numpy"),
        ("agents/blender/inside/a.py", "import kb_build", "agents.blender.inside.a imports kb_build"),
        (
            "agents/blender/inside/a.py",
            "from .. import b",
            "agents.blender.inside.a imports agents.blender.b",
        ),
        ("bench/audit/inside/a.py", "import agents.blender.inside", "bench.audit.inside.a imports agents"),
        ("bench/a.py", "from rich.console import Console", "bench.a uses rich.console.Console"),
        ("agents/a.py", "import rich\nrich.print('a')", "agents.a uses rich.print"),
        ("kb_serve/a.py", "import sys\nsys.stdout.buffer.write(b'a')", "kb_serve.a uses sys.stdout.buffer"),
        (
            "agents/a.py",
            "from simworlds.terminal.streams import unguarded",
            "agents.a uses simworlds.terminal.streams.unguarded",
        ),
    ],
)
def test_a_breach_is_seen(tmp_path: Path, path: str, code: str, breach: str) -> None:
    write(tmp_path, {path: code})
    assert [found for found in breaches(tmp_path) if found.startswith(breach)]


def test_a_breach_through_other_modules_is_seen(tmp_path: Path) -> None:
    files = {
        "bench/audit/a.py": "import bench.sweep.b",
        "bench/sweep/b.py": "from bench.sweep.systems import c",
        "bench/sweep/systems/c.py": "from agents.loop import d",
        "agents/loop/d.py": "",
    }
    write(tmp_path, files)
    assert breaches(tmp_path) == ["bench.audit.a reaches agents.loop.d through bench.sweep.systems.c"]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("import kb_build.b", "import kb_build.a"),
        ("from kb_build import b", "def f():\n    from kb_build.a import x"),
        ("from .b import x", "if TYPE_CHECKING:\n    from kb_build.a import Y"),
    ],
)
def test_a_circle_is_seen(tmp_path: Path, first: str, second: str) -> None:
    write(tmp_path, {"kb_build/a.py": first, "kb_build/b.py": second, "kb_build/c.py": "import kb_build.a"})
    assert circles(imports(tmp_path)) == [["kb_build.a", "kb_build.b"]]


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("kb_serve/search.py", "from kb_build.symbols.records import Symbol\nfrom kb_build import schema"),
        ("kb_check/a.py", "from kb_build.symbols.records import Symbol\nfrom kb_build.schema import unpack"),
        ("kb_build/blender/inside/a.py", "import bpy, json\nfrom . import b\nfrom mathutils import Vector"),
        (
            "agents/blender/inside/x/a.py",
            "from simworlds.sandbox.inside import c\nfrom ..y import b\nimport numpy",
        ),
        ("bench/validity/inside/a.py", "from bench.audit.inside import b"),
        ("bench/sweep/systems/a.py", "import agents.loop"),
        ("measurements/report.py", "import agents.plan, kb_serve, bench"),
    ],
)
def test_what_is_allowed_is_let_through(tmp_path: Path, path: str, code: str) -> None:
    write(tmp_path, {"bench/audit/inside/b.py": "", "bench/audit/inside/__init__.py": "", path: code})
    assert breaches(tmp_path) == []


@pytest.mark.parametrize(
    ("folder", "size", "breach"),
    [
        ("kb_check/x", 16, []),
        ("kb_check/x", 17, ["kb_check/x has 17 modules, and at most 16 are allowed"]),
        ("kb_check", 17, ["kb_check has 17 modules, and at most 16 are allowed"]),
        ("kb_check/rules", 100, []),
        ("kb_check/rules/x", 17, ["kb_check/rules/x has 17 modules, and at most 16 are allowed"]),
        ("measurements", 100, []),
    ],
)
def test_a_crowded_folder_is_seen(tmp_path: Path, folder: str, size: int, breach: list[str]) -> None:
    write(tmp_path, {f"{folder}/{name}.py": "" for name in ("__init__", *(f"a{n}" for n in range(size)))})
    assert list(breaches_of_order(tmp_path)) == breach


def test_a_second_way_into_the_build_is_seen(tmp_path: Path) -> None:
    files = {
        "kb_serve/a.py": "def f():\n    from kb_build.pipeline import build\n",
        "kb_serve/b.py": "from kb_build import pipeline\n",
    }
    write(tmp_path, files)
    assert rebuilders(tmp_path) == ["kb_serve.a.f", "kb_serve.b"]


@pytest.mark.slow
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
sys.exit({len(names)} % 97)  # a module that ends the process would end it with 0
"""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=REPO, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (len(names) % 97, "", "")


def test_modules_of_tests_have_names_of_their_own() -> None:
    """Outside of packages they are imported by their base names, and two of one name would be one."""
    seen: dict[str, Path] = {}
    for path in sorted((REPO / "tests").rglob("*.py")):
        is_packaged = (path.parent / "__init__.py").exists() or "inside" in path.parts
        if path.name != "conftest.py" and not is_packaged:
            other = seen.setdefault(path.name, path)
            assert other == path, f"{path} and {other}"
