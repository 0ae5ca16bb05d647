"""Messages of nodes that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

NODES = (
    NamelessMessage(
        ("Cannot add socket to built-in node",),
        (f"{T}NodeTreeInterface.new_socket",),
        "Sockets of a group's input and output come from its interface: "
        "`tree.interface.new_socket(\"Name\", in_out='INPUT', socket_type='NodeSocketFloat')`.",
    ),
    NamelessMessage(
        ("Same input/output direction of sockets",),
        (f"{T}NodeLinks.new",),
        "A link goes from an output to an input: `tree.links.new(one.outputs[0], other.inputs[0])`.",
    ),
)
