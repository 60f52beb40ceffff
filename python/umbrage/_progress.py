"""Reporting of progress to a caller's function, and cancellation of long work by Ctrl-C and exceptions."""
from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Callable, Generator, List, Optional, Type, Union

from ._errors import UsageError
from ._suggest import shown

Progress = Union[None, bool, Callable[[float], Any]]


def check_progress(progress: Any) -> None:
    """Checks a `progress` argument. Errors: UsageError."""
    if progress is not None and not isinstance(progress, bool) and not callable(progress):
        raise UsageError(f"`progress` takes True, False or a function of one number, not {shown(progress)}")


class Bar:
    """A progress bar on standard error: tqdm's if it is installed, else a line of text, on a terminal only."""

    def __init__(self) -> None:
        self._bar: Any = None
        self._started = time.monotonic()
        self._percent = -1
        self._is_terminal = sys.stderr is not None and sys.stderr.isatty()
        try:
            from tqdm.auto import tqdm  # type: ignore[import]
        except ImportError:
            return
        self._bar = tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}")

    def __call__(self, done: float) -> None:
        percent = int(100 * done)
        if percent == self._percent:
            return
        self._percent = percent
        if self._bar is not None:
            self._bar.n = percent
            self._bar.refresh()
        elif self._is_terminal:
            sys.stderr.write(f"\rumbrage: {percent:3d} %, {time.monotonic() - self._started:.0f} s")
            sys.stderr.flush()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        elif self._is_terminal and self._percent >= 0:
            sys.stderr.write("\n")


class Watch:
    """Runs calls of the library and reports their progress to the caller.

    Python handles signals only while Python code runs. `generator` runs about 20 times a second, so that Ctrl-C raises
    in it. Exceptions in it cancel the work, and are raised to the caller after the library's call has returned.
    """

    def __init__(self, progress: Progress, is_before: bool = False) -> None:
        check_progress(progress)
        self._bar = Bar() if progress is True else None
        self._tell: Optional[Callable[[float], Any]] = self._bar or (progress if callable(progress) else None)
        self._is_before = is_before
        self._raised: List[BaseException] = []
        self.generator = self._run()
        next(self.generator)

    def _run(self) -> Generator[bool, float, None]:
        go_on = True
        while True:
            try:
                while True:
                    done = yield go_on and not self._raised
                    if self._tell is not None and not self._raised:
                        answer = self._tell(0.0 if self._is_before else done)
                        go_on = answer is None or bool(answer)
            except GeneratorExit:
                return
            except BaseException as error:  # also KeyboardInterrupt
                self._raised.append(error)

    def __enter__(self) -> Watch:
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        if self._bar is not None:
            self._bar.close()
        if self._raised:
            raised = self._raised[0]
            context = raised.__context__
            try:
                raise raised
            finally:
                raised.__context__ = context  # not the library's error, which is its consequence
