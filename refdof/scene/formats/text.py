"""Lines of text files, as OBJ, MTL and OFF have them."""

__all__ = ["lines_of"]


def lines_of(data: bytes) -> list[str]:
    """A text file's lines without comments, each with one blank after its first word; a backslash goes on.

    What is no UTF-8 is taken for Latin-1.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\\" in text:
        text = text.replace("\\\r\n", " ").replace("\\\n", " ")
    return [
        " ".join(line.split(None, 1)) for line in (raw.partition("#")[0] for raw in text.splitlines()) if line.strip()
    ]
