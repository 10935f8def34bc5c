"""``ident geometry``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

EXAMPLES = (
    "ident geometry docs/howto/measurements.yaml",
    "ident geometry measurements.yaml -o geometry.yaml",
)


def command(
    measurements: Annotated[Path, typer.Argument(help="Sheet of weighings, tilting angles and parts (YAML).")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Where to write the entries for robot.yaml.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing.")] = False,
    seed: Annotated[
        int, typer.Option(min=0, help="Of the draws that carry the parts' uncertainty to the inertia.")
    ] = 0,
) -> None:
    """Centre of mass, contact points and inertia from weighing, tilting and a list of parts."""
    import numpy as np

    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.core.atomic import refuse_overwriting, refuse_unwritable
    from ssmr_ident.identify.geometry.sheet import robot_geometry
    from ssmr_ident.session import write_parameters
    from ssmr_ident.session.yaml_file import load_mapping

    if output is not None:
        refuse_unwritable(output)
        refuse_overwriting(output, [measurements])
    geometry = robot_geometry(load_mapping(measurements), str(measurements), seed)
    parameters = geometry.parameters()
    if output is not None:
        write_parameters(output, parameters)
    if as_json:
        rows = {
            path: {"value": np.asarray(entry.value).tolist(), "std": entry.std, "unit": entry.unit}
            for path, entry in parameters.estimates.items()
        }
        print_json(rows, indent=1)
    elif not quiet:
        typer.echo(str(geometry))
        if output is not None:
            typer.echo(f"written: {output}")
