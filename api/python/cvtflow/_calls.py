"""Functions of the extension module with a signature, and with type errors in words."""

import ast
import functools
import inspect
import re


class _Text:
    """A default value as the documentation shows it."""

    def __init__(self, text):
        self._text = text

    def __repr__(self):
        return self._text


def signature(function):
    """The inspect.Signature in the first line of a documentation text that pybind11 wrote."""
    first = re.sub(r"\b(cvtflow\.)?_cvtflow\.", "", (function.__doc__ or "").partition("\n")[0])
    arguments = ast.parse(re.sub(r"^\w+", "def f", first.partition(" -> ")[0]) + ": ...").body[0].args
    defaults = [inspect.Parameter.empty] * (len(arguments.args) - len(arguments.defaults))
    defaults += [_Text(ast.unparse(each)) for each in arguments.defaults]
    return inspect.Signature([
        inspect.Parameter(argument.arg, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default,
                          annotation=_Text(ast.unparse(argument.annotation)) if argument.annotation else inspect.Parameter.empty)
        for argument, default in zip(arguments.args, defaults)
    ])


def plain(function, name):
    """The function, whose TypeError states what it takes and what it was given."""
    shown = signature(function)

    @functools.wraps(function)
    def call(*given, **named):
        try:
            return function(*given, **named)
        except TypeError as error:
            if "incompatible" not in str(error):
                raise
        own = list(shown.parameters)[:1] == ["self"]
        takes = shown.replace(parameters=list(shown.parameters.values())[own:])
        words = [*map(repr, given[own:]), *(f"{key}={value!r}" for key, value in named.items())]
        raise TypeError(f"{name}{takes} was called with ({', '.join(words)})")

    call.__signature__ = shown
    return call


def install(simulation):
    """Replaces the methods of Simulation that users call with values of their own."""
    simulation.__init__ = plain(simulation.__init__, "Simulation")
    for name in ("advance_to", "set_input", "set_state", "rhs", "on_output", "on_transition"):
        setattr(simulation, name, plain(getattr(simulation, name), name))
