"""What Blender says to scripts: ``python -m measurements.scripts.truth`` runs all of them and writes it down.

The scripts in ``corpora/scripts`` were written by a language model from memory, as it answers users. Those in
``unseen`` are looked at by measurements alone, never by who mends the checker.
"""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from measurements.setting import REPO, say
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator

FOLDER = REPO / "corpora" / "scripts"
FILE = FOLDER / "truth.jsonl"
SETS = ("seen", "unseen")
_RUNNER = Path(__file__).with_name("run_one.py")
_SECONDS = 90
_JOBS = 1
Kind = Literal["api", "run", "consequence"]

# Errors by what is, or is not, in the file or the session at the time: the code would run elsewhere.
_OF_THE_RUN = re.compile(
    r"poll\(\) failed|context is incorrect|No such file|not found in|could not be (?:opened|read)|StructRNA of type"
    r"|^Error: |no active|not supported in background|cannot be (?:used|run) in background",
    re.IGNORECASE,
)
_ENUM = re.compile(r'enum ".*" not found in')


@dataclass(frozen=True, slots=True)
class ScriptError:
    """An error that Blender raised at a statement, given by its first line."""

    line: int
    type: str
    message: str
    kind: Kind


@dataclass(frozen=True, slots=True)
class Truth:
    """What a run told: the statements that ended well, the errors, and whether the script came to its end."""

    script: str
    ran: tuple[int, ...]
    errors: tuple[ScriptError, ...]
    ended: bool


def scripts() -> Iterator[Path]:
    """Every script, those that are seen first."""
    for name in SETS:
        yield from sorted((FOLDER / name).glob("*.py"))


def read_truth() -> dict[str, Truth]:
    """Script (``seen/01_cloth.py``) → what was written down of it."""
    rows = (json.loads(line) for line in FILE.read_text(encoding="utf-8").splitlines())
    return {row["script"]: _truth(row) for row in rows}


def _truth(row: dict[str, object]) -> Truth:
    errors = row["errors"]
    assert isinstance(errors, list)
    return Truth(
        str(row["script"]),
        tuple(row["ran"]),  # pyright: ignore[reportArgumentType]
        tuple(ScriptError(**each) for each in errors),
        bool(row["ended"]),
    )


def run(code: str, name: str) -> Truth:
    """Runs a script in a Blender of its own, in a folder of its own."""
    with tempfile.TemporaryDirectory(prefix="simworlds-truth-") as folder:
        path = Path(folder) / "script.py"
        path.write_text(code, encoding="utf-8")
        try:
            ended = subprocess.run(
                [sys.executable, str(_RUNNER), str(path)],
                cwd=folder, capture_output=True, timeout=_SECONDS, check=False,
            )  # fmt: skip
            out = ended.stdout
        except subprocess.TimeoutExpired as error:
            out = error.stdout or b""
    rows = [
        json.loads(line.partition("\x1e")[2])
        for line in out.decode(errors="replace").split("\n")
        if "\x1e" in line
    ]
    nodes = list(ast.walk(ast.parse(code)))
    statements = {node.lineno: node for node in nodes if isinstance(node, ast.stmt)}
    bound = {node.id for node in nodes if isinstance(node, ast.Name)}
    errors = [
        ScriptError(
            row["line"], row["type"], row["message"], kind_of(row, statements.get(row["line"]), bound)
        )
        for row in rows
        if "type" in row
    ]
    ran = sorted({row["ran"] for row in rows if "ran" in row})
    return Truth(name, tuple(ran), tuple(errors), any("ended" in row for row in rows))


def kind_of(row: dict[str, object], statement: ast.stmt | None, names: set[str]) -> Kind:  # noqa: PLR0911
    """Whether an error is of the API as the code uses it, of what was there in the run, or follows from another."""
    kind, message = str(row["type"]), str(row["message"])
    if kind in {"NameError", "UnboundLocalError"}:
        return "consequence" if any(f"'{name}'" in message for name in names) else "api"
    if "NoneType" in message or kind in {"ReferenceError", "StopIteration"}:
        return "consequence"
    if kind in {"KeyError", "IndexError"}:
        return "api" if statement is not None and _asks_for_socket(statement) else "run"
    if kind in {"AttributeError", "ImportError", "ModuleNotFoundError"}:
        return "api"
    if kind == "TypeError":
        return "api"
    if _OF_THE_RUN.search(message) and not _ENUM.search(message):
        return "run"
    return "api" if kind in {"ValueError", "RuntimeError"} else "run"


def _asks_for_socket(statement: ast.stmt) -> bool:
    return any(
        isinstance(node, ast.Subscript)
        and isinstance(node.value, ast.Attribute)
        and node.value.attr in {"inputs", "outputs"}
        for node in ast.walk(statement)
    )


def record() -> None:
    """Runs every script and writes the file."""
    paths = list(scripts())

    def one(path: Path) -> Truth:
        name = path.relative_to(FOLDER).as_posix()
        truth = run(path.read_text(encoding="utf-8"), name)
        say(f"{name}: {len(truth.errors)} errors" + ("" if truth.ended else ", did not end"))
        return truth

    with ThreadPoolExecutor(_JOBS) as pool:
        rows = list(pool.map(one, paths))
    text = "".join(json.dumps(asdict(row), ensure_ascii=False) + "\n" for row in rows)
    write_whole(FILE, text)
    errors = [error for row in rows for error in row.errors]
    kinds = {kind: sum(error.kind == kind for error in errors) for kind in ("api", "run", "consequence")}
    say(f"{len(rows)} scripts, {len(errors)} errors: {kinds}")


if __name__ == "__main__":
    record()
