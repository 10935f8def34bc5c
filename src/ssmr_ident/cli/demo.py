"""``ident demo``: hides physics in recordings of a rig and finds it; other main jobs behind options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

EXAMPLES = (
    "ident demo",
    "ident demo --hide nonlinear_stiffness:k3_N_m3=2e7",
    "ident demo --hide nothing",
    "ident demo --campaign data -o out",
    "ident demo --thesis",
)

BEFORE = """\
Six recordings of a made-up rig, 2 kg on a spring, let go from 2 to 7 mm, with physics in them that the model is not
told of; then a search for what the model lacks. 15 s of one processor; the first time, when loops are compiled, 50 s.
"""
AFTER = """
Logs of your own, in a folder:
  ident inspect FOLDER                              what they hold, and what is wrong with them
  ident new FOLDER --mass-kg 2.0                    session.yaml and rig.yaml, from a look at the logs
  ident diagnose FOLDER -o FOLDER-diagnosis         what the model lacks, and the page that shows it
A robot, a pulled block, a rotary rig: ident new --help. Something else hidden here: ident demo --help."""


def command(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for logs, parameters, report.")] = Path("out"),
    hide: Annotated[
        str,
        typer.Option(metavar="ID:KEY=VALUE", help="What to hide (ident effects lists all); 'nothing' hides nothing."),
    ] = "dry_friction:F_c_N=0.4",
    seed: Annotated[int, typer.Option(min=0, help="Of the noise in the recordings.")] = 0,
    campaign: Annotated[
        Path | None,
        typer.Option(help="Instead: fit and compare a robot's reference campaign, raw/ and published/ in this folder."),
    ] = None,
    thesis: Annotated[
        bool, typer.Option("--thesis", help="Instead: check the thesis' statements on the simulator.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing.")] = False,
) -> None:
    """Hide physics in recordings of a rig, find it, and show what that is worth on recordings never fitted."""
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.called import called
    from ssmr_ident.cli.progress import doing, stages
    from ssmr_ident.core.errors import InputError

    silent = quiet or as_json
    if thesis and campaign is not None:
        raise InputError("--thesis", "stands beside --campaign", "Ask for one of them")
    if thesis:
        from ssmr_ident.workflows.demo.thesis import thesis_scoreboard

        with doing(hidden=silent) as tell:
            board = thesis_scoreboard().thesis_scoreboard(tell)
        if as_json:
            print_json(board.as_dict())
        elif not quiet:
            print(board)
        return
    if campaign is not None:
        from ssmr_ident.workflows.demo.campaign import check_data, run_demo
        from ssmr_ident.workflows.demo.campaign_page import write_demo_report

        check_data(campaign)
        with stages(hidden=silent) as step:
            demo = run_demo(campaign, output, step)
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
        return
    if not silent:
        print(BEFORE, flush=True)
    from ssmr_ident.workflows.demo.hidden import hide_and_find

    with stages(hidden=silent) as step:
        found = hide_and_find("" if hide == "nothing" else hide, output, seed, step, called())
    if as_json:
        print_json(found.as_dict())
    elif not quiet:
        print(found)
        print(AFTER)
