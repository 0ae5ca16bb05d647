"""The uses of all symbols in the scripts that a Blender brings and in the guides; kept for the next build.

What the panels in these scripts ask is read with them: both need to know what the expressions are.
"""

from __future__ import annotations

import contextlib
import gzip
import hashlib
import json
import re
import zlib
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

from kb_build.fingerprint import usage_digest
from kb_build.flow.analysis import analyse
from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import SymbolList
from kb_build.panels import gating, panel_labels
from kb_build.panels.drawn_places import places_in
from kb_build.panels.layout_calls import shows_something
from kb_build.panels.panel_labels import PanelClass, ScriptPanels, ShownProperty, panels_in
from kb_build.usage.examples import Example, Uses, analysed_uses, uses_in
from kb_build.usage.scripts import TEMPLATES, read_script
from simworlds.files import remove_unfinished_files, staged_file
from simworlds.forked import beside
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Sequence
    from pathlib import Path

    from kb_build.pages.page import Page
    from kb_build.symbols.records import Symbol
    from kb_build.usage.scripts import Script

_KEPT = 12
_CODE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_GUIDE_COST = 0.0

Usage = dict[str, Uses]


@dataclass(frozen=True, slots=True)
class ScriptUsage:
    """What scripts tell: the uses of symbols, by property what the panels in them ask (see panels.gating), and what
    these show.
    """

    uses: Usage = field(default_factory=dict[str, Uses])
    gatings: dict[str, gating.Gating] = field(default_factory=dict[str, gating.Gating])
    panels: ScriptPanels = field(default_factory=ScriptPanels)


def usage_file(cache: Path, extract: str, scripts: Sequence[Script]) -> Path:
    """Where the uses in these scripts are kept; the name depends on the scripts, the API and the code that reads them.

    ``extract`` names what Blender said of itself, with the digests of that Blender and of the extractor.
    """
    total = hashlib.sha256(f"{usage_digest()} {extract}".encode())
    for script in scripts:
        total.update(script.name.encode())
        total.update(hashlib.sha256(read_script(script.path).encode(errors="replace")).digest())
    return cache / "usage" / f"{total.hexdigest()[:32]}.json.gz"


@contextlib.contextmanager
def script_usage(
    symbols: Sequence[Symbol], scripts: Sequence[Script], version: str, *, file: Path, jobs: int
) -> Generator[Callable[[], ScriptUsage]]:
    """Reads scripts in other processes meanwhile; gives a function that waits for what they tell.

    It is kept in ``file`` (see usage_file). Where that is not possible, the next build reads them again.
    """
    kept = _kept(file)
    if kept is not None:
        yield lambda: kept
        return
    # Large files first, each to the next process: the shares take about equally long.
    largest_first = sorted(scripts, key=lambda script: -script.path.stat().st_size)
    shares = [largest_first[start::jobs] for start in range(jobs)]
    with contextlib.ExitStack() as stack:
        waiting = [
            stack.enter_context(beside(partial(_read, symbols, share, version))) for share in shares if share
        ]

        def result() -> ScriptUsage:
            parts = [share() for share in waiting]
            usage = ScriptUsage(
                merged(part.uses for part in parts),
                gating.merged(part.gatings for part in parts),
                panel_labels.merged(part.panels for part in parts),
            )
            _keep(usage, file)
            return usage

        yield result


def _read(symbols: Sequence[Symbol], scripts: Iterable[Script], version: str) -> ScriptUsage:
    api = Api(SymbolList(symbols))
    numbers = version_key(version)
    uses: list[Usage] = []
    gatings: list[dict[str, gating.Gating]] = []
    panels: list[ScriptPanels] = []
    for script in scripts:
        code = read_script(script.path)
        analysis = analyse(code, api, numbers)
        uses.append(analysed_uses(analysis, code, script.name, api, script.cost))
        if shows_something(code) and not script.name.startswith(TEMPLATES):
            gatings.append(gating.gatings_in(places_in(analysis, api.symbols), api.symbols))
            panels.append(panels_in(analysis))
    return ScriptUsage(merged(uses), gating.merged(gatings), panel_labels.merged(panels))


def page_usage(symbols: Sequence[Symbol], pages: Iterable[Page], version: str) -> Usage:
    """The uses in the code of the guides."""
    api = Api(SymbolList(symbols))
    numbers = version_key(version)
    return merged(
        uses_in(code, page.slug, api, numbers, _GUIDE_COST)
        for page in pages
        if page.source == "guide"
        for section in page.sections
        for code in _CODE.findall(section.text)
    )


def merged(parts: Iterable[Usage]) -> Usage:
    """The uses in several files together."""
    usage: Usage = {}
    for part in parts:
        for path, uses in part.items():
            if path in usage:
                usage[path].add(uses)
            else:
                usage[path] = uses
    return usage


def with_aliases(usage: Usage, symbols: Iterable[Symbol]) -> Usage:
    """The same with the second names of context members: ``bpy.context.object`` is ``bpy.types.Context.object``."""
    aliases = {
        symbol.path: symbol.same_as
        for symbol in symbols
        if symbol.kind == "context" and symbol.path not in usage
    }
    return {**usage, **{path: usage[other] for path, other in aliases.items() if other in usage}}


def _kept(path: Path) -> ScriptUsage | None:
    try:
        with gzip.open(path, "rt", encoding="utf-8") as file:
            kept = json.load(file)
        uses = {
            name: Uses(count, files, [Example(*example) for example in examples])
            for name, (count, files, examples) in kept["uses"].items()
        }
        gatings = {name: gating.from_rows(rows) for name, rows in kept["gatings"].items()}
        classes, shown = kept["panels"]
        panels = ScriptPanels([PanelClass(*row) for row in classes], [ShownProperty(*row) for row in shown])
        return ScriptUsage(uses, gatings, panels)
    except (OSError, EOFError, zlib.error, ValueError, TypeError, KeyError):
        return None


def _keep(usage: ScriptUsage, path: Path) -> None:
    uses = {
        name: (uses.count, uses.files, [(e.cost, e.file, e.line, e.code) for e in uses.examples])
        for name, uses in usage.uses.items()
    }
    gatings = {name: gating.to_rows(found) for name, found in usage.gatings.items()}
    rows = {"uses": uses, "gatings": gatings, "panels": usage.panels}
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        remove_unfinished_files(path.parent)
        with staged_file(path) as part, gzip.open(part, "wt", encoding="utf-8", compresslevel=1) as file:
            file.write(json.dumps(rows, ensure_ascii=False))  # json.dump is the slower one
        for old in sorted(path.parent.glob("*.json.gz"), key=lambda one: one.stat().st_mtime)[:-_KEPT]:
            old.unlink(missing_ok=True)
