"""Write the skeleton of a method or a scene: `make new-method NAME=...`, `make new-scene NAME=...`.

The templates beside this file hold a small method and a small scene that pass the contract tests at once. The word NAME
in them becomes the name. Nothing that exists is overwritten.
"""

import keyword
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
TEMPLATES = Path(__file__).parent / "templates"

# Template, and where it goes.
FILES = {
    "method": {
        "method.py": "refdof/methods/NAME.py",
        "naive.py": "tests/naive_NAME.py",
        "test.py": "tests/test_NAME.py",
    },
    "scene": {
        "scene.py": "refdof/scenes/NAME.py",
        "scene.toml": "data/scenes/NAME.toml",
    },
}
NEXT = {
    "method": "Now replace the algorithm, its twin and its record; correct papers.bib and the row in README.md.",
    "scene": "Now build your own scene, and choose its shot in the .toml file.",
}
ROW = "| `NAME` | Author 2026 | pinhole colour, pinhole depth | constant, pinhole, focus, convexity, symmetry |"
ENTRY = """
@misc{NAME,
  author = {Author},
  title  = {Title},
  year   = {2026}
}
"""


def main(words: list[str]) -> int:
    """Write what `words`, kind and name, ask for; 0 if it was done, 2 for bad input."""
    kind, name = (*words, "", "")[:2]
    try:
        written = new(kind, name)
    except ValueError as error:
        print(f"new-{kind}: {error}", file=sys.stderr)
        return 2
    print("\n".join([*written, NEXT[kind]]))
    return 0


def new(kind: str, name: str) -> list[str]:
    """Write the skeleton; returns the files that are new or changed."""
    if kind not in FILES:
        raise ValueError(f"kind: got {kind!r}; allowed are {', '.join(FILES)}")
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or keyword.iskeyword(name):
        raise ValueError(f"NAME: got {name!r}; allowed are lower-case letters, digits and _, a letter first")
    targets = {source: target.replace("NAME", name) for source, target in FILES[kind].items()}
    for target in targets.values():
        if (ROOT / target).exists() or (ROOT / target).with_suffix("").is_dir():
            raise ValueError(f"NAME: got {name!r}, but {target} exists; allowed is a new name")
    for source, target in targets.items():
        (ROOT / target).write_text(_read(TEMPLATES / source).replace("NAME", name), encoding="utf-8")
    changed = list(targets.values())
    if kind == "method":
        _add_row(ROOT / "README.md", ROW.replace("NAME", name))
        entries = ROOT / "papers.bib"
        entries.write_text(_read(entries) + ENTRY.replace("NAME", name), encoding="utf-8")
        changed += ["README.md", "papers.bib"]
    return changed


def _add_row(readme: Path, row: str) -> None:
    """Put the row into the method table, which is in the order of names."""
    lines = _read(readme).split("\n")
    rows = [k for k, line in enumerate(lines) if line.startswith("| `")]
    first = next(k for k in rows if k > lines.index("| method | source | what it needs | promises |"))
    last = next(k for k in range(first, len(lines)) if not lines[k].startswith("| `"))
    lines[first:last] = sorted([*lines[first:last], row])
    readme.write_text("\n".join(lines), encoding="utf-8")


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
