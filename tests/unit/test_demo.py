"""``ident demo``: what it prints of what it hid and found."""

from __future__ import annotations

from pathlib import Path

from made_diagnoses import hardening, nothing
from typed_command import typed

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.workflows.demo.hidden import Hidden


def test_before_after_and_floor_are_drawn_in_proportion() -> None:
    shown = str(Hidden({"nonlinear_stiffness": {"k3_N_m3": Estimate(3e8)}}, hardening(), Path("rig"), Path("r.html")))
    assert "hidden  nonlinear_stiffness, k3_N_m3 = 3e+08" in shown
    assert "found   nonlinear_stiffness, k3_N_m3 = (3.10 ± 0.21)·10⁸ N/m³" in shown
    lengths = {line.split("  ")[1]: line.count("█") for line in shown.splitlines() if "█" in line}
    assert lengths == {"model before": 40, "nonlinear stiffness added": 6, "noise alone": 5}  # of 22.0, 3.4, 2.9


def test_nothing_hidden_and_nothing_found() -> None:
    shown = str(Hidden({}, nothing(), Path("rig"), Path("r.html")))
    assert "hidden  nothing\nfound   nothing missing" in shown
    assert "added" not in shown


def test_what_no_rig_has_is_told(tmp_path: Path) -> None:
    told = typed("demo", "--hide", "dry_fricton:F_c_N=1", cwd=tmp_path)
    assert told.returncode == 2
    assert "dry_friction" in told.stderr.splitlines()[-1]
