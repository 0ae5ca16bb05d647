"""``python -m bench``: retrieval, latency, servers, builds, Blender, the verifier and audits, beside targets."""

from __future__ import annotations

import argparse
import gc
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.base_file import read_meta
from kb_serve.errors import KBServeError
from measurements import report
from measurements.builds import BuildFailed, run_build
from measurements.retrieval import BadQueries, misses
from measurements.setting import BLENDER, QUERIES, REPO, Setting, say
from simworlds.errors import UserError
from simworlds.settings import base_path, home_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

PARTS = ("retrieval", "latency", "server", "builds", "blender", "verifier", "audits")
_SETS = ("dev.jsonl", "check.jsonl", "blind.jsonl")


def _parts(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    if unknown := [name for name in names if name not in PARTS]:
        raise argparse.ArgumentTypeError(f"{', '.join(unknown)}: parts are {', '.join(PARTS)}")
    return names


def _arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument(
        "--only", type=_parts, default=list(PARTS), metavar="PARTS", help=f"of {','.join(PARTS)}"
    )
    parser.add_argument(
        "--queries", type=Path, action="append", metavar="FILE",
        help="labelled queries (JSON Lines); may be repeated, the first is judged (default: dev and check)",
    )  # fmt: skip
    parser.add_argument(
        "--home", type=Path, help="folder of the bases (default: SIMWORLDS_HOME or the user's)"
    )
    parser.add_argument("--quick", action="store_true", help="measure less often, leave out what takes long")
    parser.add_argument(
        "--load-seconds", type=float, default=30.0, help="length of the HTTP load (default: 30)"
    )
    parser.add_argument("--misses", action="store_true", help="list the queries without a right answer")
    parser.add_argument("--output", type=Path, default=REPO / "reports", help="folder of the reports")
    return parser.parse_args(given)


def _base(home: Path) -> Path:
    """The base that is measured, built if it is not there."""
    base = base_path(home, BLENDER)
    if not base.is_file():
        say(f"no base of Blender {BLENDER} in {home}: building it")
        say(f"built in {run_build(home).wall:.1f} s")
    return base


def measure(name: str, setting: Setting) -> report.Part:
    """One part, by name; what a part needs is loaded when it is measured."""
    from importlib import import_module  # noqa: PLC0415 - a part that is left out costs nothing

    # What earlier parts left behind neither is looked through nor still goes to disk while this one is measured.
    gc.collect()
    gc.freeze()
    if hasattr(os, "sync"):
        os.sync()
    part = import_module(f"measurements.{name}").measure(setting)
    assert isinstance(part, report.Part)
    return part


def main(given: Sequence[str] | None = None) -> int:
    """Measures what is asked for, prints the report, writes it. Returns 0, or 2 when something could not be done.

    Targets that are not reached are shown, and are no error.
    """
    options = _arguments(given)
    home = (options.home or home_folder()).expanduser().absolute()
    queries = tuple(options.queries or (QUERIES / name for name in _SETS))
    try:
        base = _base(home)
        setting = Setting(base, home, queries, options.quick, options.load_seconds)
        facts = report.machine_facts(read_meta(base), base)
        parts = [measure(name, setting) for name in PARTS if name in options.only]
    except (BadQueries, BuildFailed, UserError, KBServeError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    text = report.write(options.output, parts, facts)
    print(text)
    if options.misses:
        print("\n\n".join(misses(part) for part in parts if part.name == "retrieval"))
    say(f"written to {options.output / 'bench.md'} and bench.json")
    return 0
