# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON Lines on a file of its own: Blender prints on stdout, so nothing else may travel there."""

import json
import math

UNLIMITED_FLOAT = 3.4e38
UNLIMITED_INT = 2**31 - 1


def limit(value):
    """A range's bound, or None where Blender's number only means "no bound"."""
    if isinstance(value, float):
        if not math.isfinite(value) or abs(value) >= UNLIMITED_FLOAT:
            return None
        return plain_float(value)
    return None if abs(value) >= UNLIMITED_INT else value


def plain_float(value):
    """A single-precision number as a person would write it: 0.1, not 0.10000000149011612."""
    if not math.isfinite(value):
        return str(value)
    short = float(f"{value:.7g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


def plain(value):
    """Any default value in JSON's terms; what JSON cannot say becomes its Python spelling."""
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return plain_float(value)
    if isinstance(value, (set, frozenset)):
        return sorted(plain(item) for item in value)
    if isinstance(value, (list, tuple)) or hasattr(value, "__len__"):
        return [plain(item) for item in value]
    return repr(value)


class Writer:
    """Writes one record a line to a file, leaving out what holds nothing."""

    def __init__(self, file):
        self._file = file
        self._encode = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode
        self.count = 0

    def __call__(self, record, **values):
        row = {"record": record}
        row.update(
            (key, value) for key, value in values.items() if value is not None and value not in ("", [], ())
        )
        self.lines([self._encode(row)])

    def lines(self, encoded):
        """Writes records that another writer wrote, a text each."""
        self._file.writelines(line + "\n" for line in encoded)
        self.count += len(encoded)

    def flush(self):
        """Puts what was written on disk, whatever happens to this process."""
        self._file.flush()

    def close(self):
        self._file.close()
