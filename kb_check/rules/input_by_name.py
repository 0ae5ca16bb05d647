"""An input of a geometry-nodes modifier that is set, or read, by its name.

Such a modifier has its inputs under their identifiers. Another key makes a custom property, which changes nothing.

```python
group.interface.new_socket("Density", in_out="INPUT", socket_type="NodeSocketFloat")
modifier["Density"] = 5.0  # reported: modifier[item.identifier] = 5.0, of the item in group.interface
```

Reported where the script itself makes a socket of that name.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance, literal_text
from kb_check.findings import Finding
from kb_check.nodes.group_inputs import named_inputs
from kb_check.rule import Rule
from kb_serve.recognise.chains.subscripts import NODES_MODIFIER, CustomProperties

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    custom = CustomProperties(script.names.reader)
    if custom.inputs_are_properties:  # then no key is one: see no-custom-properties
        return
    for node in script.all(ast.Subscript):
        owner, key = script.type_of(node.value), script.type_of(node.slice)
        name = literal_text(key) if key else None
        if isinstance(owner, Instance) and owner.cls == NODES_MODIFIER and name in named_inputs(script):
            yield Finding(
                RULE.id, "warning", script.span(node),
                custom.on_inputs(), NODES_MODIFIER,
            )  # fmt: skip


RULE = Rule("input-by-name", "warning", "An input of a geometry-nodes modifier by its name", _check)
