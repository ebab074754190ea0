"""Results: the points of sweeps in one DuckDB file, a row each, which any later sweep goes on with.

The only file that imports duckdb. A row is there or not: each is a transaction of its own, on the disk before the next
point begins. So a run that is killed loses the point that was being measured. What the file is not fit for is said, and
it is kept under another name: one of another version of refdof, and one that is damaged.
"""

import json
import math
import os
import sys
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from types import TracebackType
from typing import Any

import duckdb

from refdof._check import InputError
from refdof.image.atomic import atomic_path, check_folder
from refdof.metrics import METRICS
from refdof.sweep.measured import Measured

__all__ = ["Results"]

_TYPES = {str: "VARCHAR", int: "BIGINT", float: "DOUBLE"}
_JSON = ("params", "varied", "artefacts")
_PLAIN = [field for field in fields(Measured) if field.name not in (*_JSON, "scores")]
_COLUMNS = {
    **{field.name: _TYPES[field.type] for field in _PLAIN},  # type: ignore[index]
    **{name: "DOUBLE" for name in METRICS},
    **{name: "JSON" for name in _JSON},
}


class Results:
    """The points of sweeps, kept in a file.

    Parameters
    ----------
    file : path
        Made if it is not there.

    Raises
    ------
    InputError
        If the file cannot be written, or another sweep holds it.
    """

    def __init__(self, file: str | os.PathLike[str]) -> None:
        self.file = Path(file)
        check_folder(self.file.parent)
        self.file.parent.mkdir(parents=True, exist_ok=True)
        self._base = self._open()

    def __enter__(self) -> "Results":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with suppress(duckdb.Error):  # the rows are on the disk already
            self._base.close()

    def keys(self) -> set[str]:
        """The keys of all points."""
        return {key for (key,) in self._base.execute("SELECT key FROM points").fetchall()}

    def points(self, keys: Iterable[str] | None = None) -> list[Measured]:
        """The points of these keys, in their order; None: all, in the order in which they were measured."""
        names = ", ".join(f'"{name}"' for name in _COLUMNS)
        rows = self._base.execute(f"SELECT {names} FROM points ORDER BY rowid").fetchall()
        found = [_measured(dict(zip(_COLUMNS, row, strict=True))) for row in rows]
        if keys is None:
            return found
        by_key = {point.key: point for point in found}
        return [by_key[key] for key in keys if key in by_key]

    def add(self, point: Measured) -> None:
        """Write a point; one of the same key is replaced.

        Raises
        ------
        InputError
            If the disk is full. What was written before stays.
        """
        places = ", ".join("?" for _ in _COLUMNS)
        try:
            self._base.execute(f"INSERT OR REPLACE INTO points VALUES ({places})", list(_row(point).values()))
        except duckdb.Error as error:
            raise InputError(
                f"out: cannot write {str(self.file)!r} ({_first_line(error)}); the points before are kept; "
                "allowed is a place with room"
            ) from None

    def export(self, folder: Path) -> None:
        """Write all points as sweep.csv and sweep.parquet."""
        for name, words in {"sweep.csv": "FORMAT csv, HEADER", "sweep.parquet": "FORMAT parquet"}.items():
            with atomic_path(folder / name) as temporary:
                try:
                    self._base.execute(f"COPY (SELECT * FROM points ORDER BY rowid) TO {_quoted(temporary)} ({words})")
                except duckdb.Error as error:
                    message = f"out: cannot write {name} ({_first_line(error)}); allowed is a place with room"
                    raise InputError(message) from None

    def _open(self) -> Any:
        try:
            base = duckdb.connect(self.file)
            columns = self._columns_of(base)
        except duckdb.Error as error:
            if "lock" in str(error) and "Conflicting" in str(error):
                got = f"{str(self.file)!r}, which another sweep writes to"
                raise InputError(f"out: got {got}; allowed is another folder, or to wait") from None
            if not self.file.is_file() or not os.access(self.file, os.W_OK):
                got = f"{str(self.file)!r} ({_first_line(error)})"
                raise InputError(f"out: cannot write {got}; allowed is a folder that can be written") from None
            self._put_aside("damaged", "is damaged")
            return self._new()
        if columns == _COLUMNS:
            return base
        base.close()
        if columns is not None:
            self._put_aside("older", "is of another version of refdof")
        return self._new()

    def _columns_of(self, base: Any) -> dict[str, str] | None:
        """Names and types of the columns of a file's points; None of an empty file, {} of one with other tables."""
        tables = {name for (name,) in base.execute("SELECT table_name FROM duckdb_tables()").fetchall()}
        if not tables:
            return None
        if "points" not in tables:
            return {}
        base.execute("SELECT count(*), max(measured_at) FROM points")  # a damaged one is found now, not later
        return {row[0]: row[1] for row in base.execute("DESCRIBE points").fetchall()}

    def _new(self) -> Any:
        base = duckdb.connect(self.file)
        columns = ", ".join(f'"{name}" {kind}' for name, kind in _COLUMNS.items())
        base.execute(f"CREATE TABLE points ({columns}, PRIMARY KEY (key))")
        return base

    def _put_aside(self, why: str, words: str) -> None:
        number, other = 1, self.file.with_suffix(f".{why}.duckdb")
        while other.exists():
            number += 1
            other = self.file.with_suffix(f".{why}-{number}.duckdb")
        os.replace(self.file, other)
        with suppress(OSError):
            os.replace(f"{self.file}.wal", f"{other}.wal")
        print(f"refdof: {self.file} {words}: it is kept as {other.name}, and a new one is begun", file=sys.stderr)


def _row(point: Measured) -> dict[str, Any]:
    values = {field.name: getattr(point, field.name) for field in _PLAIN}
    values |= {name: point.scores.get(name, math.nan) for name in METRICS}
    return values | {name: json.dumps(_without_nan(getattr(point, name))) for name in _JSON}


def _measured(row: dict[str, Any]) -> Measured:
    found = {name: json.loads(row.pop(name)) for name in _JSON}
    found["artefacts"] = {name: math.nan if value is None else value for name, value in found["artefacts"].items()}
    scores = {name: row.pop(name) for name in METRICS}
    return Measured(**row, **found, scores=scores)


def _without_nan(values: Mapping[str, Any]) -> dict[str, Any]:
    """JSON has no NaN."""
    return {name: None if isinstance(value, float) and math.isnan(value) else value for name, value in values.items()}


def _quoted(path: Path) -> str:
    return "'" + str(path).replace("'", "''") + "'"


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0][:200] if str(error) else type(error).__name__
