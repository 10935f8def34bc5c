"""``ident export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli.effect_files import EffectFiles

EXAMPLES = (
    "ident export params.yaml --to mjcf -o robot.xml",
    "ident export p3at-extended --to csv -o robot.csv",
    "ident export roll-1.xlsx --to parquet -o roll-1.parquet",
)


def command(
    what: Annotated[str, typer.Argument(metavar="PARAMS-or-LOG", help="Parameter file, bundled robot, or a log.")],
    to: Annotated[str, typer.Option("--to", help="Parameters: mjcf, urdf, mat or csv. A log: parquet, mat or uff.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="File to write.")],
    sample: Annotated[int, typer.Option(min=1, help="Which recording of a log that holds several.")] = 1,
    effects: EffectFiles = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was written as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Identified parameters, or a log, as a file of another tool."""
    from ssmr_ident.core.atomic import refuse_overwriting, write_bytes
    from ssmr_ident.core.errors import InputError, did_you_mean
    from ssmr_ident.readers import read
    from ssmr_ident.session import bundled_robots, read_parameters
    from ssmr_ident.workflows.export import PARAMETER_FORMATS, RECORDING_FORMATS, parameters_as, write_recording_as

    parameters = what in bundled_robots() or Path(what).suffix.lower() in (".yaml", ".yml")
    forms = PARAMETER_FORMATS if parameters else RECORDING_FORMATS
    if to not in forms:
        kind = "parameters" if parameters else "a log"
        raise InputError(f"--to {to}", f"is no form of {kind}", did_you_mean(to, forms))
    refuse_overwriting(output, [what])
    if parameters:
        write_bytes(output, parameters_as(read_parameters(what), to))
    else:
        recordings = read(what)
        if sample > len(recordings):
            raise InputError(f"--sample {sample}", f"{what} holds {len(recordings)}", f"Give 1 to {len(recordings)}")
        write_recording_as(output, recordings[sample - 1], to)
    if as_json:
        from ssmr_ident.cli.answer import print_json

        print_json({"file": str(output), "form": to})
    elif not quiet:
        typer.echo(f"written: {output}")
