"""docutils and Sphinx without the work that they repeat for every page and every nested block."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from unittest import mock

import sphinx.util.docutils
from docutils.utils import DependencyList

from kb_build.docutils_states import states_when_entered

if TYPE_CHECKING:
    from collections.abc import Callable, Generator


@contextmanager
def less_repeated() -> Generator[None]:
    """Within this context states are made when needed, and the settings of pages are worked out once.

    Else docutils makes all states for every list, definition and directive, and Sphinx a parser of command-line
    options for every page: together a third of the time that the manual takes to parse.
    """
    original: Callable[..., Any] = getattr(sphinx.util.docutils, "_get_settings")  # noqa: B009 - private
    known: list[Any] = []

    def get_settings(*components: Any, **given: Any) -> Any:
        # Within one application its parser and its settings are always the same.
        if not known:
            known.append(original(*components, **given))
        settings = known[0].copy()
        settings.record_dependencies = DependencyList()
        return settings

    with states_when_entered(), mock.patch.object(sphinx.util.docutils, "_get_settings", get_settings):
        yield
