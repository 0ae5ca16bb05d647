"""Makes the files of the history from every available Blender; keeps other versions from the old files."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.blender.extract_reader import read_extract
from kb_build.blender.extractor import extract_api
from kb_build.errors import ExtractError, KBBuildError, StoreError
from kb_build.versions.history import ApiHistory, history_paths, is_from_stubs
from kb_build.versions.history_merge import merge_versions
from kb_build.versions.socket_places import PLACES_FILE, SocketPlaces
from kb_build.versions.socket_places import places_of as socket_places
from simworlds.errors import UserError
from simworlds.files import staged_file
from simworlds.releases import minor_of, version_key
from simworlds.sandbox.runtime import find_runtime
from simworlds.terminal.progress import silent

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract
    from kb_build.versions.socket_places import Places
    from kb_build.versions.stub_check import Agreement
    from simworlds.sandbox.runtime import Runtime
    from simworlds.terminal.progress import Progress

# A version that lost more than this share of its symbols lost them to a fault, not to a new patch release.
_KEPT_SHARE = 0.98


@dataclass(frozen=True, slots=True)
class HistoryReport:
    """The outcome of a run.

    ``extracted`` and ``kept`` (taken over from the old file) are full versions; ``missing`` versions or executables →
    why they were not available (a kept version may be among them); ``faults`` are steps that failed inside Blender;
    ``from_stubs`` are versions that were read from stubs;
    ``written`` is False when the file was up to date; ``agreement`` is how well stubs that were read hold (by kind).
    """

    path: Path
    written: bool
    extracted: tuple[str, ...]
    kept: tuple[str, ...]
    symbols: int
    size: int
    missing: Mapping[str, str] = field(default_factory=dict[str, str])
    faults: tuple[str, ...] = ()
    from_stubs: tuple[str, ...] = ()
    agreement: Mapping[str, Agreement] = field(default_factory=dict[str, "Agreement"])


def build_history(  # noqa: PLR0913 - all but the first are named
    versions: Sequence[str],
    *,
    home: Path,
    output: Path,
    blender_exes: Sequence[Path] = (),
    stubs: Path | None = None,
    force: bool = False,
    progress: Progress = silent,
) -> HistoryReport:
    """Extracts ``versions`` (and whatever the executables are) and writes their history to ``output``.

    The places of sockets (see socket_places) are written beside it.
    Extracts lie in ``home``: a run that was stopped goes on where it was. Versions that only the old file
    knows are kept; so are those that cannot be had now. ``stubs`` is a folder of folders ``2.79``,
    ``2.80`` …, each with that version's stubs: they tell of the versions that no Blender does. Raises StoreError
    rather than replacing an old file that cannot be read, or says more of a version, unless ``force``; and
    KBBuildError when no version could be had.
    """
    old = _old(output, force)
    paths, places, missing, faults = _collect(versions, blender_exes, home, progress)
    if not paths and (stubs is None or old is None):
        reasons = "; ".join(f"{version}: {reason}" for version, reason in missing.items())
        raise KBBuildError(f"no Blender was available; {output} is unchanged. {reasons}")
    extracted = tuple(paths)
    kept: tuple[str, ...] = ()
    doubted: dict[str, set[str]] = {}
    if old is not None:
        kept = _keep(old, paths)
        doubted = _doubted(old, paths, kept)
        if not force:
            _refuse_poorer(old, {patch: paths[patch] for patch in extracted}, output)
    agreement: dict[str, Agreement] = {}
    if stubs is not None:
        agreement = _read_stubs(stubs, paths, progress)
    progress("Writing the history", 0, None)
    history = merge_versions(paths, doubted)
    data = history.to_bytes()
    written = old != history
    if written:
        _write(output, data)
    written = _write_places(output.with_name(PLACES_FILE.name), places, kept) or written
    return HistoryReport(
        path=output,
        written=written,
        extracted=tuple(sorted(extracted, key=version_key)),
        kept=tuple(patch for patch in kept if stubs is None or not is_from_stubs(patch)),
        from_stubs=() if stubs is None else tuple(filter(is_from_stubs, history.patches)),
        symbols=len(set().union(*paths.values())),
        size=len(data),
        missing=missing,
        faults=tuple(faults),
        agreement=agreement,
    )


def _read_stubs(folder: Path, paths: dict[str, set[str]], progress: Progress) -> dict[str, Agreement]:
    """Adds what the stubs tell of versions that no Blender does; returns how well they hold for the others."""
    from kb_build.versions.stub_check import kept_stubs  # noqa: PLC0415 - most runs read none
    from kb_build.versions.stub_reader import read_stubs  # noqa: PLC0415

    folders = sorted(folder.glob("[0-9]*.[0-9]*"), key=lambda entry: version_key(entry.name))
    if not folders:
        raise KBBuildError(f"{folder} has no folders that are named after versions, such as 2.79")
    stubs: dict[str, set[str]] = {}
    for number, entry in enumerate(folders):
        progress(f"Stubs of {entry.name}", number, len(folders))
        stubs[entry.name] = read_stubs(entry)
    for version in [version for version in paths if is_from_stubs(version)]:
        del paths[version]
    asked = {minor_of(version): found for version, found in paths.items()}
    kept, agreement = kept_stubs(stubs, asked)
    paths.update(kept)
    return agreement


def _old(output: Path, force: bool) -> ApiHistory | None:
    if not output.is_file():
        return None
    try:
        return ApiHistory.load(output)
    except StoreError:
        if force:
            return None
        raise


def _collect(
    versions: Sequence[str], blender_exes: Sequence[Path], home: Path, progress: Progress
) -> tuple[dict[str, set[str]], dict[str, Places], dict[str, str], list[str]]:
    """(full version → paths, → places of sockets, what is missing → why, faults), each Blender asked in turn."""
    wanted: list[tuple[str, str | None, Path | None]] = [(version, version, None) for version in versions]
    wanted += [(str(executable), None, executable) for executable in blender_exes]
    paths_of: dict[str, set[str]] = {}
    places_of: dict[str, Places] = {}
    missing: dict[str, str] = {}
    faults: list[str] = []
    for number, (name, version, executable) in enumerate(wanted):
        progress(f"Blender {name}", number, len(wanted))
        try:
            runtime = find_runtime(version, home=home, blender_exe=executable, progress=progress)
            extract = _extract(runtime, home, progress)
        except UserError as error:
            missing[name] = str(error)
            continue
        if extract.faults:
            faults += [f"Blender {extract.version}: {fault}" for fault in extract.faults]
            missing[name] = (
                f"{len(extract.faults)} step(s) of the extraction failed: what it lacks may well exist"
            )
            continue
        same = next(
            (patch for patch in paths_of if minor_of(patch) == minor_of(runtime.version)),
            None,
        )
        if same is None or version_key(same) < version_key(runtime.version):
            paths_of.pop(same or "", None)
            places_of.pop(same or "", None)
            paths_of[runtime.version] = set(history_paths(extract))
            places_of[runtime.version] = socket_places(extract.symbols)
    return paths_of, places_of, missing, faults


def _extract(runtime: Runtime, home: Path, progress: Progress) -> Extract:
    """What one Blender says; a file that turns out unreadable is made once more."""
    file = extract_api(runtime, home=home, progress=progress)
    try:
        return read_extract(file)
    except ExtractError:
        return read_extract(extract_api(runtime, home=home, again=True, progress=progress))


def _keep(old: ApiHistory, paths: dict[str, set[str]]) -> tuple[str, ...]:
    """Adds to ``paths`` what only the old file knows; returns those full versions."""
    known = {minor_of(version) for version in paths}
    kept = tuple(patch for patch in old.patches if minor_of(patch) not in known)
    for patch in kept:
        paths[patch] = set(old.paths(patch))
    return kept


def _doubted(old: ApiHistory, paths: Mapping[str, set[str]], kept: Sequence[str]) -> dict[str, set[str]]:
    """Kept version → the paths of which it is not known whether it has them: those of which the old file says so, and
    those that other versions are only now known to have, so that an older extractor may have passed them over.
    """
    asked = [patch for patch in paths if patch not in kept and minor_of(patch) in old.versions]
    now = set[str]().union(*(paths[patch] - set(old.paths(patch)) for patch in asked))
    return {patch: (now | {*old.doubted(patch)}) - paths[patch] for patch in kept if not is_from_stubs(patch)}


def _refuse_poorer(old: ApiHistory, extracted: Mapping[str, set[str]], output: Path) -> None:
    for version, paths in extracted.items():
        before = set(old.paths(version))
        if len(paths) < _KEPT_SHARE * len(before):
            lost = ", ".join(sorted(before - paths)[:5])
            raise StoreError(
                f"{output} knows {len(before)} symbols of Blender {minor_of(version)}, the new extract only "
                f"{len(paths)} (lost: {lost}, …). The file is unchanged; --force replaces it"
            )


def _write_places(output: Path, places: Mapping[str, Places], kept: Sequence[str]) -> bool:
    """Writes the places of sockets, with those of kept versions from the old file; whether anything was new."""
    old = SocketPlaces.load(output) if output.is_file() else SocketPlaces({})
    known = {version: rows for version, rows in old.versions.items() if version in kept}
    text = SocketPlaces({**known, **places}).to_text()
    if text == old.to_text():
        return False
    _write(output, text.encode())
    return True


def _write(output: Path, data: bytes) -> None:
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        with staged_file(output) as part:
            part.write_bytes(data)
    except OSError as error:
        raise StoreError(
            f"{output} cannot be written: {error}. The old one, if any, is unchanged."
        ) from error
