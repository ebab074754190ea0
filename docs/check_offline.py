"""Check built pages: nothing that a browser loads by itself may come from elsewhere.

Links that a reader follows may lead anywhere; scripts, styles, fonts and pictures must lie beside the pages.
Run it from the root of the repository: ``python docs/check_offline.py build/docs``.
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path

__all__ = ["remote_parts"]

_LOADED = {
    "script": ("src",),
    "img": ("src", "srcset"),
    "iframe": ("src",),
    "source": ("src", "srcset"),
    "link": ("href",),
}
_REMOTE = re.compile(r"^\s*(https?:)?//")
_IN_STYLE = re.compile(r"(?:url\(|@import)\s*['\"]?\s*(?:https?:)?//[^'\")]*")


class _Reader(HTMLParser):
    """Collects the remote addresses of elements that a browser loads."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note an element's address if it leads elsewhere."""
        self.found += [value for key, value in attrs if value and key in _LOADED.get(tag, ()) and _REMOTE.match(value)]


def remote_parts(folder: Path) -> list[str]:
    """'page: address' of everything under `folder` that would be loaded from elsewhere."""
    found = []
    for path in sorted(folder.rglob("*")):
        if path.suffix == ".html":
            reader = _Reader()
            reader.feed(path.read_text())
            found += [f"{path}: {address}" for address in reader.found]
        if path.suffix in (".html", ".css"):
            found += [f"{path}: {address}" for address in _IN_STYLE.findall(path.read_text())]
    return found


if __name__ == "__main__":
    problems = remote_parts(Path(sys.argv[1]))
    print("\n".join(problems) or "nothing is loaded from elsewhere")
    sys.exit(1 if problems else 0)
