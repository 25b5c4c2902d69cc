"""A data sheet as the TOML file that `reading.py` reads."""

import json

from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.rock.sheet.reading import KEYS, displayed


def text_of(sheet: DataSheet) -> str:
    """The file's text; numbers to six digits, in the units of laboratories."""
    given = {key: getattr(sheet, key) for key in KEYS if getattr(sheet, key) is not None}
    lines = [f"name = {_quoted(sheet.name)}"]
    if sheet.source:
        lines.append(f"source = {_quoted(sheet.source)}")
    for table, estimated in (("rock", False), ("estimated", True)):
        keys = [key for key in given if (key in sheet.estimated) == estimated]
        if keys:
            lines += ["", f"[{table}]", *(f"{key} = {_quoted(_said(key, given[key]))}" for key in keys)]
    if sheet.sources:
        lines += ["", "[sources]", *(f"{key} = {_quoted(text)}" for key, text in sheet.sources)]
    return "\n".join(lines) + "\n"


def _said(key: str, value: float | str) -> str:
    return value if isinstance(value, str) else displayed(key, value)


def _quoted(text: str) -> str:
    """A basic string of TOML, which escapes as JSON does, and DEL too."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
