"""Whether what calls pass contradicts what is declared, which Python does not check."""

from __future__ import annotations

from kb_build.flow.evaluation.members import Members
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    ClassObject,
    Instance,
    LocalClass,
    LocalInstance,
    Mapping,
    Plain,
    Sequence,
    Tuple,
    Type,
    members,
)


class Contradictions(Members):
    """Compares what is given with what is declared."""

    def contradicts(self, received: Type, declared: Type) -> bool:
        """Whether calls pass something else than the annotation says."""
        return any(
            not any(self._may_be(member, one) for one in members(declared)) for member in members(received)
        )

    def _may_be(self, given: Type, declared: Type) -> bool:  # noqa: PLR0911 - one return a pair
        """Whether something of a type may be what is declared, as far as is known of both."""
        if declared is UNKNOWN or given is UNKNOWN or given is NONE:
            return True
        match given, declared:
            case Instance(), Instance():
                return self.api.descends(given.cls, declared.cls) or self.api.descends(
                    declared.cls, given.cls
                )
            case LocalInstance(), Instance():
                return any(
                    isinstance(kind, ClassObject) and self._may_be(Instance(kind.cls), declared)
                    for kind in self.ancestors(given.number)
                )
            case LocalInstance(), LocalInstance():
                return LocalClass(declared.number) in self.ancestors(given.number) or LocalClass(
                    given.number
                ) in self.ancestors(declared.number)
            case Mapping(), Mapping():
                return not self.contradicts(given.value, declared.value)
            case Tuple(), Tuple() if len(given.items) == len(declared.items):
                return not any(map(self.contradicts, given.items, declared.items))
            case ((Sequence() | Tuple()), Sequence()):
                return not self.contradicts(self.iterated(given), declared.element)
            case _, Instance() | LocalInstance():
                return not isinstance(given, (Plain, Sequence, Tuple, Mapping, Instance))
            case _:
                return declared is not NONE
