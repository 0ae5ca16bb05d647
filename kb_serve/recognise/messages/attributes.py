"""Recognises messages of attributes that something lacks: None, a collection, a module, a Python type, a class."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.messages.python_types import PYTHONS

if TYPE_CHECKING:
    from kb_serve.recognise.messages.imports import Imports
    from kb_serve.recognise.messages.lacking_owners import LackingOwners
    from kb_serve.recognise.messages.none_before import NoneBefore
    from kb_serve.recognise.messages.python_types import PythonTypes
    from kb_serve.recognise.messages.unnamed_owners import UnnamedOwners
    from kb_serve.recognise.recognition import Recognition


class Attributes:
    """Hands each message to what knows about such an owner."""

    def __init__(
        self,
        none_before: NoneBefore,
        owners: UnnamedOwners,
        imports: Imports,
        python_types: PythonTypes,
        lacking_owners: LackingOwners,
    ) -> None:
        self._none_before = none_before
        self._owners = owners
        self._imports = imports
        self._python_types = python_types
        self._lacking_owners = lacking_owners

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the owner without the attribute, or what may have been meant."""
        for pattern in (forms.HAS_NO, forms.TYPE_HAS_NO, forms.MODULE_HAS_NO):
            for match in forms.first_matches(pattern, query):
                if pattern is forms.TYPE_HAS_NO and self._lacking_owners.tell_of_instances(
                    match["owner"], match["name"], recognition
                ):
                    continue
                of_module = pattern is forms.MODULE_HAS_NO
                self._explain(match["owner"], match["name"], query, recognition, of_module=of_module)
        for match in forms.first_matches(forms.NOT_IN_COLLECTION, query):
            self._owners.of_a_collection(match["name"], query, recognition)
        for match in forms.first_matches(forms.OF_ELEMENTS, query):
            self._lacking_owners.explain_elements(
                match["owner"], match["collection"], match["name"], recognition
            )

    def _explain(
        self, owner: str, name: str, query: str, recognition: Recognition, *, of_module: bool
    ) -> None:
        if owner == "NoneType":
            self._none_before.explain(name, query, recognition)
        elif owner == "bpy_prop_collection":
            self._owners.of_a_collection(name, query, recognition)
        elif owner == "module":  # of which the message does not tell the name
            if not self._imports.tell_if_gone(TYPES + name, recognition):
                self._lacking_owners.explain_class(name, recognition)
        elif forms.NO_FLUIDS.search(query):  # of which another recogniser tells
            return
        elif owner in PYTHONS:
            self._python_types.explain(owner, name, recognition)
        else:
            meant = forms.MEANT.search(query)
            self._lacking_owners.explain(
                owner, name, recognition, of_module=of_module, meant=meant["name"] if meant else ""
            )
