"""Draw the figures that README.md shows, from data/raw: python docs/make_images.py."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.compare import predict
from ssmr_ident.experiments.campaign import load
from ssmr_ident.report.overlay import overlay_figure
from ssmr_ident.report.style import save
from ssmr_ident.session import read_parameters

ROOT = Path(__file__).resolve().parents[1]


def main() -> None:
    folder = ROOT / "data" / "raw" / "free_response"
    campaign = load(folder)
    measurement = next(m for m in campaign.measurements if m.entry.file == "roll-1.xlsx")
    prediction = predict(campaign, measurement, read_parameters(folder / "truth.yaml"))
    figure = overlay_figure(
        prediction, "A free response in roll: recorded (synthetic), simulated, and what is left; below 50 Hz"
    )
    save(figure, ROOT / "docs" / "images" / "overlay")


if __name__ == "__main__":
    main()
