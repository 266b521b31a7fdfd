"""The command `trackride`, which is also `python -m app`."""

import signal


def main() -> None:
    """Entry point of the command."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not where a shell has it ignored
        # Ctrl+C ends it at once, whatever is being loaded: libraries lose KeyboardInterrupt. Commands that have
        # something to finish see to it themselves.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from app.cli import main as run_command

    run_command()


if __name__ == "__main__":
    main()
