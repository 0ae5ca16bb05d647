"""The steps of a build, in order; an unchanged base is not built again."""

from __future__ import annotations

import gc
import json
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from kb_build.base_file import read_meta, refuse_folder
from kb_build.blender.extractor import extract_api
from kb_build.digests import Digests
from kb_build.errors import ExtractError, SourceError, StoreError
from kb_build.fingerprint import base_fingerprint, extractor_digest, runtime_digest
from kb_build.pages.sources import Origin, find_sources
from simworlds.files import remove_unfinished_files
from simworlds.forked import beside
from simworlds.installed import own_version
from simworlds.releases import ROLES, minor_of
from simworlds.sandbox.runtime import find_runtime
from simworlds.settings import base_path, cache_folder, summaries_path
from simworlds.terminal.progress import silent

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping, Sequence

    from kb_build.blender.extract_reader import Extract
    from kb_build.pages.page import Page
    from kb_build.pages.reading import PageReader
    from kb_build.pages.sources import DocumentationSource, MissingSource
    from kb_build.summaries.types import SummaryReport, SummaryRun
    from kb_build.symbols.tables import SymbolTables
    from kb_build.usage.usage_index import ScriptUsage
    from kb_build.versions.removed_symbols import RemovedSymbols
    from simworlds.sandbox.runtime import Runtime
    from simworlds.terminal.progress import Progress

SummaryMethod = Literal["shipped", "extractive", "claude", "none"]
_LOADED_AHEAD = (
    "kb_build.blender.extract_reader",
    "kb_build.summaries.methods",
    "kb_build.symbols.tables",
    "kb_build.usage.usage_index",
)


@dataclass(frozen=True, slots=True)
class BuildOptions:
    """What to build from and how.

    ``blender_exe``, ``manual``, ``guides`` and ``corpora`` are paths; ``require`` names roles whose absence
    is an error; ``max_cost`` (US dollars) and ``model`` are for Claude's summaries, None for their defaults;
    ``fresh`` downloads documentation again that was downloaded before; ``output`` is the base's file (default: in
    the home folder, named after the version).
    """

    blender_exe: Path | None = None
    manual: Path | None = None
    guides: Path | None = None
    corpora: Path | None = None
    pages: bool = True
    summaries: SummaryMethod = "shipped"
    max_cost: float | None = None
    model: str | None = None
    require: frozenset[str] = frozenset()
    jobs: int = 2
    force: bool = False
    offline: bool = False
    fresh: bool = False
    output: Path | None = None


@dataclass(frozen=True, slots=True)
class BuildReport:
    """The outcome of a build. ``meta`` are the base's facts; ``seconds`` is wall time."""

    path: Path
    version: str
    built: bool
    seconds: float
    meta: Mapping[str, str]
    missing: tuple[MissingSource, ...] = ()
    warnings: tuple[str, ...] = ()
    summaries: SummaryReport | None = None


@dataclass(slots=True)
class _Build:
    """One build under way."""

    options: BuildOptions
    home: Path
    progress: Progress
    runtime: Runtime
    sources: Sequence[DocumentationSource] = ()
    missing: Sequence[MissingSource] = ()
    warnings: list[str] = field(default_factory=list[str])

    @property
    def path(self) -> Path:
        return self.options.output or base_path(self.home, self.runtime.version)


def build(
    version: str | None, *, options: BuildOptions, home: Path, progress: Progress = silent
) -> BuildReport:
    """Builds the base of a Blender version, unless it is up to date.

    ``version`` is ``"5.1"``, ``"5.1.2"`` or None for the Blender at hand. The old base answers until the new
    one is whole, whatever happens, and one with pages that can no longer be found stays unless ``force``. Raises
    KBBuildError.
    """
    began = time.perf_counter()
    runtime = find_runtime(version, home=home, blender_exe=options.blender_exe, progress=progress)
    work = _Build(options, home, progress, runtime)
    refuse_folder(work.path)
    before = _sources_before(work.path)
    _find_sources(work, before)
    _keep_fuller(work, before)
    fingerprint = _fingerprint(work)
    remove_unfinished_files(work.path.parent)
    meta = None if options.force else _present(work.path, fingerprint)
    if meta is not None:
        return _report(work, began, meta, built=False)
    with _paused_collector(), _page_reader(work) as reader:
        ahead = threading.Thread(target=_load_ahead, daemon=True)
        ahead.start()
        extract = _extract(work)
        ahead.join()
        # The index needs pages first and scripts last: these are read while pages are, and while the index is made.
        with _script_usage(work, extract) as scripts:
            pages = _pages(work, reader.result(), extract)
            run = _summaries(work, pages)
            meta = _meta(work, extract, pages, run) | {"fingerprint": fingerprint}
            with (
                beside(partial(_removed_symbols, extract)) as removed_symbols,
                beside(partial(_symbol_tables, extract, pages, scripts)) as tables,
            ):
                from kb_build.blender.buttons import operator_buttons  # noqa: PLC0415 - not when nothing changed
                from kb_build.recipes.tables import recipes_for  # noqa: PLC0415 - likewise
                from kb_build.store import Contents, write_base  # noqa: PLC0415 - likewise

                work.progress(f"Writing {work.path.name}", 0, None)
                contents: Contents = Contents(
                    symbols=extract.symbols,
                    pages=pages,
                    links=extract.links,
                    meta=meta,
                    summaries=run.by_slug if run else {},
                    still_works=extract.still_works,
                    removed_symbols=removed_symbols,
                    tables=tables,
                    buttons=operator_buttons(Path(extract.scripts)) if extract.scripts else {},
                    recipes=recipes_for(meta["minor"]),
                )
                write_base(work.path, contents)
    return _report(work, began, meta, built=True, run=run)


@contextmanager
def _paused_collector() -> Generator[None]:
    """Pauses garbage collection: records have no cycles and live to the end, and collecting costs a second."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def _keep_fuller(work: _Build, before: Mapping[str, Origin]) -> None:
    """Refuses to replace a base that has pages by one that would lack them."""
    lost = [missing for missing in work.missing if missing.role in before]
    if not lost or work.options.force:
        return
    roles = " and ".join(missing.role for missing in lost)
    raise SourceError(
        f"{work.path} has pages of the {roles}, and a new base would have none: it is kept as it is. "
        f"{'; '.join(missing.reason for missing in lost)}. To build without these pages all the same, add --force"
    )


def _find_sources(work: _Build, before: Mapping[str, Origin]) -> None:
    options = work.options
    if not options.pages:
        return
    work.sources, work.missing = find_sources(
        work.runtime.version,
        cache=cache_folder(work.home),
        manual=options.manual,
        guides=options.guides,
        corpora=options.corpora,
        before=before,
        allow_download=not options.offline,
        fresh=options.fresh,
        progress=work.progress,
    )
    for missing in work.missing:
        if missing.role in options.require:
            raise SourceError(
                f"{missing.reason}. It was required (--require {missing.role}); the old base is kept"
            )
        work.warnings.append(missing.reason)
    minor = minor_of(work.runtime.version)
    for source in work.sources:
        if source.passed_over:
            work.warnings.append(
                f"the {source.role} at {source.origin} was read without {source.passed_over}"
            )
        if source.version != minor:
            work.warnings.append(
                f"the {source.role} at {source.origin} is of Blender {source.version}, not {minor}: answers "
                "drawn from it will say so"
            )


def _sources_before(path: Path) -> dict[str, Origin]:
    """Role → where the present base's pages came from."""
    try:
        rows = json.loads(read_meta(path).get("sources", "[]"))
        return {row["role"]: Origin(Path(row["origin"]), bool(row["given"])) for row in rows}
    except (StoreError, ValueError, TypeError, KeyError):
        return {}


def _fingerprint(work: _Build) -> str:
    digests = Digests(cache_folder(work.home) / "digests.json")
    runtime = runtime_digest(work.runtime, digests)
    digests.save()
    return base_fingerprint(runtime, work.sources, work.missing, _choices(work.options))


def _choices(options: BuildOptions) -> dict[str, Any]:
    """The options that shape a base."""
    claude = options.summaries == "claude"
    return {
        "pages": options.pages,
        "summaries": options.summaries,
        "model": options.model if claude else None,
        "max_cost": options.max_cost if claude else None,
    }


def _present(path: Path, fingerprint: str) -> dict[str, str] | None:
    """The meta of the base at ``path`` if it has this fingerprint."""
    try:
        meta = read_meta(path)
    except StoreError:
        return None
    return meta if meta.get("fingerprint") == fingerprint else None


def _page_reader(work: _Build) -> PageReader:
    from kb_build.pages.reading import PageReader  # noqa: PLC0415 - not needed when nothing changed

    return PageReader(work.sources, cache_folder(work.home), jobs=work.options.jobs, progress=work.progress)


def _load_ahead() -> None:
    """Imports the modules of later steps while Blender is running."""
    for name in _LOADED_AHEAD:
        import_module(name)


def _extract(work: _Build) -> Extract:
    runtime = work.runtime
    file = extract_api(runtime, home=work.home, again=work.options.force, progress=work.progress)
    from kb_build.blender.extract_reader import read_extract  # noqa: PLC0415 - loaded ahead
    from kb_build.summaries.functions import with_function_summaries  # noqa: PLC0415 - not when nothing changed
    from kb_build.versions.disused import (  # noqa: PLC0415 - not when nothing changed
        with_later_ways,
        with_present_ways,
        without_effect,
    )
    from kb_build.versions.successors import load_successors  # noqa: PLC0415 - likewise
    from kb_build.versions.unlisted_values import with_values_until  # noqa: PLC0415 - likewise

    work.progress("Reading Blender's answer", 0, None)
    try:
        extract = read_extract(file)
    except ExtractError:
        file.unlink(missing_ok=True)
        raise
    except (
        ValueError,
        LookupError,
        TypeError,
        AttributeError,
    ) as error:  # no text, or records of another shape
        file.unlink(missing_ok=True)
        raise ExtractError(
            f"{file} is damaged ({type(error).__name__}: {error}) and was removed; run the build again, which asks "
            "Blender anew"
        ) from error
    kinds = {symbol.kind for symbol in extract.symbols}
    if not {"class", "operator", "property"} <= kinds:
        reason = extract.faults[0] if extract.faults else "it named no reason"
        file.unlink(missing_ok=True)
        raise ExtractError(f"Blender {runtime.version} did not describe its classes or operators: {reason}")
    if minor_of(extract.version) != minor_of(runtime.version):
        raise ExtractError(
            f"{runtime.executable} is Blender {extract.version}, not {runtime.version}, as expected"
        )
    work.warnings += [
        f"a part of Blender {extract.version} could not be described: {fault.strip().splitlines()[-1]} "
        f"(step {fault.partition(':')[0]}; the whole traceback is in the base: simworlds kb info --json)"
        for fault in extract.faults
    ]
    table, minor = load_successors(), minor_of(extract.version)
    symbols = with_present_ways(without_effect(extract.symbols, table, minor), table, minor)
    symbols = with_later_ways(symbols, table, minor)
    symbols = with_values_until(symbols, table, minor)
    if work.options.summaries in {"shipped", "claude"}:
        symbols = with_function_summaries(symbols)
    return replace(extract, symbols=tuple(symbols))


@contextmanager
def _script_usage(work: _Build, extract: Extract) -> Generator[Callable[[], ScriptUsage]]:
    """Reads Blender's own scripts meanwhile; gives a function that waits for the uses of symbols there."""
    from kb_build.usage.scripts import blender_scripts  # noqa: PLC0415 - not when nothing changed
    from kb_build.usage.usage_index import script_usage, usage_file  # noqa: PLC0415 - loaded ahead

    scripts = list(blender_scripts(Path(extract.scripts))) if extract.scripts else []
    digests = Digests(cache_folder(work.home) / "digests.json")
    identity = f"{extract.version} {runtime_digest(work.runtime, digests)} {extractor_digest()}"
    file = usage_file(cache_folder(work.home), identity, scripts)
    jobs = work.options.jobs
    with script_usage(extract.symbols, scripts, extract.version, file=file, jobs=jobs) as result:
        yield result


def _symbol_tables(
    extract: Extract, pages: Sequence[Page], scripts: Callable[[], ScriptUsage]
) -> SymbolTables:
    """What a base has of its symbols, with their uses in Blender's scripts and in the guides, the ways to instances
    that follow from these, and what settings depend on.
    """
    from kb_build.blender.access_paths import reached_expressions  # noqa: PLC0415 - not when nothing changed
    from kb_build.flow.blender.symbols import SymbolList  # noqa: PLC0415 - loaded ahead
    from kb_build.panels.conditions import panel_conditions  # noqa: PLC0415 - not when nothing changed
    from kb_build.panels.gating import settled  # noqa: PLC0415 - loaded ahead
    from kb_build.panels.idle import idle_conditions  # noqa: PLC0415 - likewise
    from kb_build.panels.panel_labels import labels_of  # noqa: PLC0415 - loaded ahead
    from kb_build.symbols.tables import symbol_tables  # noqa: PLC0415 - likewise
    from kb_build.usage.examples import SymbolUsage  # noqa: PLC0415 - loaded ahead
    from kb_build.usage.usage_index import merged, page_usage, with_aliases  # noqa: PLC0415 - loaded ahead

    symbols = extract.symbols

    def used() -> SymbolUsage:
        guides = page_usage(symbols, pages, extract.version)
        found = scripts()
        uses = with_aliases(merged([found.uses, guides]), symbols)
        counts = {path: found.count for path, found in uses.items()}
        reached = reached_expressions(symbols, counts, extract.names, extract.places)
        listed = SymbolList(symbols)
        return SymbolUsage(
            uses,
            {f"bpy.types.{name}": expression for name, expression in reached.items()},
            extract.names,
            [*panel_conditions(settled(found.gatings, listed), listed), *idle_conditions(extract.idle)],
            labels_of(found.panels),
        )

    return symbol_tables(symbols, pages, used)


def _pages(work: _Build, read: Mapping[str, list[Page]], extract: Extract) -> list[Page]:
    """All pages, one for each slug; of two with the same one, the manual's stays."""
    kept: dict[str, Page] = {}
    for page in (*(page for role in ROLES for page in read.get(role, ())), *extract.templates):
        if page.slug in kept:
            work.warnings.append(f"two pages are called {page.slug}; the {page.source}'s was left out")
        else:
            kept[page.slug] = page
    return list(kept.values())


def _summaries(work: _Build, pages: Sequence[Page]) -> SummaryRun | None:
    method = work.options.summaries
    if method == "none":
        return None
    from kb_build.summaries.methods import summarise  # noqa: PLC0415 - loaded ahead

    work.progress("Summarising pages", 0, None)
    if method != "claude":
        return summarise(pages, method=method)
    from kb_build.summaries.store import SummaryStore  # noqa: PLC0415 - only here
    from kb_build.summaries.types import ClaudeOptions  # noqa: PLC0415 - only here

    choices = {"model": work.options.model, "max_cost": work.options.max_cost}
    claude = ClaudeOptions(**{name: value for name, value in choices.items() if value is not None})  # pyright: ignore[reportArgumentType]

    def step(done: int, total: int, message: str) -> None:
        work.progress(message, done, total or None)

    return summarise(
        pages, method=method, store=SummaryStore(summaries_path(work.home)), options=claude, progress=step
    )


def _meta(work: _Build, extract: Extract, pages: Sequence[Page], run: SummaryRun | None) -> dict[str, str]:
    from kb_build.base_facts import counts, source_facts, summary_facts  # noqa: PLC0415 - not when nothing changed

    structured = {
        "sources": [source_facts(source, pages) for source in work.sources],
        "missing": [{"role": missing.role, "reason": missing.reason} for missing in work.missing],
        "options": _choices(work.options),
        "counts": counts(extract, pages),
        "faults": list(extract.faults),
        "addons": list(extract.addons),
        "addon_names": extract.addon_names,
        "summaries": summary_facts(run),
        "page_warnings": {page.slug: list(page.warnings) for page in pages if page.warnings},
        "runtime": {
            "kind": work.runtime.kind,
            "executable": str(work.runtime.executable),
            "scripts": extract.scripts,
        },
    }
    return {
        "blender": extract.version,
        "minor": minor_of(extract.version),
        "build_hash": extract.build,
        "built_at": datetime.now(UTC).isoformat(timespec="seconds"),
        "simworlds": own_version(),
        **{name: json.dumps(value, ensure_ascii=False) for name, value in structured.items()},
    }


def _removed_symbols(extract: Extract) -> RemovedSymbols:
    from kb_build.versions.history import ApiHistory, history_paths  # noqa: PLC0415
    from kb_build.versions.removed_symbols import find_removed_symbols  # noqa: PLC0415 - not when nothing changed

    history = ApiHistory.load().including(extract.version, history_paths(extract))
    return find_removed_symbols(extract.symbols, history, minor_of(extract.version))


def _report(
    work: _Build, began: float, meta: dict[str, str], *, built: bool, run: SummaryRun | None = None
) -> BuildReport:
    return BuildReport(
        path=work.path,
        version=meta["blender"],
        built=built,
        seconds=time.perf_counter() - began,
        meta=meta,
        missing=tuple(work.missing),
        warnings=tuple(work.warnings),
        summaries=run.report if run else None,
    )
