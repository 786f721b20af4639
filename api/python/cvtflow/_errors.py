"""Exceptions by the codes of the library; `code` of each is the name of its code."""


class Error(RuntimeError):
    """Base of all errors; `code` identifies the kind."""

    code = ""


class Fault(Error):
    """The simulation cannot continue; its state is that of the last accepted step."""


class ArgumentError(Error, ValueError):
    """A value out of range, a wrong length, an unknown name."""

    code = "argument"


class SceneError(Error, ValueError):
    """The scene, or the sweep file, cannot be read or has problems: a line for each."""

    code = "scene"


class StartStateError(Error):
    """The state file of the scene."""

    code = "start_state"


class StateError(Error):
    """A saved state of another scene or version, or damaged; results of another sweep."""

    code = "state"


class BusyError(Error):
    """Stepped by another thread, or called from a callback of it."""

    code = "busy"


class ForkedError(Error):
    """The simulation ran on threads before this process was forked off."""

    code = "forked"


class CancelledError(Error):
    """Ended by cancel(); the simulation can be continued."""

    code = "cancelled"


class OutOfMemoryError(Error, MemoryError):
    """No memory."""

    code = "memory"


class InternalError(Error):
    """A defect of cvtflow."""

    code = "internal"


class CallbackError(Error):
    """A callback requested the end."""

    code = "callback"


class RecordError(Error):
    """A record or a table cannot be read or written."""

    code = "record"


class NonFiniteError(Fault):
    """The state is not finite."""

    code = "non_finite"


class PenetrationError(Fault):
    """A tip is too deep in its sheave."""

    code = "penetration"


class LeftSheaveError(Fault):
    """A pin has left its sheave."""

    code = "left_sheave"


class MaxStepsError(Fault):
    """The limit run.max_steps."""

    code = "max_steps"


class MaxWallError(Fault):
    """The limit run.max_wall."""

    code = "max_wall"


class BlowUpError(Fault):
    """The energy grows without bound."""

    code = "blow_up"


class OtherFaultError(Fault):
    """A fault without a code of its own, which the message names."""

    code = "other_fault"


BY_CODE = {each.code: each for each in vars().copy().values() if isinstance(each, type) and issubclass(each, Error) and each.code}
