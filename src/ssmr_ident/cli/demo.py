"""``ident demo``: the whole main job on the reference campaign."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

EXAMPLES = (
    "ident demo -o out",
    "ident demo --thesis",
)


def command(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for parameters, report and tables.")] = Path(
        "out"
    ),
    data: Annotated[
        Path | None, typer.Option(help="Folder that holds raw/ and published/; the checkout's own.")
    ] = None,
    thesis: Annotated[
        bool, typer.Option("--thesis", help="Check the thesis' statements on the simulator instead.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing.")] = False,
) -> None:
    """Raw logs to spectra, to parameters, to a simulation, and back to the logs."""
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.called import called
    from ssmr_ident.cli.progress import doing, stages

    if thesis:
        from ssmr_ident.workflows.demo.thesis import thesis_scoreboard

        with doing(hidden=quiet or as_json) as tell:
            board = thesis_scoreboard().thesis_scoreboard(tell)
        if as_json:
            print_json(board.as_dict())
        elif not quiet:
            print(board)
        return
    from ssmr_ident.workflows.demo.page import write_demo_report
    from ssmr_ident.workflows.demo.run import find_data, run_demo

    with stages(hidden=quiet or as_json) as step:
        demo = run_demo(find_data(data), output, step)
        step("report", 0, 1)
        report = write_demo_report(demo, called())
        step("report", 1, 1)
    if as_json:
        print_json({"table": demo.table.as_list(), "report": str(report)})
    elif not quiet:
        print(demo.table)
        print()
        for comparison in demo.comparisons:
            means = ", ".join(f"{value:.3g} {metric}" for metric, value in comparison.overall.items())
            print(f"{comparison.session}: {len(comparison.recordings)} recordings, simulation apart by {means}")
        print(f"\nparameters: {output / 'parameters.yaml'}\nreport:     {report}")
