"""What an observer may remember: that which a checkpoint gives back as it was. Tuples come back as lists."""

import json

import numpy as np

from rsmpm_ti.errors import short, shown

MOST_DEEP = 100
"""Lists and dicts within each other: far below what Python's own recursion allows."""

MOST_BITS = 2000
"""Of an integer, which Python writes in decimals up to a length that users may lower to 640 digits."""

KINDS = "biufcSUMm"
"""NumPy's letters for kinds of arrays that a file gives back."""


class Unkept(Exception):
    """Something that would not come back as it was, and where it lies: keys and indices, the outermost first."""

    def __init__(self, reason: str):
        super().__init__(reason)
        self.reason, self.path = reason, list[object]()

    def __str__(self) -> str:
        places = "".join(f"[{shown(key)}]" for key in self.path[:4])
        return f"state(){short(places)} {self.reason}"


def divided(state: dict) -> tuple[dict, dict[str, np.ndarray]]:
    """A state as what JSON keeps of it and the arrays by name. Raises Unkept."""
    arrays = {name: value for name, value in state.items() if isinstance(value, np.ndarray)}
    rest = {name: value for name, value in state.items() if name not in arrays}
    _check_keys(arrays)
    for name, values in arrays.items():
        if problem := _of_array(values):
            raise _within(name, Unkept(problem))
    return _plain(rest, 0), arrays


def _of_array(values: np.ndarray) -> str:
    """Why an array would not come back; "" where it does."""
    if isinstance(values, np.ma.MaskedArray):
        return "is a MaskedArray, whose mask would be lost; give np.ma.getdata(it) and np.ma.getmaskarray(it)"
    if type(values) is not np.ndarray:
        return f"is a {type(values).__name__}; give np.asarray(it)"
    if values.dtype.kind not in KINDS or values.dtype.itemsize == 0:
        return f"is an array of {shown(values.dtype)}, not of numbers"
    return ""


def _plain(value, depth: int):
    """A copy of Python's own kinds."""
    if depth > MOST_DEEP:
        raise Unkept(f"holds lists or dicts more than {MOST_DEEP} deep")
    if isinstance(value, np.generic) and value.dtype.kind in "biuf":
        value = value.item()
    if isinstance(value, str):
        if problem := _of_text(value):
            raise Unkept(problem)
        return value
    if value is None or isinstance(value, bool | float):
        return value
    if isinstance(value, int):
        if value.bit_length() > MOST_BITS:
            raise Unkept(f"is an integer of more than {MOST_BITS} bits")
        return int(value)
    if isinstance(value, dict):
        _check_keys(value)
        return {key: _plain_at(key, entry, depth) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain_at(k, entry, depth) for k, entry in enumerate(value)]
    raise Unkept(f"is a {type(value).__name__}")


def _plain_at(key, entry, depth: int):
    try:
        return _plain(entry, depth + 1)
    except Unkept as problem:
        raise _within(key, problem) from None


def _within(key, problem: Unkept) -> Unkept:
    problem.path.insert(0, key)
    return problem


def _check_keys(value: dict) -> None:
    """JSON makes texts of other keys, two of them perhaps the same."""
    for key in value:
        if not isinstance(key, str):
            raise Unkept(f"has the key {shown(key)}, and keys must be texts")
        if problem := _of_text(key):
            raise Unkept(f"has a key that {problem}")


def _of_text(text: str) -> str:
    """Why a text would not come back; "" where it does. JSON makes one sign of two surrogates in a row."""
    if text.isascii() or json.loads(json.dumps(text)) == text:
        return ""
    return "holds surrogates that come back as another sign; give bytes as np.frombuffer(it, dtype=np.uint8)"
