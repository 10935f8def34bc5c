"""``ident``, also as ``python -m ssmr_ident``: nothing is imported before the run can be stopped."""

from ssmr_ident.core.stopping import STOPPED, asked, stoppable


def main() -> None:
    """Run ``ident``; see ``ssmr_ident.cli.main``."""
    import sys

    try:
        with stoppable():
            from ssmr_ident.cli import main as run

            run()
    except KeyboardInterrupt:
        print(STOPPED, file=sys.stderr)
        sys.exit(128 + asked())


if __name__ == "__main__":
    main()
