"""Recognises Blender's error messages: the symbols they are about, and what they mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise.message_patterns import may_be_message
from kb_serve.recognise.messages.absent import Absent
from kb_serve.recognise.messages.argument_places import ArgumentPlaces
from kb_serve.recognise.messages.assigned_properties import AssignedProperties
from kb_serve.recognise.messages.attributes import Attributes
from kb_serve.recognise.messages.bmesh_values import BMeshValues
from kb_serve.recognise.messages.called_classes import CalledClasses
from kb_serve.recognise.messages.former_sockets import FormerSockets
from kb_serve.recognise.messages.freed_data import FreedData
from kb_serve.recognise.messages.given_values import GivenValues
from kb_serve.recognise.messages.imports import Imports
from kb_serve.recognise.messages.indices import Indices
from kb_serve.recognise.messages.item_counts import ItemCounts
from kb_serve.recognise.messages.keys import Keys
from kb_serve.recognise.messages.keywords import Keywords
from kb_serve.recognise.messages.lacking_owners import LackingOwners
from kb_serve.recognise.messages.made_otherwise import MadeOtherwise
from kb_serve.recognise.messages.manifests import Manifests
from kb_serve.recognise.messages.multiplications import recognise_multiplications
from kb_serve.recognise.messages.named_symbols import NamedSymbols
from kb_serve.recognise.messages.nameless_messages import NamelessMessages
from kb_serve.recognise.messages.node_types import NodeTypes
from kb_serve.recognise.messages.none_before import NoneBefore
from kb_serve.recognise.messages.operators import Operators
from kb_serve.recognise.messages.own_functions import OwnFunctions
from kb_serve.recognise.messages.paths_not_found import PathsNotFound
from kb_serve.recognise.messages.python_types import PythonTypes
from kb_serve.recognise.messages.refused_calls import RefusedCalls
from kb_serve.recognise.messages.registration import Registration
from kb_serve.recognise.messages.unnamed_owners import UnnamedOwners
from kb_serve.recognise.messages.unregistered_operators import UnregisteredOperators
from kb_serve.recognise.messages.values import Values
from kb_serve.recognise.messages.ways_to_run import WaysToRun

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.named.enum_values import EnumValues
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup


class Messages:
    """Recognises error messages against one base."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup, enum_values: EnumValues) -> None:
        symbols = NamedSymbols(reader)
        absent = Absent(reader)
        imports = Imports(reader, removed)
        owners = UnnamedOwners(reader, removed)
        attributes = Attributes(
            NoneBefore(reader, removed, absent),
            owners,
            imports,
            PythonTypes(reader, absent),
            LackingOwners(reader, removed, symbols),
        )
        # In this order: some say nothing where an earlier one was sure, and notes are read in it.
        self._recognisers: tuple[Callable[[str, Recognition], None], ...] = (
            attributes.recognise,
            imports.recognise,
            AssignedProperties(reader, symbols).recognise,
            Operators(reader).recognise,
            UnregisteredOperators(reader).recognise,
            Values(reader, removed, enum_values, symbols).recognise,
            FreedData(reader).recognise,
            MadeOtherwise(reader).recognise,
            WaysToRun(reader).recognise,
            BMeshValues(reader).recognise,
            CalledClasses(reader, symbols).recognise,
            NodeTypes(reader, removed).recognise,
            PathsNotFound(reader).recognise,
            recognise_multiplications,
            Registration(reader).recognise,
            GivenValues(reader, absent).recognise,
            OwnFunctions(reader).recognise,
        )
        # Of messages in words of their own.
        self._others: tuple[Callable[[str, Recognition], None], ...] = (
            RefusedCalls(reader).recognise,
            Manifests(reader).recognise,
            NamelessMessages(reader).recognise,
        )
        self._explainers: tuple[Callable[[str, Recognition], None], ...] = (
            Keywords(reader, removed, symbols).explain,
            ArgumentPlaces(reader, symbols).explain,
            Indices(reader).explain,
            ItemCounts(reader).explain,
            Keys(reader, FormerSockets(reader, removed)).explain,
        )

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what a message is about: a class without an attribute, an operator, the owner of an enum."""
        recognisers = self._recognisers if may_be_message(query) else ()
        for recognise in (*recognisers, *self._others):
            recognise(query, recognition)

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds notes that need the query's names: the right argument, a removed socket."""
        for explain in self._explainers if may_be_message(query) else ():
            explain(query, recognition)
