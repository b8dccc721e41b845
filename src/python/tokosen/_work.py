"""Progress and findings: what the user hears while the work is done, and after it."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from tokosen._errors import FindingWarning

Report = Callable[[str, float | None], object]
"""Called with the name of the step and the share of it that is done, 0 to 1, or None if that is not known."""

Progress = Report | bool | None
"""A function, True for bars of tqdm, or None for nothing."""


@contextmanager
def reporting(progress: Progress) -> Iterator[Report | None]:
    """What the work calls to tell its progress."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        bars = _Bars()
        try:
            yield bars
        finally:
            bars.close()
    elif callable(progress):
        yield progress
    else:
        raise TypeError(f"progress is of type {type(progress).__name__}; it must be a function, True or None")


class _Bars:
    """A bar of tqdm for each step."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError as error:
            raise ModuleNotFoundError("progress=True needs tqdm: pip install tqdm") from error
        self.tqdm = tqdm
        self.step = ""
        self.bar: Any = None

    def __call__(self, step: str, share: float | None) -> None:
        if step != self.step:
            self.close()
            self.step = step
            self.bar = self.tqdm(desc=step, total=100, bar_format="{desc}: {percentage:3.0f} % |{bar}| {elapsed}")
        if share is not None:
            self.bar.n = round(100 * share)
            self.bar.refresh()

    def close(self) -> None:
        """Ends the bar of the running step."""
        if self.bar is not None:
            self.bar.n = 100
            self.bar.close()
            self.bar = None


def warn_of(findings: Iterable[tuple[str, str, str]], stacklevel: int = 4) -> None:
    """Warns of findings: once for each kind, with the first one and their number."""
    findings = list(findings)
    counts = Counter(code for _, code, _ in findings)
    told: set[str] = set()
    for severity, code, message in findings:
        if code not in told:
            told.add(code)
            others = counts[code] - 1
            more = f" (and {others} more of this kind; see findings)" if others else ""
            warnings.warn(f"{severity}: {message}{more}", FindingWarning, stacklevel=stacklevel)
