"""Words from outside on a picture: drawn as they are, and what the font cannot draw is replaced, for all to see."""

import functools
import unicodedata

from matplotlib.font_manager import FontProperties, findfont, get_font

MISSING = "\N{REPLACEMENT CHARACTER}"


def drawable(text: str) -> str:
    """A text as matplotlib takes it: `$` is a dollar and begins no formula, an accent is one with its letter, and a
    character without a glyph becomes a question mark in a diamond."""
    known = glyphs()
    composed = unicodedata.normalize("NFC", text)
    return "".join(c if ord(c) in known or c == "\n" else MISSING for c in composed).replace("$", r"\$")


@functools.cache
def glyphs() -> frozenset[int]:
    """Characters that matplotlib's font has, upright and bold."""
    fonts = [get_font(findfont(FontProperties(weight=weight))) for weight in ("normal", "bold")]
    return frozenset.intersection(*(frozenset(font.get_charmap()) for font in fonts))
