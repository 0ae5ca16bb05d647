"""``python tests/fuzz/run_fuzz.py [--seconds 60] [--only archive]``: gives each reader broken input.

What makes one fail is shrunk and kept in ``corpus/TARGET``; ``test_fuzz_corpus.py`` tries it again with every change.
"""

from __future__ import annotations

import hashlib
import json
import os
import random
import sys
import time
import traceback
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

FOLDER = Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parents[1]), str(FOLDER.parent / "agents")]

import click  # noqa: E402 - the repository is on the path now
from hypothesis import HealthCheck, given, seed, settings  # noqa: E402
from small_plan import small_plan  # noqa: E402
from targets import Messages, Queries, Target, targets  # noqa: E402

from kb_serve.errors import BaseUnreadable  # noqa: E402
from kb_serve.knowledge_base import KnowledgeBase  # noqa: E402
from simworlds.settings import built_bases, home_folder  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Iterator

CORPUS = FOLDER / "corpus"
_BATCH = 40
_MOST_SECONDS = 20.0  # of CPU, for one input
_MOST_MEMORY = 4 << 30


def fuzz(target: Target, seconds: float, first_seed: int) -> tuple[int, bytes | None, str]:
    """(how many inputs were tried, the least that failed, how it failed)."""
    end, tried, failing, fault = time.monotonic() + seconds, 0, b"", ""

    def one(data: bytes) -> None:
        nonlocal tried, failing, fault
        if time.monotonic() >= end and not fault:
            return  # what is left of the batch
        tried += 1
        began = time.process_time()
        try:
            target.check(data)
            assert time.process_time() - began < _MOST_SECONDS, "it takes too long"
        except BaseException:
            failing, fault = data, traceback.format_exc()
            raise

    options = settings(
        max_examples=_BATCH,
        deadline=None,
        database=None,
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )
    number = first_seed
    while time.monotonic() < end:
        try:
            seed(number)(options(given(data=target.given)(one)))()
        except Exception:
            return tried, failing, fault
        number += 1
    return tried, None, ""


def keep(target: str, data: bytes) -> Path:
    """Puts an input into the corpus."""
    path = CORPUS / target / hashlib.sha256(data).hexdigest()[:12]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    return path


def newest_base(home: Path) -> Path | None:
    """The usable base of the newest Blender; None without one."""
    for base in reversed(built_bases(home).values()):
        try:
            with closing(KnowledgeBase(base)):
                return base
        except BaseUnreadable as error:
            click.echo(f"{base.name} is left out. {error}")
    return None


@contextmanager
def all_targets(base: Path | None, home: Path) -> Iterator[list[Target]]:
    """The targets; what they hold open is closed afterwards."""
    with closing(Messages(home)) as messages, ExitStack() as opened:
        queries = opened.enter_context(closing(Queries(base))) if base is not None else None
        yield targets(queries, [json.dumps(small_plan()).encode()], messages)


@click.command()
@click.option("--seconds", type=float, default=60.0, envvar="FUZZ_SECONDS", help="For all targets together.")
@click.option("--only", multiple=True, help="Only this target.")
@click.option("--seed", "first_seed", type=int, help="Repeats a run.")
def main(seconds: float, only: tuple[str, ...], first_seed: int | None) -> None:
    """Fuzz what reads the work of others."""
    if os.name == "posix":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (_MOST_MEMORY, _MOST_MEMORY))
    first_seed = random.randrange(1 << 30) if first_seed is None else first_seed
    base = newest_base(home_folder())
    with all_targets(base, home_folder()) as found:
        chosen = [target for target in found if not only or target.name in only]
        if not chosen:
            raise click.UsageError(f"There is no such target. They are: {', '.join(t.name for t in found)}.")
        if base is None:
            click.echo("query: left out, since there is no usable knowledge base here (make kb)")
        click.echo(f"seed {first_seed}")
        failed = 0
        for target in chosen:
            tried, data, fault = fuzz(target, seconds / len(chosen), first_seed)
            click.echo(f"{target.name:<12}{tried:>8,} inputs{'' if data is None else ', and one fails'}")
            if data is not None:
                failed += 1
                click.echo(f"{fault}\nIt is kept: {keep(target.name, data)}", err=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
