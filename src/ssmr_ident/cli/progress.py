"""Progress on a terminal, silence when piped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def stages(hidden: bool = False) -> Iterator[Callable[[str, int, int], None]]:
    """Yield a function that takes a stage's name, how much of it is done, and of how much."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if hidden or not console.is_terminal:
        yield lambda name, done, total: None
        return
    columns = (TextColumn("{task.description:<48}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        tasks: dict[str, TaskID] = {}

        def step(name: str, done: int, total: int) -> None:
            if name not in tasks:
                tasks[name] = bar.add_task(name, total=total)
            bar.update(tasks[name], completed=done, total=total)

        yield step


@contextmanager
def counted(what: str, hidden: bool = False) -> Iterator[Callable[[int, int], None]]:
    """Yield a function that takes the number done and the total, for long work: shows when it will end."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if hidden or not console.is_terminal:
        yield lambda done, total: None
        return
    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), "left")
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True, speed_estimate_period=600.0) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def progress(what: str, hidden: bool = False) -> Iterator[Callable[[int, int], None]]:
    """Yield a function that takes the number done and the total."""
    with stages(hidden) as step:
        yield lambda done, total: step(what, done, total)


@contextmanager
def doing(what: str = "", hidden: bool = False) -> Iterator[Callable[[str], None]]:
    """Yield a function that shows what is being done, for work whose length is not known beforehand."""
    from rich.console import Console

    console = Console(stderr=True)
    if hidden or not console.is_terminal:
        yield lambda text: None
        return
    with console.status(what) as status:
        yield status.update
