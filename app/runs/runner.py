"""From the latest request to a finished run, or to a drive that follows the requests.

One thread does it, with one slot for the request and one for each kind of outcome; there is no queue. A newer request
replaces an older one that has not begun, and stops a run that has long to go. Outcomes come in the order of their
requests; one that was not taken is replaced by the next of its kind.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from time import monotonic

from app.runs.drive import FRAME, Driver
from app.runs.request import Driven, Failed, Finished, Outcome, Refused, Request, Simulate
from app.runs.turns import COMPUTING
from model.config.validation import ConfigError
from model.dynamics.equilibrium import NoEquilibriumError

NEARLY_DONE = 0.5  # part of a run that is done; beyond it a newer request lets the run finish
PATIENCE = 0.25  # s without a new curve after which a run may finish, so that a long drag shows something…
LONGEST = 1.0  # s … unless it takes longer than this
TURN = 0.05  # s after which a run lets those of other tabs go on first


class Runner:
    """Runs the latest request, or drives on with it.

    `on_outcome` is called, on the runner's thread, when an outcome can be taken.
    """

    def __init__(
        self,
        first: Request,
        simulate: Simulate,
        on_outcome: Callable[[], None],
        on_error: Callable[[Exception], None],
    ) -> None:
        self._simulate, self._on_outcome, self._on_error = simulate, on_outcome, on_error
        self._condition = threading.Condition()
        self._request = replace(first, number=1)
        self._begun = 0  # number of the request that was begun last
        self._outcomes: dict[type, Outcome] = {}  # a refusal does not hide the run before it
        self._progress: float | None = None  # of the run under way, 0…1; None until the model is compiled
        self._turn_began = 0.0  # when the run under way had its turn, monotonic s
        self._began_at: float | None = None  # monotonic s; None: no run under way
        self._shown_at = 0.0  # when the last run finished
        self._speed: float | None = None  # of the drive, times real time; 0: it stands; None: no drive
        self._anew = False  # the drive is to start from rest
        self._rolls = False  # there is a drive, and it has not come to an end
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="trackride-runner", daemon=True)
        self._thread.start()

    def change(self, update: Callable[[Request], Request]) -> None:
        """Make update(latest request) the latest one. It runs under the lock: quick and without side effects."""
        with self._condition:
            self._request = replace(update(self._request), number=self._request.number + 1)
            self._condition.notify()

    def withdraw(self, refused: Request, instead: Request) -> bool:
        """Go back to an older request, which is not run again. False, and nothing is done, if a newer one has come."""
        with self._condition:
            if self._request.number != refused.number:
                return False
            self._request = replace(instead, number=refused.number)
            return True

    def drive(self, speed: float | None, anew: bool = False) -> None:
        """Drive on without end at this speed, times real time (0: stand), or with None go back to runs.

        anew: from rest.
        """
        with self._condition:
            if speed is None and self._speed is not None:
                self._request = replace(self._request, number=self._request.number + 1)  # to be run
            self._anew |= anew or self._speed is None
            self._speed = speed
            self._condition.notify()

    @property
    def latest(self) -> Request:
        return self._request

    def take(self) -> list[Outcome]:
        """The newest outcome of each kind, once, in the order of their requests."""
        with self._condition:
            outcomes, self._outcomes = self._outcomes, {}
        return sorted(outcomes.values(), key=lambda outcome: outcome.request.number)

    def under_way(self) -> tuple[int, float | None, float] | None:
        """Number, part done (0…1; None until the model is compiled) and seconds so far of the run under way, if any."""
        began = self._began_at
        return None if began is None else (self._begun, self._progress, monotonic() - began)

    def close(self) -> None:
        """Stop the run and end the thread."""
        with self._condition:
            self._closed = True
            self._condition.notify()
        self._thread.join()

    def _work(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(
                    lambda: self._closed or self._speed is not None or self._request.number > self._begun
                )
                if self._closed:
                    return
                driving = self._speed is not None
            if driving:
                self._drive_on()
            else:
                self._run_latest()

    def _run_latest(self) -> None:
        with COMPUTING.turn():
            self._turn_began = monotonic()
            with self._condition:  # the latest now, after waiting for the turn
                request = self._request
                self._begun, self._progress, self._began_at = request.number, None, monotonic()
            outcome = self._outcome_of(request)
            self._began_at = None
        if outcome is not None:
            self._shown_at = monotonic()
            self._publish(outcome)

    def _publish(self, outcome: Outcome) -> None:
        with self._condition:
            self._outcomes[type(outcome)] = outcome
        self._on_outcome()

    def _outcome_of(self, request: Request) -> Outcome | None:
        """None: the run was stopped, for a newer request or at closing."""
        try:
            config = request.config()
            run = self._simulate(config, on_progress=self._note_progress, should_stop=self._should_stop)
        except ConfigError as error:
            return Refused(request, error.faults)
        except NoEquilibriumError as error:
            return Failed(request, str(error))
        except Exception as error:
            self._on_error(error)
            return None
        return None if run.status == "cancelled" else Finished(request, run)

    def _note_progress(self, part: float) -> None:
        self._progress = part

    def _should_stop(self) -> bool:
        if monotonic() - self._turn_began > TURN:
            COMPUTING.pass_on()
            self._turn_began = monotonic()
        if self._closed or self._speed is not None:
            return True
        if self._request.number == self._begun or (self._progress or 0.0) >= NEARLY_DONE:
            return False
        now = monotonic()
        overdue = now - self._shown_at > PATIENCE
        return not overdue or now - (self._began_at or now) > LONGEST

    def _drive_on(self) -> None:
        """Drive frame by frame, until the drive is to end."""
        driver: Driver | None = None
        good = self._request
        self._rolls = stands = False
        while True:
            with self._condition:
                if driver is None or stands:
                    self._condition.wait_for(self._has_to_drive)
                if self._closed or self._speed is None:
                    return
                request, speed = self._request, self._speed
                changed, anew = request.number > self._begun, self._anew
                goes = speed > 0.0 and (self._rolls or changed or anew)
                self._begun, self._anew = request.number, False
            began = monotonic()
            try:
                if changed or anew or driver is None:
                    config = request.config()
                    if anew or driver is None:
                        driver = Driver(config)
                    driver.change(config)
                    good = request
                state = driver.frame(speed) if goes else driver.stand()
                self._rolls, stands = not state.ended, state.stands
                self._publish(Driven(good, state))
            except ConfigError as error:
                self._publish(Refused(request, error.faults))
            except NoEquilibriumError as error:
                driver, self._rolls = None, False
                self._publish(Failed(request, str(error)))
            except Exception as error:
                driver, self._rolls = None, False
                self._on_error(error)
            with self._condition:
                self._condition.wait_for(
                    lambda: self._closed or self._speed is None, timeout=max(FRAME - (monotonic() - began), 0.0)
                )

    def _has_to_drive(self) -> bool:
        rolls = self._rolls and self._speed != 0.0
        return self._closed or self._speed is None or rolls or self._anew or self._request.number > self._begun
