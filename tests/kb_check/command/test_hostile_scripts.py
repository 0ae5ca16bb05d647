"""Random text and mutated scripts: each is checked to its end, and every finding stands in it."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from places import REPO

from kb_check.command.project import LoadedFile, check_group
from kb_check.text.fixes import apply_fixes
from kb_check.text.reading import read_source

if TYPE_CHECKING:
    from kb_check.checker import Checker
    from kb_check.findings import Span

PIECES = (
    "import bpy", "from bpy import context as C", "ob = bpy.context.object", "ob.draw_type = 'WIRE'", "for x in ob:",
    "    x.y = ob.data.vertices[0].co", "def f(a, *b, c=1):", "    return f(ob.modifiers.new('x', 'CLOTH'))",
    "class A(bpy.types.Panel):", "    bl_idname = 'x.y'", "bpy.ops.mesh.primitive_cube_add(radius=1)", "print 'x'",
    '"""', "(", "]", "if ob.type == 'MESH':", "# simworlds: ignore[unknown-attribute]", "# simworlds: ignore-file",
    "\\", "\t", "\0", "\x0c", "\r", "lambda: ob.x", "await x", "{**ob, 'é': [y for y in bpy.data.objects if y.foo]}",
    "nodes.new('ShaderNodeBsdfPrincipled').inputs['Specular']", "\ud800",
)  # fmt: skip
SCRIPTS = sorted(path for path in (REPO / "agents").rglob("inside/**/*.py") if path.stat().st_size > 1_000)

random_lines = st.lists(st.sampled_from(PIECES) | st.text(max_size=12), max_size=30).map("\n".join)
eager = settings(
    max_examples=60,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def holds(checker: Checker, data: bytes, name: str = "a.py") -> None:
    """Checks a file; every finding stands in it, and what its fixes make of it can be read."""
    source = read_source(data, name)
    (findings,) = check_group(checker, (LoadedFile(name, data),))
    lines = source.lines or [""]

    def inside(span: Span) -> bool:
        return 1 <= span.line <= span.end_line <= len(lines) and 0 <= span.column <= len(lines[span.line - 1])

    assert all(inside(finding.span) and finding.message for finding in findings)
    fixed = apply_fixes(source, findings, unsafe=True)
    check_group(checker, (LoadedFile(name, fixed.text.encode(source.encoding, "replace")),))


@eager
@example("")
@example("\r")
@example("x\r\ry z")
@example("\r:\nbpy.ops.mesh.primitive_cube_add(radius=1)")
@given(random_lines)
def test_random_code_is_checked(checker: Checker, code: str) -> None:
    holds(checker, code.encode("utf-8", "surrogatepass"))


@eager
@example(b"\n", "a.ipynb")
@given(st.binary(max_size=200), st.sampled_from(["a.py", "a.ipynb"]))
def test_random_bytes_are_checked(checker: Checker, data: bytes, name: str) -> None:
    holds(checker, data, name)


@pytest.mark.parametrize("seed", range(40))
def test_mutated_scripts_are_checked(checker: Checker, seed: int) -> None:
    # A script is cut, joined and changed as an editor, a merge or a broken disk would.
    dice = random.Random(seed)
    data = bytearray(dice.choice(SCRIPTS).read_bytes())
    for _ in range(dice.randint(1, 6)):
        start = dice.randrange(max(len(data), 1))
        end = min(start + dice.choice([1, 1, 5, 80, 2_000]), len(data))
        data[start:end] = dice.choice(
            [
                b"",
                b"\n",
                b"(",
                b"'''",
                bytes([dice.randrange(256)]),
                bytes(data[start:end]) * 2,
                b"    ",
                b":\n",
            ]
        )
    holds(checker, bytes(data))
