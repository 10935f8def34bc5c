"""``ident proof``: physics concealed by another engine, found blind, unsealed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

EXAMPLES = (
    "ident proof --cases 12 --seed 7 --jobs 2 -o out/proof",
    "ident proof --unseal data/raw/concealed/a --diagnosis out/a",
    "ident proof --unseal out/proof",
)


def command(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for sessions, answers and the page.")] = Path(
        "out/proof"
    ),
    cases: Annotated[int, typer.Option(min=1, help="How many sealed sessions.")] = 12,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of all draws; left out: drawn, and told once all is opened.")
    ] = None,
    jobs: Annotated[int, typer.Option("-j", "--jobs", min=1, help="Processes side by side.")] = 2,
    peers: Annotated[bool, typer.Option("--peers", help="Run other programs on the same sessions too.")] = False,
    unseal: Annotated[
        Path | None, typer.Option(help="Check the seal of a kept session, or of a whole proof, and open it.")
    ] = None,
    diagnosis: Annotated[
        Path | None, typer.Option(help="With --unseal: what ident diagnose wrote on that session before.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Hide physics in another engine's recordings, seal it, diagnose blind, open the seals and count."""
    from importlib.util import find_spec

    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.core.errors import InputError

    if find_spec("ssmr_proof") is None:
        mend = "It comes with the library: pip install 'ssmr_ident[proof]'"
        raise InputError("proof", "the package ssmr_proof is not installed", mend)
    from ssmr_proof.seal import SealBroken

    try:
        if unseal is not None:
            result, text = _unsealed(unseal, diagnosis)
        else:
            result, text = _proved(output, cases, seed, jobs, peers, quiet or as_json)
    except SealBroken as error:
        typer.echo(f"ident: SEAL BROKEN: {error}", err=True)
        raise typer.Exit(1) from error
    if as_json:
        print_json(result)
    elif not quiet:
        typer.echo(text)


def _proved(
    output: Path, cases: int, seed: int | None, jobs: int, peers: bool, hidden: bool
) -> tuple[dict[str, object], str]:
    import secrets

    from ssmr_ident.cli.progress import stages
    from ssmr_proof.kept import write_kept
    from ssmr_proof.page.page import write_proof_page
    from ssmr_proof.run import prove
    from ssmr_proof.scores.against import against, peer_rows, peer_section

    seed = secrets.randbelow(2**31) if seed is None else seed
    call = f"ident proof --cases {cases} --seed {seed} --jobs {jobs} -o {output}" + (" --peers" if peers else "")

    def announce(seals: str) -> None:
        if not hidden:
            typer.echo(f"sealed before any diagnosis, {output / 'seals.csv'}:\n{seals}")

    with stages(hidden=hidden) as step:
        proof = prove(cases, seed, output, jobs, progress=step, announce=announce)
        step("page", 0, 1)
        page = write_proof_page(proof, call, ())
        write_kept(proof, call, ())
        step("page", 1, 1)
        # other programs take as long again: what the proof came to is not to be lost by breaking them off
        scores = against(proof.rows, output / "sessions", jobs, step) if peers else ()
        if peers:
            page = write_proof_page(proof, call, (peer_section(scores),))
            write_kept(proof, call, scores)
    text = f"{proof}\n" + "\n".join("  " + "  ".join(score.cells()) for score in scores)
    text += f"\ntable: {output / 'proof.csv'}, {output / 'proof.md'}\npage:  {page}\nagain: {call}"
    rows = [row.as_dict() for row in proof.rows]
    return {"seed": seed, "cases": rows, "peers": peer_rows(scores), "page": str(page)}, text


def _unsealed(folder: Path, diagnosis: Path | None) -> tuple[dict[str, object], str]:
    from ssmr_proof.unseal import recheck, unseal

    if (folder / "seals.csv").is_file():
        count = recheck(folder)
        return {"seals": count, "hold": True}, f"{folder}: all {count} seals hold"
    found = unseal(folder, diagnosis)
    return {"seal": found.seal, "truth": dict(found.row.truth), **found.row.as_dict()}, str(found)
