"""docutils and Sphinx without the work that they repeat for every page and every nested block."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from unittest import mock

import sphinx.util.docutils
from docutils import nodes
from docutils.nodes import Node
from docutils.transforms.references import DanglingReferencesVisitor
from docutils.utils import DependencyList

from kb_build.docutils_states import states_when_entered

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

_REFERENCES = (nodes.reference, nodes.footnote_reference, nodes.citation_reference)
# The classes of all nodes that were put into the tree of the page at hand.
_used: set[type[Node]] = set()


@contextmanager
def less_repeated() -> Generator[None]:
    """Within this context states are made when needed, the settings of pages are worked out once, and trees are put
    together and searched in one go.

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
        mock.patch.object(Node, "setup_child", _set_up_child),
        mock.patch.object(nodes.document, "walk", _walk),
    ):
        yield


def _find(self: Node, cls: type[Node] | tuple[type[Node], ...]) -> Iterator[Node]:
    """This node and all below it that are of a class, in docutils' order.

    Without a generator for every node, through which all that is found below it would pass. Most passes over a page
    look for what it does not have.
    """
    if isinstance(self, cls):
        yield self
    if isinstance(self, nodes.document) and not any(issubclass(used, cls) for used in _used):
        return
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


def begin_page(classes: Iterable[type[Node]] = ()) -> None:
    """Tells that another page is at hand, and the classes of the nodes that its tree has already."""
    _used.clear()
    _used.update(classes)


def classes_of_page() -> frozenset[type[Node]]:
    """The classes of all nodes that were put into the tree of the page at hand."""
    return frozenset(_used)


def _set_up_child(self: Any, child: Any) -> None:
    """What docutils does with a node's new child. It looks for the document, through all that is above, four times."""
    _used.add(type(child))
    child.parent = above = self
    while above is not None and above._document is None:
        above = above.parent
    if above is not None:
        document = child._document = above._document
        if child.source is None:
            child.source = document.current_source
        if child.line is None:
            child.line = document.current_line


def _walk(self: nodes.document, visitor: nodes.NodeVisitor) -> bool:
    """Visits the tree. The visitor that resolves references has nothing to do with other nodes."""
    if not isinstance(visitor, DanglingReferencesVisitor):
        return Node.walk(self, visitor)
    for reference in [*_find(self, _REFERENCES)]:
        visitor.dispatch_visit(reference)
    return False
