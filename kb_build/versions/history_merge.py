"""Merges what single versions have into one history."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from kb_build.symbols.paths import split_path
from kb_build.versions.history import SHARED, ApiHistory, is_from_stubs, is_module
from simworlds.releases import minor_of, version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

Masks = dict[str, int]
# What Blender lists alone where it puts an enumeration together at run time: of languages that it was built with, say.
_PLACEHOLDERS = frozenset({"DEFAULT", "DUMMY", "NONE", "None"})


def merge_versions(
    paths: Mapping[str, Iterable[str]], doubted: Mapping[str, Iterable[str]] | None = None
) -> ApiHistory:
    """The history of these full versions and their paths (see :func:`history.history_paths`); ``doubted`` are paths of
    which it is not known whether a version has them.

    Of versions that are known from stubs (``2.79``), what no stubs have is unknown, and so are the items of an
    enumeration that they do not list. Where any version lists a placeholder alone, its items are unknown.
    """
    patches = tuple(sorted(paths, key=version_key))
    masks: defaultdict[str, int] = defaultdict(int)
    for number, version in enumerate(patches):
        for path in paths[version]:
            masks[path] |= 1 << number
    plain = dict(masks)
    stubs = sum(1 << number for number, version in enumerate(patches) if is_from_stubs(version))
    unbuilt = _fill_unbuilt(plain, len(patches), stubs)
    unknown = _unknown(plain, stubs)
    for more in (unbuilt, _left_out(plain, stubs), _unlisted(plain)):
        for path, hidden in more.items():
            unknown[path] |= hidden
    for version, doubtful in (doubted or {}).items():
        for path in plain.keys() & doubtful:
            unknown[path] |= 1 << patches.index(version) & ~plain[path]
    shared = _share(plain, unknown, stubs)
    unknown = {path: hidden for path, hidden in unknown.items() if hidden and path in plain}
    return ApiHistory(tuple(map(minor_of, patches)), patches, plain, shared, unknown)


def _fill_unbuilt(masks: Masks, count: int, stubs: int) -> Masks:
    """A whole module missing between two versions that have it was left out of that build, not of Blender: it has what
    the version before has. Returns path → the versions of which that is not known.
    """
    unknown: defaultdict[str, int] = defaultdict(int)
    for root in filter(is_module, masks):
        for number in range(1, count - 1):
            bit = 1 << number
            if (masks[root] | stubs) & bit or not masks[root] >> number + 1:
                continue
            before = masks[root] & bit - 1
            around = 1 << before.bit_length() - 1 if before else 0
            for path, mask in masks.items():
                if path == root or path.startswith(f"{root}."):
                    if mask & around and mask > bit:
                        masks[path] = mask | bit
                    else:
                        unknown[path] |= bit & ~mask
    return unknown


def _left_out(masks: Masks, stubs: int) -> Masks:
    """Path → the versions that were asked before any had its module, where no stubs tell of that: their builds may have
    left it out as a whole, which says nothing about Blender.
    """
    found: Masks = {}
    for root in filter(is_module, masks):
        before = (masks[root] & -masks[root]) - 1 & ~stubs
        if before and not masks[root] & stubs:
            found |= {path: before for path in masks if path == root or path.startswith(f"{root}.")}
    return found


def _unlisted(masks: Masks) -> Masks:
    """Path of an item → the versions that list a placeholder alone in its enumeration."""
    found: Masks = {}
    for above, own in _items(masks).items():
        placeholders = listed = 0
        for name, mask in own.items():
            if name in _PLACEHOLDERS:
                placeholders |= mask
            else:
                listed |= mask
        if hidden := placeholders & ~listed:
            found |= {f"{above}:{name}": hidden for name in own if name not in _PLACEHOLDERS}
    return found


def _unknown(masks: Masks, stubs: int) -> Masks:
    """Path → the versions known from stubs that say nothing about it."""
    listed: defaultdict[str, int] = defaultdict(int)
    for path, mask in masks.items():
        above, mark, _ = split_path(path)
        if mark == ":":
            listed[above] |= mask
    unknown: Masks = {}
    for path in sorted(masks, key=len):  # owners before their members
        mask = masks[path]
        above, mark, _ = split_path(path)
        hidden = unknown.get(above, 0) | _between(mask) | _behind(mask, stubs)
        if not mask & stubs:  # stubs may not tell of such names at all
            hidden = stubs
        elif mark == ":":
            hidden |= masks.get(above, 0) & ~listed[above]
        unknown[path] = hidden & stubs & ~mask
    return unknown


def _between(mask: int) -> int:
    """The versions after the first and before the last that have a symbol: stubs that lack it there left it out."""
    return (1 << mask.bit_length()) - (mask & -mask)


def _behind(mask: int, stubs: int) -> int:
    """The versions after the last that has a symbol, where the stubs before that one left it out already."""
    below = (1 << mask.bit_length() - 1) - 1
    nearest = 1 << (stubs & below).bit_length() >> 1
    left_out = nearest and not mask & nearest and mask & nearest - 1
    return ~(below << 1 | 1) if left_out else 0


def _share(masks: Masks, unknown: Masks, stubs: int) -> dict[str, str]:
    """Takes out the items of properties and parameters that have those of a shared enumeration.

    Returns the property or parameter → its enumeration. Stubs do not name these enumerations: what they list where a
    Blender says which one it is, tells its items.
    """
    items = _items(masks)
    places = _places(items, masks, stubs)
    shared: dict[str, str] = {}
    for enumeration, users in places.items():
        if stubs:
            _infer(enumeration, users, items, masks, unknown, stubs)
        own = items[enumeration]
        for path in users:
            hidden = _listed_nowhere(items[path], masks[path], stubs)
            expected = {item: mask & masks[path] & ~hidden for item, mask in own.items()}
            if {item: mask for item, mask in expected.items() if mask} == items[path]:
                shared[path] = enumeration
                for item in items[path]:
                    del masks[f"{path}:{item}"]
    return shared


def _items(masks: Masks) -> defaultdict[str, Masks]:
    """Enumeration → its items."""
    items: defaultdict[str, Masks] = defaultdict(dict)
    for path, mask in masks.items():
        above, mark, name = split_path(path)
        if mark == ":":
            items[above][name] = mask
    return items


def _places(items: Mapping[str, Masks], masks: Masks, stubs: int) -> dict[str, list[str]]:
    """Enumeration → the properties and parameters that have its items in every Blender that was asked."""
    holders: defaultdict[str, list[str]] = defaultdict(list)
    names = sorted(path for path in items if path.startswith(SHARED))
    asked = {name: {item: mask & ~stubs for item, mask in items[name].items()} for name in names}
    for name in names:
        for item in items[name]:
            holders[item].append(name)
    places: defaultdict[str, list[str]] = defaultdict(list)
    for path, own in items.items():
        real = {item: mask & ~stubs for item, mask in own.items() if mask & ~stubs}
        if path.startswith(SHARED) or not real:
            continue
        for name in min((holders.get(item, []) for item in real), key=len):
            if {item: mask & masks[path] for item, mask in asked[name].items() if mask & masks[path]} == real:
                places[name].append(path)
                break
    return dict(places)


def _infer(  # noqa: PLR0913, PLR0917 - the merge's state
    enumeration: str,
    users: list[str],
    items: defaultdict[str, Masks],
    masks: Masks,
    unknown: Masks,
    stubs: int,
) -> None:
    """Sets which items a shared enumeration has in versions known from stubs: what most of its users list."""
    own = items[enumeration]
    for number in range(stubs.bit_length()):
        bit = 1 << number
        if not stubs & bit:
            continue
        sets = (frozenset(item for item, mask in items[path].items() if mask & bit) for path in users)
        votes = Counter(listed for listed in sets if listed)
        if not votes:
            continue
        most = max(votes, key=lambda listed: (votes[listed], sorted(listed)))
        masks[enumeration] |= bit
        unknown[enumeration] = unknown.get(enumeration, 0) & ~bit
        for item in most:
            own[item] = own.get(item, 0) | bit
            masks[f"{enumeration}:{item}"] = own[item]
    for item in own:
        # Known wherever the enumeration is: there its items are listed.
        unknown[f"{enumeration}:{item}"] = stubs & ~masks[enumeration]


def _listed_nowhere(items: Masks, mask: int, stubs: int) -> int:
    """The versions known from stubs that have a property without listing any of its items."""
    listed = 0
    for own in items.values():
        listed |= own
    return stubs & mask & ~listed
