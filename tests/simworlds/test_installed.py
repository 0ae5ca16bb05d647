"""What is told of installed packages, in an environment that lacks them too."""

from __future__ import annotations

from importlib import metadata

import pytest

from simworlds.installed import installed_version, own_version


def test_the_version_of_a_package_is_told() -> None:
    assert installed_version("pytest") == pytest.__version__
    assert installed_version("no-such-package") is None


def test_run_from_its_source_it_has_an_unknown_version(monkeypatch: pytest.MonkeyPatch) -> None:
    def distribution(name: str) -> metadata.Distribution:
        raise metadata.PackageNotFoundError(name)

    assert own_version() == metadata.version("simworlds")
    monkeypatch.setattr(metadata, "distribution", distribution)
    assert own_version() == "unknown"
