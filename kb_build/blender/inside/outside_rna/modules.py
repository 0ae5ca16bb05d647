# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that lives outside RNA: modules, their classes and functions, from their reST docstrings."""

import ast
import importlib
import inspect
import pkgutil
import sys
import textwrap
import types
from pathlib import Path

import bpy

from ..classes.rna import ATTRIBUTE_TYPES, METHOD_TYPES
from ..wire import plain
from . import bmesh_operators
from .keywords import flags_of

# Canonical homes first: what a later module merely imports is already known by then.
ROOTS = (
    "mathutils", "bmesh.types", "bmesh", "gpu.types", "gpu", "gpu_extras", "bl_math", "blf", "aud", "idprop.types",
    "idprop", "bgl", "imbuf.types", "imbuf", "freestyle.types", "freestyle", "bpy.app", "bpy.props", "bpy.utils",
    "bpy.path", "bpy.msgbus", "bpy_extras", "_bpy_internal.grease_pencil.stroke", "addon_utils", "nodeitems_utils",
    "rna_prop_ui", "rna_keymap_ui", "bl_keymap_utils",
)  # fmt: skip
# Class → path of those written so far.
WRITTEN = {}
PRIVATE_BUT_DOCUMENTED = {"bpy.props._PropertyDeferred"}
# What modules have that are struct sequences, as bpy.app.handlers, besides their fields.
TUPLES_OWN = {*dir(tuple), "n_fields", "n_sequence_fields", "n_unnamed_fields"}
# What a module that is written in C has as a name alone, as bgl where Blender is built without OpenGL.
STUB, STUB_TEXT = "stub", "A name alone: it is `None` in this build of Blender."
PLAIN = (bool, int, float, str, bytes, tuple, list, dict, set, frozenset)
# What is written so in Python → its type.
DISPLAYS = {
    ast.Dict: "dict[Any, Any]",
    ast.DictComp: "dict[Any, Any]",
    ast.List: "list[Any]",
    ast.ListComp: "list[Any]",
    ast.Set: "set[Any]",
    ast.SetComp: "set[Any]",
}


def load(name):
    """Returns a module (or Blender's module-like object) by its dotted name; None if this version lacks it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        pass
    head, _, rest = name.partition(".")
    try:
        value = importlib.import_module(head)
        for part in rest.split("."):
            value = getattr(value, part)
    except (ImportError, AttributeError):
        return None
    return value


def names_below(folders):
    """The names of the modules in the folders of a package, and of folders that are packages without saying so."""
    names = {info.name for info in pkgutil.iter_modules(folders)}
    for folder in folders:
        names |= {path.parent.name for path in Path(folder).glob("*/*.py") if path.parent.name.isidentifier()}
    return sorted(name for name in names if not name.startswith("_"))


def belongs(value_name, owner, attribute):
    """Whether the module ``owner.attribute`` is defined there, not only imported."""
    root, _, rest = value_name.partition(".")
    return root.lower() == owner.partition(".")[0] and rest.rpartition(".")[2] == attribute


class Written:
    """A default that a call's text has as it is written here."""

    def __init__(self, text):
        self.text = text

    def __repr__(self):
        return self.text


def written(value):
    """A default as Python writes it; what has no such text by its name, or as ``...``."""
    if isinstance(value, (type, types.FunctionType, types.BuiltinFunctionType)):
        return value.__name__
    if isinstance(value, (set, frozenset)) and value:
        return f"{{{', '.join(sorted(map(written, value)))}}}"
    try:
        ast.parse(repr(value), mode="eval")
    except SyntaxError:
        return "..."
    return repr(value)


def signature(value):
    """A call's text for what Python can inspect; empty for the rest, whose docstring carries it."""
    try:
        found = inspect.signature(value)
    except (TypeError, ValueError):
        return ""
    taken = found.parameters.values()
    with_texts = [
        one if one.default is one.empty else one.replace(default=Written(written(one.default)))
        for one in taken
    ]
    return str(found.replace(parameters=with_texts))


def call_marks(function):
    """What is known of a function's call besides its text: that it is what Python itself reads, or nothing at all."""
    if isinstance(function, types.FunctionType):
        return {"call": "python"}
    return {} if signature(function) or inspect.getdoc(function) else {"call": "unknown"}


def returned_class(function):
    """The class of which a function written in Python returns a new instance, by its first such line; else None."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, TypeError, SyntaxError):
        return None
    names = dict(getattr(function, "__globals__", {}))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module in ROOTS:
            names.update(vars(load(node.module) or types))
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Return)
            and isinstance(node.value, ast.Call)
            and isinstance(node.value.func, ast.Name)
        ):
            cls = names.get(node.value.func.id)
            return cls if isinstance(cls, type) and cls.__module__ in ROOTS else None
    return None


def returned_type(function):
    """The type that a function written in Python returns, with what its elements are: ``Slice[Stroke]``."""
    cls = returned_class(function)
    if cls is None:
        return ""
    element = returned_class(vars(cls).get("__getitem__"))
    text = f"{cls.__module__}.{cls.__qualname__}"
    return f"{text}[{element.__module__}.{element.__qualname__}]" if element else text


def own_nodes(function):
    """The nodes of a function's body, without those of functions and classes within it."""
    found = list(function.body)
    for node in found:
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)):
            found += ast.iter_child_nodes(node)
    return found


def returned_display(function):
    """What a function written in Python surely makes and returns, a dictionary, a list or a set; empty for others."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    except (OSError, TypeError, SyntaxError, IndexError):
        return ""
    if not isinstance(tree, ast.FunctionDef) or not isinstance(tree.body[-1], ast.Return):
        return ""
    nodes = own_nodes(tree)
    stored = [node.id for node in nodes if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load)]
    made = {
        node.targets[0].id: node.value
        for node in nodes
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and len(node.targets) == 1
    }
    kinds = set()
    for node in nodes:
        if isinstance(node, (ast.Yield, ast.YieldFrom)):
            return ""
        if isinstance(node, ast.Return):
            value = node.value
            if isinstance(value, ast.Name) and stored.count(value.id) == 1:
                value = made.get(value.id)
            kinds.add(DISPLAYS.get(type(value), ""))
    return kinds.pop() if len(kinds) == 1 else ""


def write_member(write, owner, name, value, flags=()):
    """A method or attribute of a class."""
    attribute = isinstance(value, ATTRIBUTE_TYPES)
    function = getattr(value, "__func__", value)
    flags = [*flags, *flags_of(value)]
    if isinstance(value, (classmethod, types.ClassMethodDescriptorType)):
        flags.append("classmethod")
    elif isinstance(value, staticmethod):
        flags.append("static")
    if isinstance(value, property) and value.fset is None:
        flags.append("readonly")
    write(
        "symbol",
        path=f"{owner}.{name}",
        kind="property" if attribute else "function",
        owner=owner,
        docstring=inspect.getdoc(function) or "",
        type=returned_type(value.fget) if isinstance(value, property) else "",
        signature="" if attribute else signature(function),
        returned="" if attribute or inspect.getdoc(function) else returned_display(function),
        flags=flags,
        **({} if attribute else call_marks(function)),
    )


def base_path(cls, owner):
    """Where a class's base is written, or will be, beside it; nothing where it is not: Python's own, private ones."""
    base = cls.__base__
    if base in WRITTEN or base is None or base.__module__ != cls.__module__ or base.__name__.startswith("_"):
        return WRITTEN.get(base, "")
    return f"{owner}.{base.__name__}" if getattr(load(owner), base.__name__, None) is base else ""


def annotated(hint):
    """What an annotation says: the property that a class gets when it is registered, or just a type."""
    given = getattr(hint, "keywords", None)
    if given is None:
        return {"type": hint if isinstance(hint, str) else getattr(hint, "__name__", str(hint))}
    kind = hint.function.__name__.removesuffix("Property").lower()
    return {
        "type": "boolean" if kind == "bool" else kind,
        "label": given.get("name", ""),
        "description": given.get("description", ""),
        "default": plain(given.get("default")),
        "subtype": given.get("subtype", ""),
    }


def write_class(write, path, cls, told=""):
    """A class outside RNA with its own members; ``told`` is what is said of it where it is, if it says nothing."""
    owner = path.rpartition(".")[0]
    WRITTEN[cls] = path
    write(
        "symbol",
        path=path,
        kind="class",
        owner=owner,
        docstring=inspect.getdoc(cls) if "__doc__" in vars(cls) and cls.__doc__ else told,
        signature=signature(cls) if cls.__module__ != "builtins" and "__init__" in vars(cls) else "",
        base=base_path(cls, owner),
        group="data",
        flags=flags_of(cls),
    )
    written = set()
    for ancestor in cls.__mro__:
        # Mix-ins of a private kind are not documented anywhere else.
        if ancestor is not cls and not ancestor.__name__.startswith("_"):
            break
        for name, value in vars(ancestor).items():
            if name.startswith("_") or name in written:
                continue
            written.add(name)
            if isinstance(value, METHOD_TYPES + ATTRIBUTE_TYPES):
                write_member(write, path, name, value)
            elif isinstance(value, type) and value.__module__ == cls.__module__:
                write_class(write, f"{path}.{name}", value)
            elif isinstance(value, PLAIN):
                write(
                    "symbol",
                    path=f"{path}.{name}",
                    kind="data",
                    owner=path,
                    type=type(value).__name__,
                    default=plain(value),
                )
    for name, hint in getattr(cls, "__annotations__", {}).items():
        if not name.startswith("_") and name not in written:
            write("symbol", path=f"{path}.{name}", kind="property", owner=path, **annotated(hint))


class Walk:
    """One pass over the modules; remembers objects, so that each is written where it is at home."""

    def __init__(self, write):
        self.write = write
        self.seen = set()
        self.modules = set()

    def module(self, name, module):
        """A module, what it defines, and the modules below it."""
        if name in self.modules:
            return
        self.modules.add(name)
        self.write(
            "symbol",
            path=name,
            kind="module",
            owner="" if name.startswith("_") else name.rpartition(".")[0],
            docstring=inspect.getdoc(module) or ""
            if not isinstance(module, tuple)
            else type(module).__doc__ or "",
        )
        below = []
        for attribute in dir(module):
            if not self.is_told(name, module, attribute):
                continue
            try:
                value = getattr(module, attribute)
            except Exception:
                continue
            path = f"{name}.{attribute}"
            if isinstance(value, types.ModuleType):
                if belongs(value.__name__, name, attribute):
                    below.append((path, value))
            else:
                self.member(name, module, path, attribute, value)
        if hasattr(module, "__path__"):
            for found in names_below(module.__path__):  # pyright: ignore[reportAttributeAccessIssue]
                below.append((f"{name}.{found}", load(f"{name}.{found}")))
        for path, value in below:
            if value is not None:
                self.module(path, value)

    def is_told(self, name, module, attribute):
        """Whether an attribute is one of the module's own, and not private."""
        if isinstance(module, tuple) and attribute in TUPLES_OWN:
            return False
        return not attribute.startswith("_") or self.is_documented(name, module, attribute)

    def is_documented(self, name, module, attribute):
        """Whether a name with an underscore in front has documentation all the same."""
        if f"{name}.{attribute}" in PRIVATE_BUT_DOCUMENTED:
            return True
        described = getattr(type(module), attribute, None)
        return (
            not attribute.startswith("__")
            and isinstance(described, types.MemberDescriptorType)
            and described.__doc__
        )

    def member(self, name, module, path, attribute, value):
        """Writes a member of a module, unless the module only imported it."""
        home = getattr(value, "__module__", None)
        if isinstance(value, type):
            listed = getattr(module, "__all__", None)
            if home != name and listed is not None and attribute not in listed:
                return
            is_foreign = home not in {name, None, "builtins"} and not home.startswith(name.split(".")[0])
            if value in self.seen or (is_foreign and listed is None):
                return
            if home == "builtins" and value.__name__ != attribute:
                return
            self.seen.add(value)
            described = getattr(type(module), attribute, None)
            told = inspect.getdoc(described) if isinstance(described, ATTRIBUTE_TYPES) else ""
            write_class(self.write, path, value, told or "")
        elif isinstance(value, types.FunctionType):
            if home == name or name.startswith(home + ".") or home.startswith("_bpy"):
                self.function(path, name, value)
        elif isinstance(value, types.BuiltinFunctionType):
            if not self.is_imported(name, value):
                self.function(path, name, value)
        elif type(value).__name__ == "BMeshOpFunc":
            self.function(path, name, value, bmesh_operators.parameters(value))
        elif type(value).__module__ == "typing" or home in {"typing", "collections.abc"}:
            return
        elif self.holds_documented_members(value):
            self.module(path, value)
        else:
            self.data(path, name, module, attribute, value)

    def is_imported(self, name, value):
        """Whether a module has a C function from elsewhere: from Python's own modules, or from one before this."""
        home = value.__module__
        return home != name and (home in sys.stdlib_module_names or home in self.modules)

    def holds_documented_members(self, value):
        """Blender's module-like objects: handlers, build options, unit categories, translations, …"""
        cls = type(value)
        return cls.__name__ in {"bpy_app_translations", "_translations_type"} or (
            isinstance(value, tuple) and cls is not tuple and hasattr(cls, "n_fields")
        )

    def function(self, path, owner, value, parameters=()):
        """A function of a module; ``parameters`` are what is known of them besides the docstring."""
        text = inspect.getdoc(value) or ""
        self.write(
            "symbol",
            path=path,
            kind="function",
            owner=owner,
            docstring=text,
            signature=signature(value),
            returned="" if text else returned_display(value),
            parameters=parameters,
            flags=flags_of(value),
            **call_marks(value),
            **({"of_module": True} if isinstance(value, types.FunctionType) else {}),
        )

    def data(self, path, owner, module, attribute, value):
        """A constant or a list that a module holds; its documentation is on the descriptor, if anywhere."""
        described = getattr(type(module), attribute, None)
        documented = isinstance(described, ATTRIBUTE_TYPES)
        is_stub = value is None and isinstance(module, types.ModuleType) and not hasattr(module, "__file__")
        self.write(
            "symbol",
            path=path,
            kind="data",
            owner=owner,
            type="" if is_stub else type(value).__name__,
            description=STUB_TEXT if is_stub else "",
            flags=[STUB] if is_stub else [],
            default=plain(value)
            if isinstance(value, (bool, int, float, str)) and not owner.startswith("bpy.app")
            else None,
            docstring=inspect.getdoc(described) or "" if documented else "",
        )


def write_bpy_types(write):
    """The classes of ``bpy.types`` that are not RNA: bpy_struct, bpy_prop_collection, GeometrySet, …"""
    for name in dir(bpy.types):
        value = getattr(bpy.types, name)
        if isinstance(value, type) and not name.startswith("_") and not hasattr(value, "bl_rna"):
            write_class(write, f"bpy.types.{name}", value)


def write_returned(write):
    """Classes that no module has, which only a method returns: documented as if ``bpy.types`` had them."""
    block = bpy.data.actions.new("scratch")
    block["number"] = 1.0
    cls = type(block.id_properties_ui("number"))
    write_class(write, f"bpy.types.{cls.__name__}", cls)
    bpy.data.actions.remove(block)


def write_all(write):
    """Every module of the public API outside ``bpy.types`` and ``bpy.ops``."""
    for name, text in (
        ("bpy", "Blender's Python API."),
        ("bpy.types", "The classes of Blender's data."),
        ("bpy.ops", "Operators: the actions of Blender's interface, callable from Python."),
    ):
        write("symbol", path=name, kind="module", owner=name.rpartition(".")[0], description=text)
    write("symbol", path="bpy.data", kind="data", owner="bpy", type="BlendData", target="BlendData",
          description="Access to Blender's internal data.")  # fmt: skip
    write("symbol", path="bpy.context", kind="data", owner="bpy", type="Context", target="Context",
          description="The current context: window, area, scene, active and selected objects.")  # fmt: skip
    write_bpy_types(write)
    write_returned(write)
    walk = Walk(write)
    for name in ROOTS:
        module = load(name)
        if module is not None:
            walk.module(name, module)
