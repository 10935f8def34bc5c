"""``ident fit``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli.effect_files import EffectFiles

EXAMPLES = (
    "ident fit data/raw/free_response -o out/params.yaml",
    "ident fit my-session -o params.yaml --figures figures",
    "ident fit my-session --method modal --json",
)


def command(
    session: Annotated[Path, typer.Argument(help="Session folder, or its session.yaml.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Where to write the parameters (params.yaml).")
    ] = None,
    effects: EffectFiles = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of the random starts of output error.")] = 0,
    method: Annotated[
        str | None,
        typer.Option(
            help="How a robot's free responses are fitted: output-error (all samples) or modal (their frequencies and "
            "damping). Left out: output-error wherever there are accelerations."
        ),
    ] = None,
    figures: Annotated[
        Path | None,
        typer.Option(help="Folder for report.html and figures: frequency and damping over amplitude, saw-teeth."),
    ] = None,
    coulomb: Annotated[
        bool, typer.Option(help="Allow dry friction and a force offset for a drive without a spring.")
    ] = True,
) -> None:
    """Frequencies, damping, stiffness, inertia, friction from the recordings, with uncertainties."""
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.called import called
    from ssmr_ident.cli.progress import stages
    from ssmr_ident.core.atomic import make_folder, refuse_overwriting, refuse_unwritable
    from ssmr_ident.session import write_parameters
    from ssmr_ident.workflows.files_read import files_read
    from ssmr_ident.workflows.fit.page import write_fit_page
    from ssmr_ident.workflows.fit.run import fit_session

    for wanted in (output, figures):
        if wanted is not None:
            refuse_unwritable(wanted)
    if output is not None:
        refuse_overwriting(output, files_read(session))
    with stages(hidden=quiet or as_json) as step:
        fit = fit_session(session, seed=seed, coulomb=coulomb, method=method, progress=step)
        if output is not None:
            make_folder(output.absolute().parent)
            write_parameters(output, fit.parameters)
    # what was found is said before anything is drawn of it
    if as_json:
        print_json(fit.as_dict(), indent=1)
    elif not quiet:
        typer.echo(str(fit))
        if output is not None:
            typer.echo(f"written: {output}")
    if figures is None:
        return
    with stages(hidden=quiet or as_json) as step:
        step("drawing", 0, 1)
        drawn = fit.write_figures(figures)
        write_fit_page(fit, figures, called(), seed, session)
        step("drawing", 1, 1)
    if not (quiet or as_json):
        typer.echo(f"report.html in {figures}, figures: {len(drawn) or 'none, for there was nothing to draw'}")
