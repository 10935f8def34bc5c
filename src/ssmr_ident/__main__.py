"""``ident``, also as ``python -m ssmr_ident``: nothing is imported before the run can be stopped."""

from ssmr_ident.core.stopping import STOPPED, Stopped, stoppable


def main() -> None:
    """Run ``ident``; see ``ssmr_ident.cli.main``."""
    import sys

    try:
        with stoppable():
            from ssmr_ident.cli import main as run

            run()
    except Stopped as stopped:
        print(STOPPED, file=sys.stderr)
        sys.exit(128 + stopped.number)


if __name__ == "__main__":
    main()
