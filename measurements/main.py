"""``python -m measurements``: measures retrieval, the knowledge base, servers, builds, Blender, verifier and audits."""

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
from measurements.kept_parts import KeptPart, keep, kept_part, told_by_conditions
from measurements.retrieval import BadQueries, misses
from measurements.setting import BLENDER, QUERIES, REPO, Setting, say
from simworlds.errors import UserError
from simworlds.settings import base_path, home_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

PARTS = (
    *(
        "retrieval",
        "names",
        "recipes",
        "compound",
        "invented",
        "defaults",
        "passages",
        "signatures",
        "history",
        "old_code",
        "usage",
        "expressions",
        "denials",
    ),
    *(
        "steps",
        "check_blender",
        "check_packages",
        "check_truth",
        "check_versions",
        "planted",
        "pyright",
        "migrate",
    ),
    *("latency", "server", "schemas", "builds", "blender", "verifier", "audits"),
)
LONG = ("soak",)  # only where they are asked for
_SETS = ("dev", "check", "blind", "fourth", "fourth_kept", "paraphrases")


def _parts(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    if unknown := [name for name in names if name not in (*PARTS, *LONG)]:
        raise argparse.ArgumentTypeError(f"{', '.join(unknown)}: the parts are {', '.join((*PARTS, *LONG))}")
    return names


def _arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m measurements", description=__doc__)
    parser.add_argument(
        "--only",
        type=_parts,
        default=list(PARTS),
        metavar="PARTS",
        help=f"of {','.join(PARTS)}; or {','.join(LONG)}",
    )
    parser.add_argument(
        "--queries", type=Path, action="append", metavar="FILE",
        help="labelled queries (JSON Lines), repeatable; the first has targets (default: all sets)",
    )  # fmt: skip
    parser.add_argument(
        "--home", type=Path, help="folder of the bases (default: SIMWORLDS_HOME or the user's)"
    )
    parser.add_argument("--quick", action="store_true", help="measure less often, skip what takes long")
    parser.add_argument(
        "--load-seconds",
        type=float,
        default=30.0,
        help="length of the HTTP load, and of each server's soak (default: 30)",
    )
    parser.add_argument(
        "--add",
        action="store_true",
        help="add to the report what earlier runs with the same --output measured of the other parts",
    )
    parser.add_argument("--misses", action="store_true", help="list the queries without a correct answer")
    parser.add_argument("--output", type=Path, default=REPO / "reports", help="folder of the reports")
    return parser.parse_args(words)


def _base(home: Path) -> Path:
    """The base to measure; it is built if missing."""
    base = base_path(home, BLENDER)
    if not base.is_file():
        say(f"no base of Blender {BLENDER} in {home}: building it")
        say(f"built in {run_build(home).wall:.1f} s")
    return base


def measure(name: str, setting: Setting) -> report.ReportPart:
    """Measures one part; its modules are loaded only then."""
    from importlib import import_module  # noqa: PLC0415 - a part that is left out costs nothing

    # Keeps the garbage collector and pending disk writes of earlier parts out of this measurement.
    gc.collect()
    gc.freeze()
    if hasattr(os, "sync"):
        os.sync()
    part = import_module(f"measurements.{name}").measure(setting)
    assert isinstance(part, report.ReportPart)
    return part


def main(given: Sequence[str] | None = None) -> int:
    """Measures the requested parts, prints and writes the report. Returns 0, or 2 after an error.

    A missed target is reported, but is not an error.
    """
    options = _arguments(given)
    home = (options.home or home_folder()).expanduser().absolute()
    queries = tuple(options.queries or (QUERIES / f"{name}.jsonl" for name in _SETS))
    try:
        base = _base(home)
        setting = Setting(base, home, queries, options.quick, options.load_seconds)
        facts = report.machine_facts(read_meta(base), base)
        kept: list[KeptPart] = []
        for name in (*PARTS, *LONG):
            if name in options.only:
                kept.append(keep(options.output, measure(name, setting), facts))
            elif options.add and (earlier := kept_part(options.output, name)) is not None:
                kept.append(earlier)
    except (BadQueries, BuildFailed, UserError, KBServeError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    parts = [one.part for one in kept]
    if options.add:
        facts["measured"] = told_by_conditions(kept)
    text = report.write(options.output, parts, facts)
    print(text)
    if options.misses:
        print("\n\n".join(misses(part) for part in parts if part.name == "retrieval"))
    say(f"written to {options.output / 'bench.md'} and bench.json")
    return 0
