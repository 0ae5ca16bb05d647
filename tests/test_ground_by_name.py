"""Nothing outside the sandbox's package opens what a worker can write to by its path."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

import pytest
from places import REPO

if TYPE_CHECKING:
    from collections.abc import Iterator

PARTS = ("simworlds", "kb_build", "kb_serve", "agents", "bench", "measurements")
WITHIN = "simworlds/sandbox/"  # where grounds are made and mounted
TO_BLENDER = {"call", "ask", "_ask"}  # what carries arguments to Blender


def breaches(code: str) -> Iterator[int]:
    """Lines that take a ground's whole path, or give the path that is meant for Blender to anything else."""
    if "mount" not in code and "for_blender" not in code:
        return
    tree = ast.parse(code)
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and node.attr == "mount":
            yield node.lineno
    functions = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and any(is_for_blender(inner) for inner in ast.walk(node))
    ]
    for function in functions:
        names = {
            target.id
            for node in ast.walk(function)
            if isinstance(node, ast.Assign) and gives(node.value, set())
            for place in node.targets
            for target in ([*place.elts] if isinstance(place, ast.Tuple) else [place])
            if isinstance(target, ast.Name)
        }
        for node in ast.walk(function):
            if isinstance(node, ast.Call) and not is_for_blender(node):
                to_blender = isinstance(node.func, ast.Attribute) and node.func.attr in TO_BLENDER
                given = [node.func, *node.args, *(word.value for word in node.keywords)]
                if not to_blender and any(gives(part, names) for part in given):
                    yield node.lineno


def is_for_blender(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "for_blender"
    )


def gives(node: ast.AST, names: set[str]) -> bool:
    """Whether an expression has such a path in it; what lies in a dictionary goes to Blender as arguments."""
    if isinstance(node, ast.Dict | ast.JoinedStr):
        return False
    if is_for_blender(node) or (isinstance(node, ast.Name) and node.id in names):
        return True
    if isinstance(node, ast.Call):  # is looked at by itself
        return False
    return any(gives(child, names) for child in ast.iter_child_nodes(node))


def test_no_worker_s_file_is_opened_by_its_path() -> None:
    found = [
        f"{path.relative_to(REPO)}:{line}"
        for part in PARTS
        for path in sorted((REPO / part).rglob("*.py"))
        if not path.relative_to(REPO).as_posix().startswith(WITHIN)
        for line in breaches(path.read_text())
    ]
    assert found == []


@pytest.mark.parametrize(
    "line",
    [
        "shutil.copyfile(source, ground.mount / 'film')",
        "open(ground.for_blender('picture.png'))",
        "Path(ground.for_blender()).glob('*')",
        "path = ground.for_blender('x'); Image.open(path)",
        "path, size = ground.for_blender('x'), 1; os.unlink(path)",
        "Image.open(io.BytesIO(Path(ground.for_blender('x')).read_bytes()))",
        "os.path.join(ground.for_blender(), name).strip()",
    ],
)
def test_a_path_that_is_opened_is_seen(line: str) -> None:
    assert list(breaches(f"def f():\n    {line}\n"))


@pytest.mark.parametrize(
    "line",
    [
        "blender.call('render', {'path': ground.for_blender('x')}, read)",
        "path = ground.for_blender('x'); blender.call('render', {'path': path}, read)",
        "scene.ask('render', path=ground.for_blender('x'))",
        "ground.take('x', target)",
        "code = f'save({ground.for_blender()!r})'; blender.call('execute', {'code': code}, read)",
    ],
)
def test_a_path_that_blender_gets_is_let_through(line: str) -> None:
    assert not list(breaches(f"def f():\n    {line}\n"))
