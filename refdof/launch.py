"""Launch: the program `refdof`. Nothing slow is imported before Ctrl-C is heard."""

import signal

_HEARD = signal.getsignal(signal.SIGINT)
if _HEARD is signal.default_int_handler:  # not ignored, as a shell's background jobs have it
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # until Ctrl-C is heard, it ends this process without a word

import sys  # noqa: E402

from refdof._process import INTERRUPTED, hear_no_more, work_in_child  # noqa: E402

__all__ = ["main"]


def main() -> None:
    """Run the command line in a child process."""
    work_in_child()
    try:
        signal.signal(signal.SIGINT, _HEARD)
        from refdof.cli import main as run

        run()
    except KeyboardInterrupt:  # while importing
        hear_no_more()
        print("refdof: interrupted; nothing was written", file=sys.stderr)
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
