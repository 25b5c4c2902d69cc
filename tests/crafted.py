"""Checkpoints and records of strangers: files that were damaged, or written to do harm. Each from a seed."""

import io
import json
import random
import struct
import zipfile
from collections.abc import Callable

import numpy as np

Arrays = dict[str, np.ndarray]

BAD_NUMBERS = (float("nan"), float("inf"), -float("inf"), -1.0, 0.0, 1e300, -1e300, 5e-324, 0.5, 1e18, 2.0**31)
BAD_COUNTS = (-1, 0, 3, 2**31 - 1, -(2**31), 7, 10**6)
BAD_TEXTS = ("", "x" * 100_000, "../../x", "\x00", "\x1b[2J", "a\nb", "\ud800", "<a>", "__import__('os')")
BAD_JSON = (None, True, -1, 1e308, 10**40, float("nan"), float("inf"), [], {}, [[]], "0", {"a": 1}, 0.5, *BAD_TEXTS)


def archive(arrays: Arrays, compression: int = zipfile.ZIP_STORED) -> bytes:
    """What `np.savez` writes; objects too."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", compression) as packed:
        for name, values in arrays.items():
            packed.writestr(f"{name}.npy", npy(values))
    return file.getvalue()


def npy(values: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.lib.format.write_array(file, np.asanyarray(values), allow_pickle=True)
    return file.getvalue()


def claiming(shape: str, kind: str = "<f8") -> bytes:
    """A .npy file of no numbers whose header claims a shape, written as text."""
    header = f"{{'descr': {kind!r}, 'fortran_order': False, 'shape': {shape}}}".encode()
    header = header.ljust(-(-(len(header) + 11) // 64) * 64 - 11) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header


CLAIMS = ("(9223372036854775807,)", "(-1,)", "(10**9,)", "(0,)", "(True,)", "(1.5,)", "((1,),)", "()" * 3000,
          "(" * 5000, "(1000000000000,)", "'a'", "(2, 2, 2)")  # fmt: skip
KINDS = ("|O", "<f4", "<U1", ">f8", "|V8", "<M8[s]", "|b1", "<c16", "nonsense", "<U99999999999", "|S0")


def damaged_bytes(dice: random.Random, data: bytes) -> bytes:
    """Cut, flipped, overwritten, doubled, filled with zeros, or of something else altogether."""
    at, length = dice.randrange(len(data)), dice.choice((1, 2, 8, 64, 4096))
    tail = len(data) - dice.randrange(1, 6000)  # the zip's own directory lies at the end
    return dice.choice((
        lambda: data[:at],
        lambda: data[:at] + bytes([data[at] ^ (1 << dice.randrange(8))]) + data[at + 1 :],
        lambda: data[:tail] + bytes([data[tail] ^ (1 << dice.randrange(8))]) + data[tail + 1 :],
        lambda: data[:tail] + dice.randbytes(length) + data[tail + length :],
        lambda: data[:at] + dice.randbytes(length) + data[at + length :],
        lambda: data[:at] + bytes(length) + data[at + length :],
        lambda: data[:at] + data[at + length :],
        lambda: data[:at] + data[at : at + length] + data[at:],
        lambda: data + dice.randbytes(length),
        lambda: dice.randbytes(length) + data,
        lambda: dice.randbytes(length),
        lambda: b"\x80\x04\x95",
    ))()  # fmt: skip


def other_structure(dice: random.Random, arrays: Arrays) -> bytes:
    """Arrays that are missing, too many, of another kind or shape, compressed, or not as large as they say."""
    arrays, name = dict(arrays), dice.choice(list(arrays))
    values = arrays[name]

    def other(made) -> bytes:
        return archive(arrays | {name: made})

    def claimed(data: bytes) -> bytes:
        file = io.BytesIO()
        with zipfile.ZipFile(file, "w") as packed:
            for key, kept in arrays.items():
                packed.writestr(f"{key}.npy", data if key == name else npy(kept))
        return file.getvalue()

    def twice() -> bytes:
        file = io.BytesIO(archive(arrays))
        with zipfile.ZipFile(file, "a") as packed:
            packed.writestr(f"{name}.npy", npy(values))
        return file.getvalue()

    return dice.choice((
        lambda: archive({key: kept for key, kept in arrays.items() if key != name}),
        lambda: archive(arrays | {dice.choice(("x", "observer_9_x", "../x", "particle_real_99", "a" * 9999)): values}),
        lambda: other(values.astype(object)),
        lambda: other(np.zeros(values.shape, dtype=dice.choice(("f4", "i8", "U3", "?", "c16", ">f8", "V3", "M8[s]")))),
        lambda: other(values[..., None]),
        lambda: other(values.ravel()[: values.size // 2]),
        lambda: other(np.zeros((0, *values.shape[1:]), values.dtype)),
        lambda: other(np.concatenate([np.atleast_1d(values)] * 2)),
        lambda: other(np.asfortranarray(np.zeros((3, 4)))),
        lambda: archive(arrays, zipfile.ZIP_DEFLATED),
        lambda: archive(arrays | {name: np.zeros(3_000_000)}, zipfile.ZIP_DEFLATED),
        lambda: claimed(claiming(dice.choice(CLAIMS))),
        lambda: claimed(claiming("(1,)", dice.choice(KINDS))),
        lambda: claimed(npy(values)[:-1]),
        lambda: claimed(b""),
        twice,
    ))()  # fmt: skip


def other_numbers(dice: random.Random, arrays: Arrays) -> bytes:
    """One array of a sound checkpoint, with other numbers: a few, all, in another order, or of another size."""
    name = dice.choice([key for key, kept in arrays.items() if key != "text" and kept.size])
    values = np.array(arrays[name])
    flat = values.reshape(-1)
    bad = BAD_NUMBERS if values.dtype.kind == "f" else BAD_COUNTS
    where = dice.randrange(flat.size)

    def put(number) -> None:
        with np.errstate(all="ignore"):
            flat[where] = np.array(number).astype(values.dtype)

    def fill(number) -> None:
        with np.errstate(all="ignore"):
            flat[:] = np.array(number).astype(values.dtype)

    def scale(factor: float) -> None:
        with np.errstate(all="ignore"):
            flat[:] = (flat * factor).astype(values.dtype)

    dice.choice((
        lambda: put(dice.choice(bad)),
        lambda: put(dice.choice(bad)),
        lambda: fill(dice.choice(bad)),
        lambda: scale(dice.choice((-1.0, 2.0, 1e3, 1e-3, 1.0 + 1e-9))),
        lambda: flat.__setitem__(slice(None), flat[np.random.default_rng(where).permutation(flat.size)]),
        lambda: flat.__setitem__(slice(None), flat[::-1].copy()),
        lambda: flat.__setitem__(slice(None), np.roll(flat, 1)),
    ))()  # fmt: skip
    return archive(arrays | {name: values})


def other_text(dice: random.Random, arrays: Arrays) -> bytes:
    """What observers remember, whose checkpoint it is, or the whole text, as something else."""
    text = json.loads(str(arrays["text"]))
    places = [*below(text)]
    *path, last = dice.choice(places)
    owner = text
    for step in path:
        owner = owner[step]
    how = dice.randrange(4)
    if how == 0 and isinstance(owner, dict):
        del owner[last]
    elif how == 1 and isinstance(owner, dict):
        owner[dice.choice(BAD_TEXTS)] = dice.choice(BAD_JSON)
    else:
        owner[last] = dice.choice(BAD_JSON)
    whole = dice.choice((json.dumps(text),) * 8 + ("[" * 100_000, "{}", "null", "9" * 5000, '{"progress": 1}', "\x00"))
    return archive(arrays | {"text": np.array(whole)})


def below(value, path: tuple = ()):
    """Every path below a value of JSON."""
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for step, entry in entries:
        yield (*path, step)
        yield from below(entry, (*path, step))


def checkpoint(seed: int, arrays: Arrays) -> bytes:
    """A crafted checkpoint, by its number."""
    dice = random.Random(seed)
    made: tuple[Callable, ...] = (other_structure, other_numbers, other_numbers, other_text)
    make = dice.choice((None, *made))
    return damaged_bytes(dice, archive(arrays)) if make is None else make(dice, arrays)


RAW = ("NaN", "Infinity", "-1e999", "1e308", "9" * 5000, "[" * 100_000, "{" * 1000, '"\\ud800"', "null", "true", "[]",
       "{}", '{"type": "Union", "parts": [' * 400, "0" * 50, "-", '"', "\x00", "'x'", "1_0", "0x1", '{"a": 1, "a": 2}',
       '{"type": "os.system"}', "[1e308, -1e308]", '"' + "x" * 100_000 + '"', "[" + "0, " * 50_000 + "0]")  # fmt: skip
"""Texts in place of a value of a record: some are no JSON."""


def record(seed: int, text: str) -> bytes:
    """A crafted scene.json, by its number. text: of a sound one."""
    dice = random.Random(seed)
    if dice.random() < 0.3:
        return damaged_bytes(dice, text.encode() + b" " * 6000)
    data = json.loads(text)
    *path, last = dice.choice([*below(data)])
    owner = data
    for step in path:
        owner = owner[step]
    if dice.random() < 0.2 and isinstance(owner, dict):
        del owner[last]
        return json.dumps(data).encode()
    if dice.random() < 0.5:
        owner[last] = dice.choice(BAD_JSON)
        return json.dumps(data).encode("utf-8", "surrogatepass")
    owner[last] = "<here>"
    return json.dumps(data).replace('"<here>"', dice.choice(RAW)).encode()
