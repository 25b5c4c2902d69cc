"""Whether a value is of the kind that its field is annotated with, and of a size that arithmetic bears.

Texts of the command line, recorded JSON and Python's constructors are all held to the same annotations, here.
"""

import dataclasses
import functools
import types
import typing

from rsmpm_ti.errors import refuse

PHRASES = {float: "a number", int: "an integer", bool: "true or false", str: "a text", types.NoneType: "none"}

OWN = ("builtins", "rsmpm_ti.rock.", "rsmpm_ti.method.", "rsmpm_ti.spec.")
"""Where classes live that stand in for no others: Python's own, and the rooms of scene data."""

LEAST, LARGEST = 1e-12, 1e18
"""Of what must be positive, in SI units: far beyond any specimen, and squares and ratios of such numbers are finite."""


def members(wanted) -> tuple:
    """The alternatives of an annotation: (A, B) of A | B, itself of anything else."""
    return typing.get_args(wanted) if typing.get_origin(wanted) in (typing.Union, types.UnionType) else (wanted,)


def fits(value, wanted) -> bool:
    """Whether a value is what an annotation says. An integer will do for a number, a bool will not."""
    if len(members(wanted)) > 1:
        return any(fits(value, kind) for kind in members(wanted)) or _stands_in(value, wanted)
    if typing.get_origin(wanted) is tuple:
        if not isinstance(value, tuple):
            return False
        kinds = entry_kinds(wanted, len(value))
        return len(kinds) == len(value) and all(map(fits, value, kinds))
    if wanted in (int, float) and isinstance(value, int):
        return not isinstance(value, bool) and (wanted is int or value.bit_length() < 1000)
    return isinstance(value, wanted) or _stands_in(value, wanted)


def _stands_in(value, wanted) -> bool:
    """Whether an object of a class from outside, as a scene file may bring, has what all alternatives have in common.

    A strategy of this package never stands in for one of another family.
    """
    families = [kind for kind in members(wanted) if dataclasses.is_dataclass(kind)]
    if not families or isinstance(value, type) or type(value).__module__.startswith(OWN):
        return False
    public = (frozenset(name for name in dir(kind) if not name.startswith("_")) for kind in families)
    return all(hasattr(value, name) for name in frozenset.intersection(*public))


def entry_kinds(wanted, length: int) -> tuple:
    """The annotations of a tuple's entries, `length` of them where tuple[A, ...] leaves that open."""
    kinds = next((typing.get_args(kind) for kind in members(wanted) if typing.get_origin(kind) is tuple), (object, ...))
    return kinds[:1] * length if kinds[-1] is Ellipsis else kinds


def phrase(wanted) -> str:
    """What a user is told to give: 'Lattice or Jittered', 'a number or none', '2 numbers separated by commas'."""
    if len(members(wanted)) > 1:
        *most, last = map(phrase, members(wanted))
        return f"{', '.join(most)} or {last}"
    if typing.get_origin(wanted) is tuple:
        kinds = typing.get_args(wanted)
        if kinds[0] is not float:
            return f"a list of {phrase(kinds[0])}"
        return f"{'' if kinds[-1] is Ellipsis else f'{len(kinds)} '}numbers separated by commas"
    return PHRASES.get(wanted) or wanted.__name__


@functools.cache
def _annotations(kind: type) -> dict:
    return typing.get_type_hints(kind)


def check_kinds(owner: str, data) -> None:
    """Raises SceneError for a field of a dataclass whose value is not of its kind; `owner` names the dataclass."""
    for field in dataclasses.fields(data):
        kind: typing.Any = type(data)
        value, wanted = getattr(data, field.name), _annotations(kind)[field.name]
        if not fits(value, wanted):
            raise refuse(f"{owner}.{field.name}", value, phrase(wanted))


def check_positive(name: str, value: float, what: str, least: float = LEAST, most: float = LARGEST) -> None:
    """Raises SceneError unless least <= value <= most; `what` says what the number is, with its unit."""
    if not least <= value <= most:
        raise refuse(name, value, f"a positive finite {what}, in [{least:g}, {most:g}]")


def check_size(name: str, values: tuple[float, ...], what: str, most: float = LARGEST) -> None:
    """Raises SceneError unless every value, which may have either sign, is at most `most`."""
    if not all(abs(value) <= most for value in values):
        raise refuse(name, values if len(values) > 1 else values[0], f"{what}, finite and of size at most {most:g}")


def check_seed(name: str, value: int) -> None:
    """Raises SceneError unless a random seed is one that every record can hold."""
    if not 0 <= value < 2**63:
        raise refuse(name, value, "a whole number, zero or more and below 2^63")
