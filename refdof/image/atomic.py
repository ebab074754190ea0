"""Atomic output: a file is written under another name beside its target and then renamed.

A reader, an interrupted run or a full disk never meets half a file: until the rename the old file stays as
it was.
"""

import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from refdof._check import InputError
from refdof._process import unfinished

__all__ = [
    "atomic_folder",
    "atomic_path",
    "check_file",
    "check_folder",
    "check_own_folder",
    "write_bytes",
    "write_text",
]


@contextmanager
def atomic_path(target: str | os.PathLike[str], argument: str = "out") -> Iterator[Path]:
    """Yield a temporary path with the suffix of `target`; on a clean exit it takes the place of `target`.

    Parameters
    ----------
    target : path
        Missing parent folders are made. A symbolic link is followed, so that the link itself stays.
    argument : str
        What an error message calls the target.

    Raises
    ------
    InputError
        If the target is not a plain file or cannot be written. Any other error of the body passes through.
        In both cases the temporary file is gone and the old target untouched.
    """
    try:
        final = Path(target).resolve()
        if final.exists() and not final.is_file():
            raise _irregular(argument, target)
        temporary = final.parent / f".refdof-{secrets.token_hex(8)}{final.suffix}"
        final.parent.mkdir(parents=True, exist_ok=True)
        temporary.touch(exist_ok=False)  # fails here, before any work, if the folder is read-only
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise _unwritable(argument, target, error) from None
    try:
        with unfinished(temporary):
            yield temporary
            os.replace(temporary, final)
    except OSError as error:
        raise _unwritable(argument, target, error) from error
    finally:
        temporary.unlink(missing_ok=True)


def check_own_folder(folder: Path, own: Callable[[str], bool], argument: str = "out") -> None:
    """Raise if a folder cannot be written, or holds files other than those whose names are `own`."""
    check_folder(folder, argument, beside=True)
    if folder.is_dir() and not all(own(path.name) for path in folder.iterdir()):
        raise InputError(
            f"{argument}: got {str(folder)!r}, which holds other files; allowed is a new or empty folder, "
            "or an earlier one"
        )


@contextmanager
def atomic_folder(target: str | os.PathLike[str], argument: str = "out") -> Iterator[Path]:
    """Yield a new temporary folder beside `target`; on a clean exit it takes the place of `target`, files and all.

    Whether what is there may be replaced is the caller's to check.

    Raises
    ------
    InputError
        If the target cannot be written. Any other error of the body passes through. In both cases the temporary folder
        is gone and the old target untouched.
    """
    final = Path(target).resolve()
    temporary, old = (final.parent / f".refdof-{secrets.token_hex(8)}" for _ in range(2))
    try:
        with unfinished(temporary):
            temporary.mkdir(parents=True)
            yield temporary
            if final.exists():
                os.replace(final, old)
            try:
                os.replace(temporary, final)
            except OSError:
                if old.exists():
                    os.replace(old, final)
                raise
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise _unwritable(argument, target, error) from error
    finally:
        for folder in (temporary, old):
            shutil.rmtree(folder, ignore_errors=True)


def write_bytes(target: str | os.PathLike[str], content: bytes, argument: str = "out") -> None:
    """Write `content` to `target` in one step."""
    with atomic_path(target, argument) as temporary:
        temporary.write_bytes(content)


def write_text(target: str | os.PathLike[str], text: str, argument: str = "out") -> None:
    """Write `text` to `target` as UTF-8 with line feeds, in one step."""
    with atomic_path(target, argument) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def _irregular(argument: str, target: object) -> InputError:
    return InputError(f"{argument}: got {str(target)!r}, which is not a regular file; allowed is the path of a file")


def _unwritable(argument: str, target: object, error: Exception) -> InputError:
    reason = getattr(error, "strerror", None) or str(error)
    return InputError(f"{argument}: cannot write {str(target)!r} ({reason}); allowed is a path that can be written")


def check_folder(folder: str | os.PathLike[str], argument: str = "out", beside: bool = False) -> None:
    """Raise before a long run if `folder` cannot be made or written to; leaves nothing.

    Parameters
    ----------
    folder : path
    argument : str
        What an error message calls it.
    beside : bool
        Whether its parent is written to as well, as `atomic_folder` does.

    Raises
    ------
    InputError
        If its nearest existing parent is no folder, or no file can be made there.
    """
    final = Path(folder).resolve()
    if beside:
        _check_place(final.parent, argument, folder)
    _check_place(final, argument, folder)


def check_file(file: str | os.PathLike[str], argument: str = "out") -> None:
    """Raise before a long run if `file` cannot be written; leaves nothing.

    Raises
    ------
    InputError
        If it is no plain file, or none can be made in its folder.
    """
    final = Path(file).resolve()
    try:
        plain = final.is_file() or not final.exists()
    except OSError as error:  # a name too long
        raise _unwritable(argument, file, error) from None
    if not plain:
        raise _irregular(argument, file)
    _check_place(final.parent, argument, file)


def _check_place(place: Path, argument: str, got: object) -> None:
    """Raise if no file can be made in the nearest existing folder: permissions do not tell, least of all for root."""
    try:
        while not place.exists() and place != place.parent:
            place = place.parent
        temporary = place / f".refdof-{secrets.token_hex(8)}"
        with unfinished(temporary):
            temporary.touch(exist_ok=False)
            temporary.unlink()
    except (OSError, ValueError):
        raise InputError(f"{argument}: got {str(got)!r}, but {place} is not a writable folder") from None
