"""``python -m ssmr_ident`` does what ``ident`` does."""

from ssmr_ident.cli import main

if __name__ == "__main__":
    main()
