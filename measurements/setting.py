"""What one run of the measurements works with: paths, the environment of measured processes, small helpers."""

from __future__ import annotations

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

REPO = Path(__file__).resolve().parent.parent
QUERIES = REPO / "corpora" / "queries"
BLENDER = "5.1"  # the version that the labels were written for
# Those that scripts are run in, as far as they are here.
BLENDERS = ("3.4", "4.2", "4.5", "5.0", BLENDER, "5.2", "5.3")
_CLEANED = ("PYTHONDONTWRITEBYTECODE", "PYTHONUNBUFFERED", "PYTHONPROFILEIMPORTTIME")


@dataclass(frozen=True, slots=True)
class Setting:
    """``base`` is the file that is measured, in the folder ``home``; ``queries`` are the labelled sets, the first
    the one that is judged; ``quick`` measures less often and leaves out what takes long."""

    base: Path
    home: Path
    queries: tuple[Path, ...]
    quick: bool = False
    load_seconds: float = 30.0


def say(text: str) -> None:
    """Prints on stderr, with the time, what is being done."""
    print(f"[{time.strftime('%H:%M:%S')}] {text}", file=sys.stderr, flush=True)


def environment(home: Path) -> dict[str, str]:
    """The environment of a measured process: byte code is kept, as in any installation."""
    kept = {name: value for name, value in os.environ.items() if name not in _CLEANED}
    return {**kept, "SIMWORLDS_HOME": str(home), **_corpora(kept)}


def _corpora(known: Mapping[str, str]) -> dict[str, str]:
    """The folder of documentation sources that the Makefile would name."""
    beside = REPO.parent / "shared" / "corpora"
    return {} if known.get("SIMWORLDS_CORPORA") or not beside.is_dir() else {"SIMWORLDS_CORPORA": str(beside)}


def corpora() -> Path | None:
    """The folder of documentation sources, if there is one."""
    named = environment(Path()).get("SIMWORLDS_CORPORA")
    return Path(named) if named else None


def percentile(values: list[float], share: float) -> float:
    """The smallest of ``values`` that ``share`` of them do not exceed (nearest rank)."""
    ordered = sorted(values)
    return ordered[max(0, min(len(ordered) - 1, -int(-share * len(ordered) // 1) - 1))]


def brief(error: BaseException) -> str:
    """The innermost reason, in one line."""
    while isinstance(error, BaseExceptionGroup):
        error = error.exceptions[0]
    said = str(error).strip().splitlines()
    return f"{type(error).__name__}: {said[0][:200]}" if said else type(error).__name__
