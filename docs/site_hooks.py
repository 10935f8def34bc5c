"""What the pages take from the code while they are built: commands, which effect shows where, schemas; TeX to MathML.

MathML is drawn by the browser itself, so the built pages need no network and no script.
"""

from __future__ import annotations

import html
import importlib
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer
from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

from ssmr_ident import cli
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.session.json_schema import MADE, schema_file

SCHEMAS = Path(__file__).parent / "schemas"
INPUTS = tuple(schema_file(name) for name in MADE)
_TEX = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def commands() -> str:
    """Every verb with its arguments, options and examples."""
    group = typer.main.get_command(cli.app)
    lines = []
    for verb in cli.VERBS:
        command = group.commands[verb]  # type: ignore[attr-defined]
        lines += [f"## ident {verb}", "", (command.help or "").strip(), "", "```sh"]
        lines += [*importlib.import_module(f"ssmr_ident.cli.{verb}").EXAMPLES, "```", ""]
        lines += ["| argument or option | meaning |", "| --- | --- |"]
        for parameter in command.params:
            argument = parameter.param_type_name == "argument"
            options = ", ".join([*parameter.opts, *parameter.secondary_opts])
            name = (parameter.metavar or parameter.name.upper()) if argument else options
            default = parameter.default
            usual = "" if default in (None, "", False, ()) or callable(default) else f" Usually `{default}`."
            help_text = html.escape((getattr(parameter, "help", "") or "").replace("|", "\\|"), quote=False)
            lines.append(f"| `{name}` | {help_text}{usual} |")
        lines.append("")
    return "\n".join(lines)


def experiments() -> str:
    """Kinds of experiment, from the declarations."""
    lines = ["| experiment | what drives it | what has to be logged | compared by | refitted for each recording |"]
    lines += ["| --- |" + " --- |" * 4]
    for kind in EXPERIMENTS.values():
        logged = "; ".join(" or ".join(f"`{name}`" for name in group) for group in kind.channels)
        cells = (f"`{kind.name}`", kind.drive.value, logged, kind.likelihood.value, ", ".join(kind.nuisances))
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def where_effects_show() -> str:
    """Effects against experiments, from the declarations."""
    lines = [f"| effect | {' | '.join(kind.words for kind in EXPERIMENTS.values())} | on a rig |"]
    lines += ["| --- |" + " :-: |" * (len(EXPERIMENTS) + 1)]
    for effect in CATALOGUE.values():
        marks = ["●" if kind.shows(effect) else "" for kind in EXPERIMENTS.values()]
        link = f"[`{effect.id}`](../reference/effects.md#{effect.id})"
        lines.append(f"| {link} | {' | '.join(marks)} | {'●' if effect.rig else ''} |")
    return "\n".join(lines)


def schemas() -> str:
    """The published schemas with their titles, those of the two files that people write first."""
    lines = ["| schema | |", "| --- | --- |"]
    for path in [*INPUTS, *sorted(SCHEMAS.glob("*.json"))]:
        title = json.loads(path.read_text(encoding="utf-8"))["title"]
        lines.append(f"| [{path.name.removesuffix('.schema.json')}](../schemas/{path.name}) | {title} |")
    return "\n".join(lines)


MARKS: dict[str, Callable[[], str]] = {
    "<!-- commands -->": commands,
    "<!-- experiments -->": experiments,
    "<!-- where effects show -->": where_effects_show,
    "<!-- schemas -->": schemas,
}


def on_files(files: Files, config: Any) -> Files:
    """The shipped schemas among the published ones."""
    for path in INPUTS:
        files.append(File.generated(config, f"schemas/{path.name}", abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Fill in what a mark asks for."""
    for mark, text in MARKS.items():
        if mark in markdown:
            markdown = markdown.replace(mark, text())
    return markdown


def on_page_content(content: str, **_: Any) -> str:
    """TeX to MathML."""

    def drawn(match: re.Match[str]) -> str:
        tex = html.unescape(match[3]).strip()
        return convert(tex, display="block" if match[2] == "[" else "inline")

    return _TEX.sub(drawn, content)
