"""Writes stubs as the ``-stubs`` packages of PEP 561: a folder that type checkers find, or a wheel."""

from __future__ import annotations

import base64
import hashlib
import zipfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from kb_build.schema import unpack
from kb_build.symbols.records import Symbol, symbol_from_json
from kb_check.stubs.modules import MARK, Stubs, write_modules
from kb_serve.lookups.base_file import open_file
from simworlds.errors import UserError
from simworlds.files import staged_file, write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

_NAME = "simworlds_bpy_stubs"
# Wheels hold no times of their own, so that the same base gives the same bytes.
_TIME = (1980, 1, 1, 0, 0, 0)


class OutputInTheWay(UserError):  # noqa: N818 - reads as the state it names
    """What is already there would be overwritten."""


@dataclass(frozen=True, slots=True)
class Written:
    """What was written: the version of Blender, the number of files and bytes, and what has no name in Python."""

    blender: str
    files: int
    size: int
    left_out: tuple[str, ...]


def read_symbols(base: Path) -> tuple[str, list[Symbol]]:
    """The version and the symbols of a base. Raises KBServeError, OSError."""
    connection = open_file(base)
    try:
        version = connection.execute("SELECT value FROM meta WHERE name = 'blender'").fetchone()[0]
        rows = connection.execute("SELECT record FROM symbols ORDER BY path")
        return str(version), [symbol_from_json(unpack(row[0])) for row in rows]
    finally:
        connection.close()


def stub_files(stubs: Stubs) -> Iterator[tuple[PurePosixPath, str]]:
    """The files of stubs: (path, text). A package of which nothing is told but what is in it has its mark alone."""
    tops = {module.partition(".")[0] for module in stubs.modules}
    for module, text in sorted({**dict.fromkeys(tops, f"{MARK}\n"), **stubs.modules}.items()):
        top, *rest = module.split(".")
        folder = PurePosixPath(f"{top}-stubs", *rest)
        is_package = module in stubs.packages or not rest
        yield (folder / "__init__.pyi" if is_package else folder.with_name(f"{folder.name}.pyi")), text


def write_folder(base: Path, folder: Path, *, with_docs: bool = False) -> Written:
    """Writes the stubs of a base into a folder, in the place of those that were written there before.

    Other files in their packages stay. Raises OutputInTheWay where a package or a file of another's has the name of one
    of them, and OSError.
    """
    blender, symbols = read_symbols(base)
    stubs = write_modules(symbols, with_docs=with_docs)
    packages: dict[str, dict[PurePosixPath, bytes]] = {}
    for path, text in stub_files(stubs):
        packages.setdefault(path.parts[0], {})[path.relative_to(path.parts[0])] = text.encode()
    former = {name: _former_files(folder / name, files) for name, files in packages.items()}
    for name, files in packages.items():
        for path, data in files.items():
            write_whole(folder / name / path, data, durable=False)
        for path in former[name].difference(files):
            _remove(folder / name, path)
    written = [data for files in packages.values() for data in files.values()]
    return Written(blender, len(written), sum(map(len, written)), tuple(stubs.left_out))


def _former_files(package: Path, files: Iterable[PurePosixPath]) -> set[PurePosixPath]:
    """The files of a package that were written here before.

    Raises OutputInTheWay where the package, or one of ``files`` in it, is another's.
    """
    if package.is_symlink() or (package.exists() and not _is_ours(package / "__init__.pyi")):
        raise OutputInTheWay(f"{package} is there and was not written by simworlds. Choose another folder.")
    for path in files:
        if (package / path).exists() and not _is_ours(package / path):
            raise OutputInTheWay(
                f"{package / path} is there and was not written by simworlds. Move it away, or choose another folder."
            )
    return {
        PurePosixPath(path.relative_to(package).as_posix())
        for path in package.rglob("*.pyi")
        if _is_ours(path)
    }


def _is_ours(file: Path) -> bool:
    try:
        with file.open(encoding="utf-8") as text:
            return text.readline().startswith(MARK)
    except (OSError, UnicodeDecodeError):
        return False


def _remove(package: Path, path: PurePosixPath) -> None:
    """Removes a file of a package, and the folders that are empty without it."""
    (package / path).unlink()
    with suppress(OSError):  # a folder with other files stays
        for folder in path.parents:
            (package / folder).rmdir()


def write_wheel(base: Path, folder: Path, *, with_docs: bool = False) -> tuple[Path, Written]:
    """Writes the stubs of a base as a wheel into a folder; its version is Blender's."""
    blender, symbols = read_symbols(base)
    stubs = write_modules(symbols, with_docs=with_docs)
    contents = {str(path): text.encode() for path, text in stub_files(stubs)}
    info = f"{_NAME}-{blender}.dist-info"
    metadata = (
        f"Metadata-Version: 2.1\nName: {_NAME.replace('_', '-')}\nVersion: {blender}\n"
        f"Summary: Types of Blender {blender}'s Python API, for type checkers and editors\n"
        "License: GPL-3.0-or-later\nRequires-Python: >=3.10\nClassifier: Typing :: Stubs Only\n"
    )
    wheel = "Wheel-Version: 1.0\nGenerator: simworlds\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    contents |= {f"{info}/METADATA": metadata.encode(), f"{info}/WHEEL": wheel.encode()}
    record = "".join(f"{name},sha256={_digest(data)},{len(data)}\n" for name, data in contents.items())
    contents[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / f"{_NAME}-{blender}-py3-none-any.whl"
    with staged_file(target) as staged, zipfile.ZipFile(staged, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in contents.items():
            archive.writestr(zipfile.ZipInfo(name, _TIME), data, zipfile.ZIP_DEFLATED)
    return target, Written(blender, len(contents) - 3, target.stat().st_size, tuple(stubs.left_out))


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
