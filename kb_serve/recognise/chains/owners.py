"""Which classes a variable may be of whose name does not tell: those that have the member that is read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_serve.recognise.chains.chains import ChainStep
from kb_serve.recognise.chains.variables import classes_of_parts, usual_classes, variable_fit

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain

# Fit of the class that is likeliest meant by a member, for a variable whose name tells nothing; and of one that a part
# of the name, or what the member is set to, tells.
TOLD_BY_MEMBER, _TOLD_BY_PART = 0.2, 0.28
_NAMED_SO = 0.6  # of a class whose name or label has the variable's words, and that has the member
_NODE_NAMED_SO = 0.93  # … of a node that has the very socket
_TEXTURE_NAMED_SO = 0.91  # … of an old texture's node: less than of what scripts use a name for besides
_NAMED_ALIKE = 0.3  # share of a name's fit that counts beside the member
_OF_TEXTURES = "bpy.types.TextureNode"
_LETTERS = 2  # of a word that tells nothing
_MOST_READ = 60
_MOST_TOLD = 8  # classes that a member alone may mean


class Owners:
    """The classes of one base by their members."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def of(self, chain: Chain) -> Iterator[tuple[str, float]]:
        """(class, fit) for the classes that have the first attribute of a chain as a member of their own."""
        name = next(iter(chain.attributes), "")
        parts, taking = classes_of_parts(chain.root), self._taking(chain, name)
        named = [set(words(cls.rpartition(".")[2])) for cls in usual_classes(chain.root)]
        is_class = chain.root[:1].isupper()  # misspelt, or of the script: a member does not tell it
        variable = frozenset[str]() if is_class else _told_by(chain.root)
        for rank, owner in enumerate(self._having(name)):
            own = set(words(owner.name))
            is_part = any(part <= own for part in named)
            is_told = is_part or owner.path in taking or self._is_one_of(owner.path, parts)
            told = 0.0 if is_class else _TOLD_BY_PART if is_told else TOLD_BY_MEMBER
            fit = max(told - 0.001 * rank, _NAMED_ALIKE * variable_fit(chain.root, owner.name))
            if variable and variable <= own.union(words(owner.label)):
                fit = _NAMED_SO - 0.001 * rank
            # Where a chain goes on, what follows tells which one is meant.
            if rank < _MOST_TOLD or fit > TOLD_BY_MEMBER or len(chain.steps) > 1:
                yield owner.path, fit

    def with_socket(self, chain: Chain) -> Iterator[tuple[str, float]]:
        """(class, fit) for the nodes that have the socket which a chain begins with, and the variable's words in their
        name: ``voronoi.inputs["Randomness"]``.
        """
        match chain.steps:
            case (ChainStep(text="inputs" | "outputs"), ChainStep(kind="key", text=name), *_):
                sockets = [entry for entry in self._reader.names.by_name(name) if entry.kind == "socket"]
            case _:
                return
        self._reader.entry.load(entry.owner for entry in sockets)
        variable = _told_by(chain.root)
        shared = {
            socket.owner: len(variable & _words_of(node))
            for socket in self.likeliest_sockets(sockets)
            if (node := self._reader.entry(socket.owner))
        }
        fitting = sorted((node for node in shared if shared[node]), key=lambda node: -shared[node])
        for rank, node in enumerate(fitting):
            named_so = _TEXTURE_NAMED_SO if node.startswith(_OF_TEXTURES) else _NODE_NAMED_SO
            yield node, (named_so if shared[node] == len(variable) else _TOLD_BY_PART) - 0.001 * rank

    def likeliest_sockets(self, sockets: Sequence[SymbolEntry]) -> Sequence[SymbolEntry]:
        """Sockets of one name, those first that are likeliest meant: of used nodes, and not of old textures."""
        return sorted(self.heaviest(sockets), key=lambda entry: entry.owner.startswith(_OF_TEXTURES))

    def heaviest(self, members: Sequence[SymbolEntry]) -> Sequence[SymbolEntry]:
        """Members of one name, those first that count most, and whose classes do."""
        if len(members) < 2:
            return members
        weights = self._reader.usage.weights(
            {path for entry in members for path in (entry.path, entry.owner)}
        )
        return sorted(members, key=lambda e: -weights.get(e.path, 0.0) - weights.get(e.owner, 0.0))

    def _having(self, member: str) -> Iterator[SymbolEntry]:
        """The classes that have a member of their own of a name, those first that are likeliest meant."""
        named = (
            [entry for entry in self._reader.names.by_name(member) if entry.kind != "socket"]
            if member
            else []
        )
        self._reader.entry.load(entry.owner for entry in named)
        for entry in self.heaviest(named)[:_MOST_READ]:
            owner = self._reader.entry(entry.owner)
            if owner and owner.kind == "class":
                yield owner

    def _taking(self, chain: Chain, member: str) -> set[str]:
        """The classes of which an enumeration takes what a lone member is set to or compared with."""
        found = (path for value in chain.values for path, *_ in self._reader.names.enum_owners(key(value)))
        return {path.removesuffix(f".{member}") for path in found if path.endswith(f".{member}")}

    def _is_one_of(self, owner: str, classes: Sequence[str]) -> bool:
        """Whether a class is one of some, or a kind or a base of one."""
        return any(self._reader.descends(owner, cls) or self._reader.descends(cls, owner) for cls in classes)


def _told_by(variable: str) -> frozenset[str]:
    """The words of a variable's name; none where one of them tells nothing."""
    said = frozenset(words(variable))
    return said if all(len(word) > _LETTERS for word in said) else frozenset()


def _words_of(cls: SymbolEntry) -> set[str]:
    """The words of a class's name and label: ``ramp`` is of a node Color Ramp."""
    return {*words(cls.name), *words(cls.label)}
