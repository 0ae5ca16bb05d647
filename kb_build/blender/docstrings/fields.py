"""The field list of a docstring: what it says of the arguments and the result of a call."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from kb_build.blender.docstrings.calls import call_parameters, with_values
from kb_build.symbols.records import Parameter

# “(optional when size is 2)”, of an argument that the call gives no default.
_OPTIONAL = re.compile(r"\(optional\b|^Optional\b")
_ELEMENT = re.compile(r"(?:bmesh\.types\.)?BM(?:Vert|Edge|Face)")
_SEVERAL = re.compile(r"sequence of\b|the (?:verts|edges|faces)\b", re.IGNORECASE)
_TWO_STOPS = re.compile(r"(?<!\.)\.\.$")  # of a sentence that was put before another full stop


@dataclass(slots=True)
class Fields:
    """The field list while it is read: ``:arg x:`` and ``:type x:`` come in any order."""

    texts: dict[str, str] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)
    returns: str = ""
    return_type: str = ""
    own_type: str = ""
    other: list[str] = field(default_factory=list)
    arguments: frozenset[str] = frozenset()
    last: str = ""

    def read(self, name: str, body: str) -> None:
        """Takes one field of the list: ``:arg x: body``."""
        body = _TWO_STOPS.sub(".", body)
        keyword, _, argument = name.partition(" ")
        if keyword in {"arg", "param", "parameter", "argument", "key", "keyword"}:
            kind, _, argument = argument.rpartition(" ")
            argument = argument.lstrip("*")
            self.texts[argument] = body
            self.last = argument
            if kind:
                self.types[argument] = kind
        elif keyword == "type":
            if argument:
                self._set_type(argument.strip().lstrip("*"), body.replace("`", ""))
            else:
                self.own_type = body.replace("`", "")
        elif keyword in {"return", "returns"}:
            self.returns = body
        elif keyword == "rtype":
            self.return_type = body.replace("`", "")
        else:
            self.other.append(f"**{name}**: {body}")

    def _set_type(self, name: str, kind: str) -> None:
        """Takes ``:type name:``.

        Some docstrings misspell the name there, or repeat another one. The type then belongs to the argument
        described just before it; where there is none, it belongs to nothing.
        """
        misplaced = name in self.types or (bool(self.arguments) and name not in self.arguments)
        if misplaced and self.last and self.last not in self.types:
            name = self.last
        elif misplaced and name not in self.texts and name not in self.types:
            return
        self.types[name] = kind


def parameters_of(signature: str, fields: Fields, *, is_certain: bool) -> tuple[Parameter, ...]:
    """The call's arguments in its order, completed from the field list; ``is_certain``: there are no others."""
    parameters = {parameter.name: parameter for parameter in call_parameters(signature)}
    described = fields.texts | fields.types
    misnamed = [name for name in described if name not in parameters]
    undescribed = [name for name in parameters if name not in described]
    if fields.arguments and len(misnamed) == len(undescribed) and (is_certain or len(misnamed) == 1):
        # The docstring calls the arguments that are left otherwise than the signature does.
        for wrong, right in zip(misnamed, undescribed, strict=True):
            for known in (fields.texts, fields.types):
                if wrong in known:
                    known[right] = known.pop(wrong)
    untyped = [name for name in fields.texts if name not in fields.types]
    undescribed = [name for name in fields.types if name not in fields.texts]
    if not parameters and len(untyped) == len(undescribed) == 1:
        # Of two names in the docstring alone, one is a slip: it describes the one, and has the type of the other.
        fields.types[untyped[0]] = fields.types.pop(undescribed[0])
    for name in fields.texts | fields.types if not is_certain else ():
        parameters.setdefault(name, Parameter(name=name))
    return tuple(
        with_values(
            replace(
                parameter,
                description=(text := fields.texts.get(parameter.name, "")),
                type=_of_several(fields.types.get(parameter.name, ""), text) or parameter.type,
                required=parameter.required and not _OPTIONAL.search(text),
            )
        )
        for parameter in parameters.values()
    )


def _of_several(kind: str, description: str) -> str:
    """A type, which is a sequence's where the description says that it is one: some docstrings name only the class of
    its elements.
    """
    return f"Sequence[{kind}]" if _ELEMENT.fullmatch(kind) and _SEVERAL.match(description) else kind
