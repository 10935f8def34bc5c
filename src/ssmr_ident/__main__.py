"""``ident``, also as ``python -m ssmr_ident``: nothing is imported before the run can be stopped."""

from ssmr_ident.core.stopping import asked, end_now, stoppable


def main() -> None:
    """Run ``ident``; see ``ssmr_ident.cli.main``."""
    import signal

    try:
        with stoppable():
            from ssmr_ident.cli import main as run

            run()
    except KeyboardInterrupt:
        # not by sys.exit: an interrupt on its way through an exec(), as of a dataclass, makes Python end by SIGINT
        end_now(asked() or signal.SIGINT)


if __name__ == "__main__":
    main()
