"""docutils and Sphinx without the work that they repeat for every page and every nested block."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from unittest import mock

import sphinx.util.docutils
from docutils.nodes import Node
from docutils.utils import DependencyList

from kb_build.docutils_states import states_when_entered

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator


@contextmanager
def less_repeated() -> Generator[None]:
    """Within this context states are made when needed, the settings of pages are worked out once, and trees are
    searched in one go.

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

    with (
        states_when_entered(),
        mock.patch.object(sphinx.util.docutils, "_get_settings", get_settings),
        mock.patch.object(Node, "_fast_findall", _find),
    ):
        yield


def _find(self: Node, cls: type[Node] | tuple[type[Node], ...]) -> Iterator[Node]:
    """This node and all below it that are of a class, in docutils' order.

    Without a generator for every node, through which all that is found below it would pass.
    """
    if isinstance(self, cls):
        yield self
    levels = [iter(self.children)]
    while levels:
        for node in levels[-1]:
            if isinstance(node, cls):
                yield node
            if node.children:
                levels.append(iter(node.children))
                break
        else:
            levels.pop()
