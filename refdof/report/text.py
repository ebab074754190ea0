"""Text of others, such as names in files, as it may be shown."""

__all__ = ["one_line"]

_LONGEST_LINE = 600


def one_line(text: str) -> str:
    """Text as it may stand in a terminal, a page or a drawing: one line without control characters, not too long."""
    line = "".join(letter if letter.isprintable() else " " for letter in text[: 2 * _LONGEST_LINE])
    return " ".join(line.split())[:_LONGEST_LINE]
